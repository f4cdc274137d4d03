#include "payload_report.h"

#include <cmath>
#include <numeric>

namespace gicodec::tools {
namespace {

using Json = nlohmann::ordered_json;

/// By plane of the bitstream (docs/native.md, "Planes").
std::vector<std::string> plane_names(Format format) {
  const FormatInfo& info = *find_format(format);
  if (format == Format::R16G16_SFLOAT) return {"R", "G-2R"};
  std::vector<Component> components(info.used().begin(), info.used().end());
  if (components.size() >= 3) std::swap(components[0], components[1]);
  std::vector<std::string> names;
  for (const Component& component : components) {
    const std::string name(1, component.name);
    if (component.bits > 16) names.push_back(name + " high");
    names.push_back(component.bits > 16 ? name + " low" : name);
  }
  return names;
}

std::string shares(std::span<const std::uint64_t> counts) {
  const auto sum = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  std::string text;
  for (const auto count : counts) {
    const double share = sum == 0 ? 0 : 100 * static_cast<double>(count) / static_cast<double>(sum);
    text += fmt::format("{}{:.1f}", text.empty() ? "" : " ", share);
  }
  return text + " %";
}

unsigned mode_kinds(Format format, bool update) {
  return format != Format::R16G16_SFLOAT ? 1 : update ? 2 : 0;
}

void print_kind(const char* label, const PayloadStatistics& s, Format format, bool update) {
  if (s.chunks == 0) return;
  const auto bytes = [](double bits) { return std::llround(bits / 8); };
  std::string line = fmt::format("  {} payload: {} heads, {} tables, {} raw, {} modes", label,
                                 s.head_bytes, s.table_bytes, s.raw_bytes, bytes(s.mode_bits));
  if (format == Format::R16G16_SFLOAT) line += fmt::format(", {} repeats", bytes(s.repeat_bits));
  const auto names = plane_names(format);
  for (std::size_t p = 0; p < names.size(); ++p) {
    line += fmt::format(", {} {}", bytes(s.plane_bits[p]), names[p]);
  }
  print("{}; {} chunk{}, {} raw\n", line, s.chunks, s.chunks == 1 ? "" : "s", s.raw_chunks);
  for (unsigned k = 0; k < mode_kinds(format, update); ++k) {
    print("    modes{}: {}\n", mode_kinds(format, update) == 1 ? "" : " of " + names[k],
          shares(s.modes[k]));
  }
  if (format == Format::R16G16_SFLOAT) {
    print("    texels by first guess, second guess, residual: {}\n", shares(s.repeats));
  }
}

Json kind_json(const PayloadStatistics& s, Format format, bool update) {
  Json json = {{"chunks", s.chunks},         {"raw_chunks", s.raw_chunks},
               {"head_bytes", s.head_bytes}, {"table_bytes", s.table_bytes},
               {"raw_bytes", s.raw_bytes},   {"word_bytes", s.word_bytes},
               {"mode_bits", s.mode_bits},   {"planes", Json::array()}};
  const auto names = plane_names(format);
  for (std::size_t p = 0; p < names.size(); ++p) {
    Json plane = {{"name", names[p]}, {"residuals", s.plane_symbols[p]}, {"bits", s.plane_bits[p]}};
    if (p < mode_kinds(format, update)) plane["modes"] = s.modes[p];
    json["planes"].push_back(plane);
  }
  if (format == Format::R16G16_SFLOAT) {
    json["repeats"] = {{"bits", s.repeat_bits},
                       {"first_guess", s.repeats[0]},
                       {"second_guess", s.repeats[1]},
                       {"residual", s.repeats[2]}};
  }
  return json;
}

}  // namespace

void PayloadReport::add(const ContainerPacket& packet, const PacketInfo& info,
                        const TextureDesc& desc, const std::string& where, LookBudget& budget) {
  budget.add_packet(packet.bytes.size());
  if (info.backend != kBackendNative) other_backends_ = true;
  if (other_backends_ || too_much_) return session_.reset();
  // A keyframe clears every probe.
  const std::uint64_t probes =
      info.keyframe || info.all_probes ? probe_count(desc) : std::uint64_t{info.probes};
  const std::uint64_t block = texture_bytes(desc) / probe_count(desc);
  too_much_ = (session_ == nullptr && !budget.take_memory(decoder_memory(desc))) ||
              !budget.take_work(probes * block);
  if (too_much_) return session_.reset();
  if (session_ == nullptr) {
    auto last = std::make_unique<PayloadStatistics>();
    DecoderOptions options;
    options.statistics = last.get();
    session_ = std::make_unique<Session>(
        Session{std::move(last), take(Decoder::create(desc, options), where)});
  }
  *session_->last = {};
  check(session_->decoder.decode(packet.bytes), where);
  (info.keyframe ? keyframes_ : updates_) += *session_->last;
}

void PayloadReport::print(Format format) const {
  if (too_much_) {
    tools::print("  payloads not looked at: to decode them takes too much for so small packets\n");
  }
  if (session_ == nullptr) return;
  print_kind("keyframe", keyframes_, format, false);
  print_kind("update", updates_, format, true);
}

Json PayloadReport::json(Format format) const {
  if (session_ == nullptr) return nullptr;
  return {{"keyframes", kind_json(keyframes_, format, false)},
          {"updates", kind_json(updates_, format, true)}};
}

}  // namespace gicodec::tools

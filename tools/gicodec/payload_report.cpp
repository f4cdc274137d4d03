#include "payload_report.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <numeric>

namespace gicodec::tools {
namespace {

using Json = nlohmann::ordered_json;

bool is_pair(const Record& record) { return record.format == Format::R16G16_SFLOAT; }

/// Names of the planes (docs/native.md, "Planes").
std::vector<std::string> plane_names(const Record& record) {
  if (is_pair(record)) return {"R", "G-2R"};
  std::vector<Component> components(record.used().begin(), record.used().end());
  if (components.size() >= 3) std::swap(components[0], components[1]);
  std::vector<std::string> names;
  for (const Component& component : components) {
    const std::string name(component.name());
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

unsigned mode_kinds(const Record& record, bool update) {
  return !is_pair(record) ? 1 : update ? 2 : 0;
}

void print_kind(const char* label, const PayloadStatistics& s, const Record& record, bool update) {
  if (s.chunks == 0) return;
  const auto bytes = [](double bits) { return std::llround(bits / 8); };
  std::string line = fmt::format("  {} payload: {} heads, {} tables, {} raw, {} modes", label,
                                 s.head_bytes, s.table_bytes, s.raw_bytes, bytes(s.mode_bits));
  if (is_pair(record)) line += fmt::format(", {} repeats", bytes(s.repeat_bits));
  const auto names = plane_names(record);
  for (std::size_t p = 0; p < names.size(); ++p) {
    line += fmt::format(", {} {}", bytes(s.plane_bits[p]), names[p]);
  }
  print("{}; {} chunk{} of up to {} blocks, {} raw\n", line, s.chunks, s.chunks == 1 ? "" : "s",
        s.chunk_blocks, s.raw_chunks);
  for (unsigned k = 0; k < mode_kinds(record, update); ++k) {
    print("    modes{}: {}\n", mode_kinds(record, update) == 1 ? "" : " of " + names[k],
          shares(s.modes[k]));
  }
  if (is_pair(record)) {
    print("    records by first guess, second guess, residual: {}\n", shares(s.repeats));
  }
}

Json kind_json(const PayloadStatistics& s, const Record& record, bool update) {
  Json json = {{"chunks", s.chunks},
               {"raw_chunks", s.raw_chunks},
               {"chunk_blocks", s.chunk_blocks},
               {"head_bytes", s.head_bytes},
               {"table_bytes", s.table_bytes},
               {"raw_bytes", s.raw_bytes},
               {"word_bytes", s.word_bytes},
               {"mode_bits", s.mode_bits},
               {"planes", Json::array()}};
  const auto names = plane_names(record);
  for (std::size_t p = 0; p < names.size(); ++p) {
    Json plane = {{"name", names[p]}, {"residuals", s.plane_symbols[p]}, {"bits", s.plane_bits[p]}};
    if (p < mode_kinds(record, update)) plane["modes"] = s.modes[p];
    json["planes"].push_back(plane);
  }
  if (is_pair(record)) {
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
  if (info.backend != kBackendNative || desc.presence != Presence::all) not_told_ = true;
  if (not_told_ || too_much_) return give_up();
  // A keyframe clears every block.
  const std::uint64_t blocks =
      is_keyframe(info.type) || info.all_blocks ? block_count(desc) : std::uint64_t{info.blocks};
  const std::uint64_t block = texture_bytes(desc) / block_count(desc);
  auto session = sessions_.find(packet.region);
  too_much_ = (session == sessions_.end() && !budget.take_memory(decoder_memory(desc))) ||
              !budget.take_work(blocks * block);
  if (too_much_) return give_up();
  if (session == sessions_.end()) {
    auto last = std::make_unique<PayloadStatistics>();
    DecoderOptions options;
    options.statistics = last.get();
    auto decoder = take(Decoder::create(desc, options), where);
    session = sessions_.emplace(packet.region, Session{std::move(last), std::move(decoder)}).first;
  }
  *session->second.last = {};
  check(session->second.decoder.decode(packet.bytes), where);
  (is_keyframe(info.type) ? keyframes_ : updates_) += *session->second.last;
}

void PayloadReport::print(const Record& record) const {
  if (too_much_) {
    tools::print(
        "  payloads not decoded: that takes too much memory or work for packets so small\n");
  }
  if (sessions_.empty()) return;
  print_kind("keyframe", keyframes_, record, false);
  print_kind("update", updates_, record, true);
}

Json PayloadReport::json(const Record& record) const {
  if (sessions_.empty()) return nullptr;
  return {{"keyframes", kind_json(keyframes_, record, false)},
          {"updates", kind_json(updates_, record, true)}};
}

}  // namespace gicodec::tools

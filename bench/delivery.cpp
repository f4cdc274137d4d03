#include "delivery.h"

#include "small_updates.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace gicodec::bench {
namespace {

/// Probes of an update; 0: every one.
constexpr std::size_t kProbes[] = {0, 512, 128, 32};

/// An update of all textures, from end to end.
struct Delivery {
  std::string label;
  double encode = 1e30, decode = 1e30;  ///< best seconds by the clock
  double bytes = 0;
  /// On a link of so many bits per second.
  [[nodiscard]] double seconds(double link) const { return encode + decode + 8 * bytes / link; }
};

/// Updates to the first frames in turn. `some`: the probes of each texture; empty: all.
std::optional<Delivery> measure(const std::vector<Texture>& textures, const Case& c,
                                const std::vector<std::uint32_t>& some, unsigned threads,
                                std::size_t rounds) {
  std::vector<Encoder> encoders;
  std::vector<Decoder> decoders;
  std::vector<std::vector<std::byte>> out;
  for (const Texture& t : textures) {
    encoders.push_back(make_encoder(t.desc, c, threads));
    decoders.push_back(make_decoder(t.desc, c, threads));
    out.emplace_back(texture_bytes(t.desc));
  }
  std::vector<Packet> packets(textures.size());
  Delivery best{.label = c.label};
  for (std::size_t i = 0; i <= rounds; ++i) {
    const bool all = i == 0 || some.empty();
    const auto frame_of = [&](const Texture& t) -> const std::vector<std::byte>& {
      return t.frames[i % std::min<std::size_t>(t.frames.size(), some.empty() ? 3 : 2)];
    };
    auto start = Clock::now();
    for (std::size_t k = 0; k < textures.size(); ++k) {
      const Selection selection = all ? Selection::all() : Selection(some);
      if (encoders[k].encode_to(ConstTextureView(frame_of(textures[k])), selection, packets[k]) !=
          Status::ok) {
        return {};
      }
    }
    const double encode = seconds_since(start);
    start = Clock::now();
    for (std::size_t k = 0; k < textures.size(); ++k) {
      if (decoders[k].decode(packets[k], TextureView{out[k]}) != Status::ok) return {};
    }
    const double decode = seconds_since(start);
    for (std::size_t k = 0; k < textures.size() && all; ++k) {
      if (out[k] != frame_of(textures[k])) return {};
    }
    if (i == 0) continue;  // a keyframe
    best.encode = std::min(best.encode, encode);
    best.decode = std::min(best.decode, decode);
    double bytes = 0;
    for (const Packet& packet : packets) bytes += static_cast<double>(packet.size());
    best.bytes = std::max(best.bytes, bytes);
  }
  return best;
}

std::string speed(double link) {
  return link < 1e9 ? fmt::format("{:.3g} Mbps", link / 1e6)
                    : fmt::format("{:.3g} Gbps", link / 1e9);
}

/// Which of them is first, from 1 Mbps to 100 Gbps.
void report_first(const std::vector<Delivery>& all, nlohmann::json& row) {
  constexpr int kPerDecade = 20;
  const auto first_at = [&](double link) {
    return std::ranges::min_element(all, {}, [&](const Delivery& d) { return d.seconds(link); });
  };
  auto first = first_at(1e6);
  double begin = 1e6;
  fmt::print("first:");
  for (int i = 1; i <= 5 * kPerDecade; ++i) {
    const double link = std::pow(10, 6 + static_cast<double>(i) / kPerDecade);
    const auto next = first_at(link);
    if (next == first && i < 5 * kPerDecade) continue;
    fmt::print(" {} {} to {};", first->label, speed(begin), speed(link));
    row.push_back({{"backend", first->label}, {"from", begin}, {"to", link}});
    first = next;
    begin = link;
  }
  fmt::print("\n");
}

}  // namespace

void report_delivery(const std::string& path, const std::vector<Texture>& textures, bool quick,
                     Isa isa, unsigned threads, std::ostream& json) {
  const auto changed =
      textures[0].frames.size() < 2 ? std::vector<std::uint32_t>() : changed_probes(textures[0]);
  for (const std::size_t probes : kProbes) {
    if (probes > changed.size()) continue;
    const auto some =
        probes == 0 ? std::vector<std::uint32_t>() : choose_probes(changed, probes, false);
    fmt::print(
        "\n{}: updates of {} probes, {} texture{}, {} thread{}, {}\n{:<26} {:>9} {:>9} {:>10}\n",
        path, probes == 0 ? "all" : std::to_string(probes), textures.size(),
        textures.size() == 1 ? "" : "s", threads, threads == 1 ? "" : "s", to_string(isa), "",
        "enc ms", "dec ms", "bytes");
    std::vector<Delivery> all;
    nlohmann::json row = {{"path", path},
                          {"probes", probes},
                          {"threads", threads},
                          {"isa", to_string(isa)},
                          {"deliveries", nlohmann::json::array()},
                          {"first", nlohmann::json::array()}};
    for (const Case& c : cases(isa)) {
      const bool slow = c.slow || c.backend == "hevc";
      if (quick && slow) continue;
      if (std::ranges::any_of(textures,
                              [&](const Texture& t) { return !refusal(t.desc, c).empty(); }))
        continue;
      const auto d = measure(textures, c, some, threads, slow ? 3 : probes == 0 ? 31 : 101);
      if (!d) continue;
      fmt::print("{:<26} {:9.3f} {:9.3f} {:10.0f}\n", d->label, 1e3 * d->encode, 1e3 * d->decode,
                 d->bytes);
      std::fflush(stdout);
      row["deliveries"].push_back({{"backend", d->label},
                                   {"encode_s", d->encode},
                                   {"decode_s", d->decode},
                                   {"bytes", d->bytes}});
      all.push_back(*d);
    }
    if (!all.empty()) report_first(all, row["first"]);
    json << row << std::endl;
  }
}

}  // namespace gicodec::bench

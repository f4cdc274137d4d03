#include "small_updates.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

namespace gicodec::bench {

std::vector<std::uint32_t> changed_probes(const Texture& t) {
  Case raw;
  raw.backend = "raw";
  auto encoder = make_encoder(t.desc, raw);
  auto decoder = make_decoder(t.desc, raw);
  for (std::size_t f = 0; f < 2; ++f) {
    const auto packet = encoder.encode(ConstTextureView(t.frames[f]),
                                       f == 0 ? Selection::all() : Selection::changed());
    if (!packet || decoder.decode(*packet) != Status::ok) return {};
  }
  return {decoder.changed().begin(), decoder.changed().end()};
}

std::vector<std::uint32_t> choose_probes(const std::vector<std::uint32_t>& changed,
                                         std::size_t count, bool spread) {
  std::vector<std::uint32_t> some(count);
  const std::size_t stride = spread ? changed.size() / count : 1;
  const std::size_t first = spread ? stride / 2 : (changed.size() - count) / 2;
  for (std::size_t i = 0; i < count; ++i) some[i] = changed[first + i * stride];
  return some;
}

namespace {

constexpr std::size_t kCounts[] = {1, 8, 32, 128};

struct Update {
  double bytes = 0;
  double encode = 1e30, decode = 1e30;  ///< best seconds by the clock
};
/// From frame 0 to frame 1 and back.
std::optional<Update> measure(const Texture& t, const Case& c,
                              const std::vector<std::uint32_t>& some) {
  auto encoder = make_encoder(t.desc, c);
  auto decoder = make_decoder(t.desc, c);
  std::vector<std::byte> out(texture_bytes(t.desc));
  Packet packet;
  Update best;
  constexpr std::size_t kRounds = 60;
  for (std::size_t i = 0; i <= kRounds; ++i) {
    auto start = Clock::now();
    if (encoder.encode_to(ConstTextureView(t.frames[i % 2]),
                          i == 0 ? Selection::all() : Selection(some), packet) != Status::ok)
      return std::nullopt;
    const double encode = seconds_since(start);
    start = Clock::now();
    if (decoder.decode(packet, TextureView{out}) != Status::ok) return std::nullopt;
    if (i == 0) continue;  // a keyframe
    best.decode = std::min(best.decode, seconds_since(start));
    best.encode = std::min(best.encode, encode);
    if (i == 1) best.bytes = static_cast<double>(packet.size());
  }
  return best;
}

}  // namespace

void report_small_updates(const Texture& t, Isa isa) {
  if (t.frames.size() < 2) return;
  const auto changed = changed_probes(t);
  for (const bool spread : {false, true}) {
    fmt::print("{:<26}", spread ? "so many, spread" : "probes side by side");
    for (const auto n : kCounts) fmt::print(" | {:>7} enc us dec us", n);
    fmt::print("\n");
    for (const auto& c : cases(isa)) {
      if (c.object != nullptr || c.slow || c.backend == "raw" || !refusal(t.desc, c).empty())
        continue;
      fmt::print("{:<26}", c.label);
      for (const auto n : kCounts) {
        const auto u =
            changed.size() < n ? std::nullopt : measure(t, c, choose_probes(changed, n, spread));
        if (u) {
          fmt::print(" | {:>5.0f} B {:>6.0f} {:>6.0f}", u->bytes / static_cast<double>(n),
                     u->encode * 1e6, u->decode * 1e6);
        }
      }
      fmt::print("\n");
    }
  }
}

}  // namespace gicodec::bench

#include "delivery.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace gicodec::bench {
namespace {

/// An update of every probe of all textures, from end to end: seconds by the clock.
struct Delivery {
  double encode = 1e30, decode = 1e30;
  double bytes = 0;
  [[nodiscard]] double seconds() const { return encode + decode; }
};
std::optional<Delivery> measure_delivery(const std::vector<Texture>& textures, const Case& c,
                                         unsigned threads, int rounds) {
  std::vector<Encoder> encoders;
  std::vector<Decoder> decoders;
  std::vector<std::vector<std::byte>> out;
  for (const Texture& t : textures) {
    encoders.push_back(make_encoder(t.desc, c, threads));
    decoders.push_back(make_decoder(t.desc, c, threads));
    out.emplace_back(texture_bytes(t.desc));
  }
  std::vector<Packet> packets(textures.size());
  Delivery best;
  for (int i = 0; i <= rounds; ++i) {
    const auto frame_of = [&](const Texture& t) -> const std::vector<std::byte>& {
      return t.frames[static_cast<std::size_t>(i) % std::min<std::size_t>(t.frames.size(), 3)];
    };
    auto start = Clock::now();
    for (std::size_t k = 0; k < textures.size(); ++k) {
      const ConstTextureView view(frame_of(textures[k]));
      if (encoders[k].encode_to(view, Selection::all(), packets[k]) != Status::ok) return {};
    }
    const double encode = seconds_since(start);
    start = Clock::now();
    for (std::size_t k = 0; k < textures.size(); ++k) {
      if (decoders[k].decode(packets[k], TextureView{out[k]}) != Status::ok) return {};
    }
    const double decode = seconds_since(start);
    for (std::size_t k = 0; k < textures.size(); ++k) {
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

/// From which speed of a link on the other one is first: 0 never, infinite if `mine` always is.
double break_even(const Delivery& mine, const Delivery& other) {
  const double slower = mine.seconds() - other.seconds(), more = other.bytes - mine.bytes;
  if (slower <= 0) return more >= 0 ? std::numeric_limits<double>::infinity() : 0;
  return more <= 0 ? 0 : 8 * more / slower;
}

}  // namespace

void report_delivery(const std::string& path, const std::vector<Texture>& textures, bool quick,
                     Isa isa, unsigned threads) {
  fmt::print(
      "\n{}: an update of every probe of {} texture{}, {} thread{}, {}\n{:<26} {:>9} {:>9}"
      " {:>10}\n",
      path, textures.size(), textures.size() == 1 ? "" : "s", threads, threads == 1 ? "" : "s",
      to_string(isa), "", "enc ms", "dec ms", "bytes");
  std::optional<Delivery> native;
  std::vector<std::pair<std::string, Delivery>> others;
  for (const Case& c : cases(isa)) {
    if (quick && c.slow) continue;
    const bool slow = c.slow || c.backend == "hevc";
    if (std::ranges::any_of(textures,
                            [&](const Texture& t) { return !refusal(t.desc, c).empty(); }))
      continue;
    const auto d = measure_delivery(textures, c, threads, slow ? 3 : 31);
    if (!d) continue;
    fmt::print("{:<26} {:9.2f} {:9.2f} {:10.0f}\n", c.label, 1e3 * d->encode, 1e3 * d->decode,
               d->bytes);
    if (c.label == "native fast") {
      native = d;
    } else if (c.backend != "native") {
      others.emplace_back(c.label, *d);
    }
  }
  if (!native || others.empty()) return;
  const auto first = std::ranges::min_element(
      others, {}, [&](const auto& other) { return break_even(*native, other.second); });
  const double link = break_even(*native, first->second);
  if (std::isinf(link)) {
    fmt::print("native fast delivers first on every link\n");
  } else {
    fmt::print("native fast delivers first up to {:.2f} Gbps, beyond that {}\n", link / 1e9,
               first->first);
  }
}

}  // namespace gicodec::bench

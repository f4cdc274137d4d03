// Description, settings, texels, selections and views from the input; a decoder must hold exactly
// what the encoder was given.
#include "input.h"

#include <numeric>

namespace {

using namespace gicodec;

/// Copies the listed blocks (all texels, border included) from one tight texture to another.
void copy_blocks(const TextureDesc& desc, std::span<const std::uint32_t> probes,
                 std::span<const std::byte> from, std::span<std::byte> to) {
  const auto size = extent(desc);
  const std::size_t row = std::size_t{size.width} * texel_bytes(desc);
  for (const auto probe : probes) {
    const auto origin = block_origin(desc, probe);
    for (std::uint32_t y = 0; y < block_side(desc); ++y) {
      const std::size_t at = (std::size_t{origin.slice} * size.height + origin.y + y) * row +
                             std::size_t{origin.x} * texel_bytes(desc);
      std::memcpy(&to[at], &from[at], std::size_t{block_side(desc)} * texel_bytes(desc));
    }
  }
}

/// Any texels: pieces of the input, repeated, so that little input makes much texture.
void paint(fuzz::Input& input, std::span<std::byte> texture) {
  for (std::uint32_t strokes = input.below(6); strokes > 0; --strokes) {
    const std::size_t start = texture.size() * input.byte() / 256;
    const std::size_t length = input.u16();
    const auto step = input.byte();
    const auto pattern = input.bytes(input.below(16));
    if (pattern.empty()) continue;
    for (std::size_t i = 0; i < length && start + i < texture.size(); ++i) {
      texture[start + i] = pattern[i % pattern.size()] ^ std::byte(i * step >> 4);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto desc = input.desc();
  EncoderOptions options;
  const auto which = input.below(3);
  options.backend = built_in_backends()[which]->name();
  constexpr std::uint32_t kLevels[] = {1, 13, 8};
  options.settings.level = static_cast<int>(input.below(kLevels[which]));
  options.settings.difference = input.below(2) != 0;
  options.gop = input.below(5);
  auto encoder = Encoder::create(desc, options);
  auto decoder = Decoder::create(desc);
  fuzz::check(encoder.ok() && decoder.ok(), "valid settings make sessions");

  fuzz::Exact texture(texture_bytes(desc)), view(texture_bytes(desc));
  std::vector<std::byte> expected(texture.span().size());
  std::vector<std::uint32_t> all(probe_count(desc));
  std::iota(all.begin(), all.end(), 0U);
  for (int frame = 0; frame < 6 && (frame == 0 || !input.empty()); ++frame) {
    paint(input, texture.span());
    const auto kind = input.below(4);
    if (input.below(4) == 0) encoder->request_keyframe();
    std::vector<std::uint32_t> list;
    if (kind >= 2) {
      auto bits = input.u16();
      for (const auto probe : all) {
        if ((bits & 1) != 0) list.push_back(probe);
        bits = bits >> 1 | (bits & 1) << 15;
      }
    }
    if (kind == 3) std::ranges::reverse(list);
    const Selection selection = kind == 0   ? Selection::changed()
                                : kind == 1 ? Selection::all()
                                            : Selection(list);
    fuzz::Exact room(encoder->bound(kind >= 2 ? list.size() : all.size()));
    if (input.below(8) == 0) {
      const auto small = encoder->encode_to(ConstTextureView(texture.span()), selection,
                                            room.span().first(input.below(12)));
      fuzz::check(small.status() == Status::buffer_too_small, "no packet is that small");
    }
    const auto packet_size =
        encoder->encode_to(ConstTextureView(texture.span()), selection, room.span());
    fuzz::check(packet_size.ok(), "bound() bytes suffice");
    fuzz::Exact packet(room.span().first(*packet_size));
    fuzz::check(decoder->decode(packet.span(), TextureView{view.span()}) == Status::ok,
                "a decoder reads what an encoder writes");

    if (peek(packet.span())->keyframe) std::ranges::fill(expected, std::byte{0});
    copy_blocks(desc, decoder->updated(), texture.span(), expected);
    fuzz::check(fuzz::contents(*decoder) == expected, "every selected block is exact");
    fuzz::check(fuzz::contents(*encoder) == expected, "the encoder's mirror is the decoder's");
    fuzz::check(std::ranges::equal(view.span(), expected), "the view follows");
    if (kind < 2) {
      fuzz::check(std::ranges::equal(texture.span(), expected), "all changes were selected");
    }
  }
  return 0;
}

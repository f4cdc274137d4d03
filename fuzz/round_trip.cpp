// Description, settings, texels, selections and views from the input; a decoder must hold exactly
// what the encoder was given, and so must one that joins late by a snapshot.
#include "input.h"

#include <numeric>
#include <optional>

namespace {

using namespace gicodec;

/// A texture with gaps between rows and slices that nobody may write.
class Texture {
 public:
  Texture(const TextureDesc& desc, std::size_t row_gap, std::size_t slice_gap)
      : desc_(desc),
        row_(std::size_t{extent(desc).width} * texel_bytes(desc)),
        row_pitch_(row_ + row_gap),
        slice_pitch_(extent(desc).height * row_pitch_ + slice_gap),
        bytes_((extent(desc).slices - 1) * slice_pitch_ + (extent(desc).height - 1) * row_pitch_ +
               row_) {}

  std::span<std::byte> bytes() { return bytes_.span(); }
  TextureView view() { return {bytes_.span(), row_pitch_, slice_pitch_}; }

  /// All texels of a block, row by row.
  std::vector<std::byte> block(std::uint32_t probe) {
    const auto origin = block_origin(desc_, probe);
    const std::size_t side = block_side(desc_), line = side * texel_bytes(desc_);
    std::vector<std::byte> out(side * line);
    for (std::size_t y = 0; y < side; ++y) {
      const std::size_t at = origin.slice * slice_pitch_ + (origin.y + y) * row_pitch_ +
                             std::size_t{origin.x} * texel_bytes(desc_);
      std::memcpy(&out[y * line], &bytes_.span()[at], line);
    }
    return out;
  }
  bool gaps_untouched() {
    fuzz::Exact before(bytes_.span().size());
    const std::size_t height = extent(desc_).height;
    for (std::size_t slice = 0; slice < extent(desc_).slices; ++slice) {
      for (std::size_t y = 0; y < height; ++y) {
        const std::size_t end = slice * slice_pitch_ + y * row_pitch_ + row_;
        const std::size_t gap = y + 1 < height
                                    ? row_pitch_ - row_
                                    : slice_pitch_ - height * row_pitch_ + row_pitch_ - row_;
        const std::size_t size = std::min(gap, bytes_.span().size() - end);
        if (!fuzz::same(bytes_.span().subspan(end, size), before.span().subspan(end, size))) {
          return false;
        }
      }
    }
    return true;
  }

 private:
  TextureDesc desc_;
  std::size_t row_, row_pitch_, slice_pitch_;
  fuzz::Exact bytes_;
};

using Blocks = std::vector<std::vector<std::byte>>;  ///< of every probe

template <typename Session>
Blocks blocks_of(const Session& session) {
  Texture texture(session.desc(), 0, 0);
  std::ranges::copy(fuzz::contents(session), texture.bytes().begin());
  Blocks blocks(probe_count(session.desc()));
  for (std::uint32_t probe = 0; probe < blocks.size(); ++probe)
    blocks[probe] = texture.block(probe);
  return blocks;
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

/// Any backend of the core with settings that it takes.
EncoderOptions options_of(fuzz::Input& input) {
  const auto backends = built_in_backends();
  const auto* backend = backends[input.below(static_cast<std::uint32_t>(backends.size()))];
  EncoderOptions options;
  options.backend = backend->name();
  const auto choice = input.byte();
  auto& settings = options.settings;
  if (backend->id() == kBackendLz4) settings.level = choice % 13;
  if (backend->id() == kBackendZstd) settings.level = choice % 8;
  settings.difference = choice < 128;
  const auto isas = supported_isas();
  settings.isa = isas[input.below(static_cast<std::uint32_t>(isas.size()))];
  if (backend->id() == kBackendNative) {
    constexpr const char* kPresets[] = {"", "fast", "strong"};
    settings.preset = kPresets[choice % 3];
    settings.threads = 1 + choice / 4 % 2;
  }
  options.gop = input.below(5);
  options.texture_id = input.byte();
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto desc = input.desc();
  auto encoder = Encoder::create(desc, options_of(input));
  // The receiver's tiling, threads and instruction set are its own.
  auto theirs = desc;
  theirs.tiling = static_cast<Tiling>(input.below(kTilingCount));
  const auto isas = supported_isas();
  const DecoderOptions receiving{.threads = 1 + input.below(2),
                                 .isa = isas[input.below(static_cast<std::uint32_t>(isas.size()))]};
  auto decoder = Decoder::create(theirs, receiving);
  std::optional<Decoder> late;
  fuzz::check(encoder.ok() && decoder.ok(), "valid settings make sessions");

  Texture texture(desc, input.below(20), input.below(20)), view(theirs, input.below(20), 3);
  const std::size_t block = std::size_t{block_side(desc)} * block_side(desc) * texel_bytes(desc);
  Blocks expected(probe_count(desc), std::vector<std::byte>(block, std::byte{0}));
  std::vector<std::uint8_t> active(expected.size(), 1);
  for (int frame = 0; frame < 6 && (frame == 0 || !input.empty()); ++frame) {
    paint(input, texture.bytes());
    const auto kind = input.below(4);
    const auto wishes = input.byte();
    if (wishes % 4 == 0) encoder->request_keyframe();
    if (wishes / 4 % 8 == 1) {
      std::ranges::fill(active, std::uint8_t{0});
      for (const auto probe : input.probes(desc)) active[probe] = 1;
      fuzz::check(encoder->set_active(active) == Status::ok, "a byte for each probe");
    }
    auto list = kind >= 2 ? input.probes(desc) : std::vector<std::uint32_t>{};
    if (kind == 3) std::ranges::reverse(list);
    const Selection selection = kind == 0   ? Selection::changed()
                                : kind == 1 ? Selection::all()
                                            : Selection(list);
    fuzz::Exact room(encoder->bound(kind >= 2 ? list.size() : expected.size()));
    if (wishes / 32 == 1) {
      const auto small =
          encoder->encode_to(texture.view(), selection, room.span().first(input.below(12)));
      fuzz::check(small.status() == Status::buffer_too_small, "no packet is that small");
    }
    const auto packet_size = encoder->encode_to(texture.view(), selection, room.span());
    fuzz::check(packet_size.ok(), "bound() bytes suffice");
    fuzz::Exact packet(room.span().first(*packet_size));
    fuzz::check(decoder->decode(packet.span(), view.view()) == Status::ok,
                "a decoder reads what an encoder writes");

    if (peek(packet.span())->keyframe) {
      std::ranges::fill(expected, std::vector<std::byte>(block, std::byte{0}));
    }
    for (const auto probe : decoder->updated()) expected[probe] = texture.block(probe);
    fuzz::check(blocks_of(*decoder) == expected, "every selected block is exact");
    fuzz::check(blocks_of(*encoder) == expected, "the encoder's mirror is the decoder's");
    for (std::uint32_t probe = 0; probe < expected.size(); ++probe) {
      fuzz::check(view.block(probe) == expected[probe], "the view follows");
      if (kind == 1 || (kind == 0 && active[probe] != 0)) {
        fuzz::check(texture.block(probe) == expected[probe], "all changes were selected");
      }
    }
    fuzz::check(view.gaps_untouched(), "gaps are not written");

    if (late) {
      fuzz::check(late->decode(packet.span()) == Status::ok, "who joined late follows");
    } else if (wishes / 32 == 2) {
      const auto snapshot = encoder->snapshot();
      fuzz::check(snapshot.ok(), "a snapshot is made");
      auto made = Decoder::create(theirs, receiving);
      fuzz::check(made.ok() && made->decode(*snapshot) == Status::ok, "a snapshot is a keyframe");
      late = *std::move(made);
    }
    if (!late) continue;
    fuzz::check(blocks_of(*late) == expected && late->checksum() == decoder->checksum() &&
                    late->sequence() == decoder->sequence() &&
                    late->state_hash() == decoder->state_hash(),
                "who joined late holds the same");
  }
  return 0;
}

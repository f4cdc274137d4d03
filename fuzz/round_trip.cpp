// Description, settings, records, selections and views from the input; a decoder must hold exactly
// what the encoder was given, and so must one that joins late by a snapshot.
#include "input.h"
#include "texture/presence.h"

#include <numeric>
#include <optional>

namespace {

using namespace gicodec;

/// A texture with gaps between rows and slices that nobody may write.
class Texture {
 public:
  Texture(const TextureDesc& desc, std::size_t row_gap, std::size_t slice_gap)
      : desc_(desc),
        pieces_(desc.layout.tiling == Tiling::blocks ? block_count(desc) : 1),
        row_pitch_(extent(desc).width * desc.record.bytes + row_gap),
        slice_pitch_(extent(desc).height * row_pitch_ + slice_gap),
        block_pitch_(extent(desc).slices / pieces_ * slice_pitch_),
        bytes_(pieces_ * block_pitch_ - slice_gap - row_gap) {}

  std::span<std::byte> bytes() { return bytes_.span(); }
  TextureView view() { return {bytes_.span(), row_pitch_, slice_pitch_, block_pitch_}; }

  /// All records of a block, row by row, zeros beyond the volume's end; what `presence` says does
  /// not exist is zero.
  std::vector<std::byte> block(std::uint32_t block, std::span<const std::byte> presence) {
    const std::size_t record = desc_.record.bytes, band = 2U * desc_.guard_band;
    std::vector<std::byte> out((desc_.block.x + band) * (desc_.block.y + band) * desc_.block.z *
                               record);
    for_rows(block, [&](std::size_t at, std::size_t to, std::size_t size) {
      std::memcpy(&out[to], &bytes_.span()[at], size);
    });
    const std::size_t size = presence_bytes(desc_);
    if (size != 0) clear_absent(desc_, presence.subspan(block * size, size), out);
    return out;
  }
  /// Whatever belongs to no block is as it was.
  bool gaps_untouched() {
    fuzz::Exact before(bytes_.span().size());
    for (std::uint32_t block = 0; block < block_count(desc_); ++block) {
      for_rows(block, [&](std::size_t at, std::size_t, std::size_t size) {
        std::memcpy(&before.span()[at], &bytes_.span()[at], size);
      });
    }
    return fuzz::same(bytes_.span(), before.span());
  }

 private:
  /// visit(offset in memory, offset in the block, bytes)
  template <typename Visit>
  void for_rows(std::uint32_t block, const Visit& visit) {
    const auto origin = block_origin(desc_, block);
    const auto inside = block_inside(desc_, block);
    const std::size_t record = desc_.record.bytes, band = 2U * desc_.guard_band;
    for (std::size_t z = 0; z < inside.z; ++z) {
      for (std::size_t y = 0; y < inside.y + band; ++y) {
        visit(origin.block * block_pitch_ + (origin.slice + z) * slice_pitch_ +
                  (origin.y + y) * row_pitch_ + origin.x * record,
              (z * desc_.block.y + y) * (desc_.block.x + band) * record,
              (inside.x + band) * record);
      }
    }
  }

  TextureDesc desc_;
  std::size_t pieces_, row_pitch_, slice_pitch_, block_pitch_;
  fuzz::Exact bytes_;
};

using Blocks = std::vector<std::vector<std::byte>>;  ///< of every probe

template <typename Session>
Blocks blocks_of(const Session& session) {
  const TextureDesc& desc = session.desc();
  Texture texture(desc, 0, 0);
  std::ranges::copy(fuzz::contents(session), texture.bytes().begin());
  const std::vector<std::byte> everything(block_count(desc) * presence_bytes(desc),
                                          std::byte{0xFF});
  Blocks blocks(block_count(desc));
  for (std::uint32_t block = 0; block < blocks.size(); ++block) {
    blocks[block] = texture.block(block, everything);
  }
  return blocks;
}

/// Any records: pieces of the input, repeated, so that little input makes much texture.
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
  const auto desc = input.any_desc();
  const auto options = options_of(input);
  auto encoder = Encoder::create(desc, options);
  const auto presence = input.presence(desc);
  // The receiver's tiling, threads and instruction set are its own.
  auto theirs = desc;
  theirs.layout = static_cast<Tiling>(input.below(kTilingCount));
  const auto isas = supported_isas();
  const DecoderOptions receiving{.threads = 1 + input.below(2),
                                 .isa = isas[input.below(static_cast<std::uint32_t>(isas.size()))]};
  auto decoder = Decoder::create(theirs, receiving);
  std::optional<Decoder> late;
  fuzz::check(encoder.ok() && decoder.ok(), "valid settings make sessions");
  fuzz::check(encoder->set_presence(presence) == Status::ok &&
                  decoder->set_presence(presence) == Status::ok,
              "sound presence is taken");

  Texture texture(desc, input.below(20), input.below(20)), view(theirs, input.below(20), 3);
  const std::vector<std::byte> zero(texture.block(0, presence).size());
  Blocks expected(block_count(desc), zero);
  std::vector<std::uint8_t> active(expected.size(), 1);
  for (int frame = 0; frame < 6 && (frame == 0 || !input.empty()); ++frame) {
    paint(input, texture.bytes());
    const auto kind = input.below(4);
    const auto wishes = input.byte();
    if (wishes % 4 == 0) encoder->request_keyframe();
    if (wishes / 4 % 8 == 1) {
      std::ranges::fill(active, std::uint8_t{0});
      for (const auto block : input.blocks(desc)) active[block] = 1;
      fuzz::check(encoder->set_active(active) == Status::ok, "a byte for each block");
    }
    auto list = kind >= 2 ? input.blocks(desc) : std::vector<std::uint32_t>{};
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

    for (const auto block : decoder->changed()) {
      const bool there = decoder->received()[block] != 0;
      expected[block] = there ? texture.block(block, presence) : zero;
    }
    fuzz::check(blocks_of(*decoder) == expected, "every selected block is exact");
    fuzz::check(blocks_of(*encoder) == expected, "the encoder's mirror is the decoder's");
    for (std::uint32_t block = 0; block < expected.size(); ++block) {
      fuzz::check(view.block(block, presence) == expected[block], "the view follows");
      if (kind == 1 || (kind == 0 && active[block] != 0)) {
        fuzz::check(texture.block(block, presence) == expected[block], "all changes were selected");
      }
    }
    fuzz::check(view.gaps_untouched(), "gaps are not written");

    if (late) {
      fuzz::check(late->decode(packet.span()) == Status::ok, "who joined late follows");
    } else if (wishes / 32 == 2) {
      const auto snapshot = encoder->snapshot();
      fuzz::check(snapshot.ok(), "a snapshot is made");
      auto made = Decoder::create(theirs, receiving);
      fuzz::check(made.ok() && made->set_presence(presence) == Status::ok &&
                      made->decode(*snapshot) == Status::ok,
                  "a snapshot is a keyframe");
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

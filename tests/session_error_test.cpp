// Every documented error of encoder and decoder, and that the session is as good after it.
#include "distinct_formats.h"
#include "support.h"

#include "bitstream/description.h"
#include "bitstream/packet.h"

#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace gicodec {
namespace {

using namespace test;

const TextureDesc kDesc = probe_texture(Format::R16G16_SFLOAT, {3, 2, 2}, 4, 1, Tiling::atlas_xy_z);

/// A backend that fails when told to, before or after its state has moved, or breaks its promises.
class MoodyBackend final : public Backend {
 public:
  enum class Mood { good, fail, throw_bad_alloc, throw_other, exceed_bound };
  explicit MoodyBackend(Mood& mood) : mood_(mood) {}
  std::uint8_t id() const override { return 200; }
  std::string_view name() const override { return "moody"; }
  Result<std::unique_ptr<BackendEncoder>> make_encoder(const TextureDesc& desc,
                                                       const BackendSettings&) const override {
    if (desc.record.format == Format::R32_SFLOAT) return Status::unsupported_format;
    if (mood_ == Mood::fail) return Status::backend_unavailable;
    if (mood_ == Mood::throw_bad_alloc) throw std::bad_alloc();
    return std::unique_ptr<BackendEncoder>(std::make_unique<Coder>(mood_));
  }
  Result<std::unique_ptr<BackendDecoder>> make_decoder(const TextureDesc& desc) const override {
    if (desc.record.format == Format::R32_SFLOAT) return Status::unsupported_format;
    if (mood_ == Mood::fail) return Status::backend_unavailable;
    return std::unique_ptr<BackendDecoder>(std::make_unique<Uncoder>(mood_));
  }

 private:
  static Status act(Mood mood) {
    if (mood == Mood::throw_bad_alloc) throw std::bad_alloc();
    if (mood == Mood::throw_other) throw 7;
    return mood == Mood::fail ? Status::backend_failed : Status::ok;
  }
  class Coder final : public BackendEncoder {
   public:
    explicit Coder(const Mood& mood) : mood_(mood) {}
    std::size_t bound(std::size_t blocks) const override { return blocks * block_bytes(kDesc); }
    Status encode(const EncodeJob& job, std::vector<std::byte>& out) override {
      out.clear();
      for (std::size_t i = 0; i < job.blocks.size(); ++i) {
        const auto block = job.records[i];
        out.insert(out.end(), block.begin(), block.end());
      }
      if (mood_ == Mood::exceed_bound) out.resize(out.size() + 1);
      return act(mood_);
    }
    const Mood& mood_;
  };
  class Uncoder final : public BackendDecoder {
   public:
    explicit Uncoder(const Mood& mood) : mood_(mood) {}
    Status decode(const DecodeJob& job) override {
      if (job.payload.size() != job.records.size()) return Status::corrupt;
      std::copy(job.payload.begin(), job.payload.end(), job.records.begin());
      return act(mood_);
    }
    const Mood& mood_;
  };
  Mood& mood_;
};

class SessionError : public testing::Test {
 protected:
  SessionError() : random_(21), texture_(kDesc) { texture_.fill(Fill::noise, random_); }
  ConstTextureView view() const { return texture_.view(); }
  Packet next(Encoder& encoder, Selection selection = Selection::changed()) {
    texture_.fill_block(pick(random_, 0, block_count(kDesc) - 1), Fill::noise, random_);
    auto packet = encoder.encode(view(), selection);
    EXPECT_TRUE(packet.ok()) << packet.status();
    return packet.ok() ? *std::move(packet) : Packet{};
  }
  Random random_;
  Texture texture_;
};

TEST_F(SessionError, CreateEncoder) {
  const auto status = [](const TextureDesc& desc, const EncoderOptions& options = {}) {
    return Encoder::create(desc, options).status();
  };
  EXPECT_EQ(status({}), Status::unsupported_format);
  EXPECT_EQ(status(probe_texture(Format::R16_SFLOAT, {0, 1, 1}, 8, 1)),
            Status::invalid_description);
  for (const char* name : {"", "zstandard", "hevc", "NATIVE", "ZSTD"}) {
    EXPECT_EQ(status(kDesc, {.backend = name}), Status::unknown_backend) << name;
  }
  const auto with_level = [&](std::string_view backend, int level) {
    EncoderOptions options;
    options.backend = backend;
    options.settings.level = level;
    return status(kDesc, options);
  };
  for (const int level : {-65, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    EXPECT_EQ(with_level("raw", level), Status::invalid_settings);
    EXPECT_EQ(with_level("lz4", level), Status::invalid_settings);
    EXPECT_EQ(with_level("zstd", level), Status::invalid_settings);
  }
  EXPECT_EQ(with_level("raw", 1), Status::invalid_settings);
  EXPECT_EQ(with_level("raw", -1), Status::invalid_settings);
  EXPECT_EQ(with_level("lz4", 13), Status::invalid_settings);
  EXPECT_EQ(with_level("zstd", 23), Status::invalid_settings);
  EXPECT_EQ(with_level("lz4", 12), Status::ok);
  EXPECT_EQ(with_level("lz4", -64), Status::ok);
  EXPECT_EQ(with_level("zstd", -64), Status::ok);
  EXPECT_EQ(with_level("zstd", 22), Status::ok);
  EncoderOptions preset;
  preset.settings.preset = "slow";
  EXPECT_EQ(status(kDesc, preset), Status::invalid_settings);
  EncoderOptions isa;
  isa.settings.isa = static_cast<Isa>(200);
  EXPECT_EQ(status(kDesc, isa), Status::invalid_settings);
  EXPECT_EQ(status(probe_texture(Format::R32G32B32A32_SFLOAT, {4096, 4096, 1}, 64, 1)),
            Status::limit_exceeded);
}

TEST_F(SessionError, CreateDecoder) {
  EXPECT_EQ(Decoder::create({}).status(), Status::unsupported_format);
  EXPECT_EQ(Decoder::create(probe_texture(Format::R16_SFLOAT, {1, 1, 1}, 65, 1)).status(),
            Status::invalid_description);
  DecoderOptions options;
  options.limits.max_texture_bytes = texture_bytes(kDesc);
  EXPECT_TRUE(Decoder::create(kDesc, options).ok());
  options.limits.max_texture_bytes -= 1;
  EXPECT_EQ(Decoder::create(kDesc, options).status(), Status::limit_exceeded);
  EXPECT_EQ(
      Decoder::create(probe_texture(Format::R32G32B32A32_SFLOAT, {4096, 4096, 1}, 64, 1)).status(),
      Status::limit_exceeded);
  options = {};
  options.backends = {nullptr};
  EXPECT_EQ(Decoder::create(kDesc, options).status(), Status::invalid_argument);
  options = {};
  options.isa = static_cast<Isa>(200);
  EXPECT_EQ(Decoder::create(kDesc, options).status(), Status::invalid_settings);
}

TEST_F(SessionError, NativeRefusesAnUnknownInstructionSet) {
  const auto backends = built_in_backends();
  const auto native = std::find_if(backends.begin(), backends.end(),
                                   [](const Backend* b) { return b->id() == kBackendNative; });
  ASSERT_NE(native, backends.end());
  const auto decoder = (*native)->make_decoder(kDesc);
  ASSERT_TRUE(decoder.ok());
  DecodeJob job{kDesc, {}, {}, {}, {}, true};
  job.isa = static_cast<Isa>(200);
  EXPECT_EQ((*decoder)->decode(job), Status::invalid_settings);
}

TEST_F(SessionError, ArgumentsOfEncode) {
  auto encoder = *Encoder::create(kDesc);
  auto decoder = *Decoder::create(kDesc);
  ASSERT_EQ(decoder.decode(next(encoder)), Status::ok);
  const auto before = contents(encoder);
  texture_.fill_block(1, Fill::noise, random_);

  auto small = view();
  small.bytes = small.bytes.first(small.bytes.size() - 1);
  EXPECT_EQ(encoder.encode(small).status(), Status::view_too_small);
  const auto total = block_count(kDesc);
  using List = std::vector<std::uint32_t>;
  EXPECT_EQ(encoder.encode(view(), List{total}).status(), Status::block_out_of_range);
  EXPECT_EQ(encoder.encode(view(), List{0, UINT32_MAX, 1}).status(), Status::block_out_of_range);
  EXPECT_EQ(encoder.encode(view(), List{5, 3, 5}).status(), Status::block_repeated);
  EXPECT_EQ(encoder.encode(view(), List(total + 5, 0)).status(), Status::block_repeated);
  EXPECT_EQ(encoder.set_active(std::vector<std::uint8_t>(total - 1)), Status::mask_mismatch);
  Texture out(kDesc);
  auto small_out = out.view();
  small_out.bytes = small_out.bytes.first(1);
  EXPECT_EQ(encoder.read(small_out), Status::view_too_small);

  EXPECT_EQ(encoder.sequence(), 1U);
  EXPECT_TRUE(contents(encoder) == before);
  const auto packet = next(encoder);
  EXPECT_FALSE(is_keyframe(peek(packet)->type));
  EXPECT_EQ(decoder.decode(packet), Status::ok);
  EXPECT_TRUE(contents(decoder) == texture_.blocks());
}

TEST_F(SessionError, TooSmallABufferChangesNothing) {
  for (const auto& coding : codings()) {
    auto encoder = *Encoder::create(kDesc, options_of(coding));
    auto decoder = *Decoder::create(kDesc);
    ASSERT_EQ(decoder.decode(next(encoder)), Status::ok);
    const auto before = contents(encoder);
    texture_.fill_block(2, Fill::noise, random_);
    for (const std::size_t size : {0U, 1U, 20U}) {
      Exact room(size);
      EXPECT_EQ(encoder.encode_to(view(), Selection::changed(), room.span()).status(),
                Status::buffer_too_small);
      EXPECT_EQ(encoder.sequence(), 1U);
      EXPECT_TRUE(contents(encoder) == before);
    }
    Exact room(encoder.bound(block_count(kDesc)));
    const auto size = encoder.encode_to(view(), Selection::changed(), room.span());
    ASSERT_TRUE(size.ok());
    ASSERT_EQ(decoder.decode(room.span().first(*size)), Status::ok);
    EXPECT_TRUE(contents(decoder) == texture_.blocks());
    EXPECT_EQ(decoder.sequence(), 2U);
  }
}

TEST_F(SessionError, BoundOfTooManyBlocksIsThatOfAll) {
  for (const auto& coding : codings()) {
    const auto encoder = *Encoder::create(kDesc, options_of(coding));
    EXPECT_EQ(encoder.bound(SIZE_MAX), encoder.bound(block_count(kDesc)));
    EXPECT_LE(encoder.bound(0), encoder.bound(1));
  }
}

TEST_F(SessionError, BoundHoldsForWhiteNoiseWithEveryGuardBandStale) {
  for (const auto& info : test::distinct_formats()) {
    const TextureDesc desc = probe_texture(info.record, {3, 3, 2}, 5, 1, Tiling::atlas_xy_z);
    Texture texture(desc);
    for (std::uint32_t probe = 0; probe < block_count(desc); ++probe) {
      texture.set_block(probe, noise(random_, texture.block(probe).size()));
    }
    for (const auto& coding : codings()) {
      auto encoder = *Encoder::create(desc, options_of(coding));
      for (int frame = 0; frame < 2; ++frame) {
        Exact room(encoder.bound(block_count(desc)));
        EXPECT_TRUE(
            encoder.encode_to(std::as_const(texture).view(), Selection::all(), room.span()).ok())
            << info.name << " " << coding.backend;
      }
    }
  }
}

TEST_F(SessionError, LostAndReorderedPackets) {
  for (const auto& coding : codings()) {
    auto encoder = *Encoder::create(kDesc, options_of(coding));
    auto decoder = *Decoder::create(kDesc);
    const auto first = next(encoder);
    const auto second = next(encoder);
    const auto third = next(encoder);
    EXPECT_EQ(decoder.decode(second), Status::reference_missing);
    EXPECT_EQ(decoder.sequence(), 0U);
    ASSERT_EQ(decoder.decode(first), Status::ok);
    const auto before = contents(decoder);
    EXPECT_EQ(decoder.decode(third), Status::reference_missing);
    EXPECT_TRUE(contents(decoder) == before);
    EXPECT_EQ(decoder.sequence(), 1U);
    ASSERT_EQ(decoder.decode(second), Status::ok);
    EXPECT_EQ(decoder.decode(second), Status::reference_missing);
    ASSERT_EQ(decoder.decode(third), Status::ok);
    EXPECT_TRUE(contents(decoder) == texture_.blocks());
    (void)next(encoder);  // Lost.
    EXPECT_EQ(decoder.decode(next(encoder)), Status::reference_missing);
    encoder.request_keyframe();
    ASSERT_EQ(decoder.decode(next(encoder)), Status::ok);
    EXPECT_TRUE(contents(decoder) == texture_.blocks());
    ASSERT_EQ(decoder.decode(next(encoder)), Status::ok);
    EXPECT_TRUE(contents(decoder) == texture_.blocks());
  }
}

TEST_F(SessionError, PacketsOfAnotherTexture) {
  auto encoder = *Encoder::create(kDesc);
  const auto keyframe = next(encoder);
  const auto update = next(encoder);
  const auto mismatch = [&](auto change) {
    TextureDesc desc = kDesc;
    change(desc);
    return Decoder::create(desc)->decode(keyframe);
  };
  EXPECT_EQ(mismatch([](auto& d) { d.record = Format::R32_SFLOAT; }), Status::description_mismatch);
  EXPECT_EQ(mismatch([](auto& d) { d.grid = {2, 3, 2}; }), Status::description_mismatch);
  EXPECT_EQ(mismatch([](auto& d) { d.block = {5, 5, 1}; }), Status::description_mismatch);
  EXPECT_EQ(mismatch([](auto& d) { d.guard_band = 0; }), Status::description_mismatch);
  EXPECT_EQ(mismatch([](auto& d) { d.layout = Tiling::atlas_xz_y; }), Status::ok);
  EXPECT_EQ(mismatch([](auto& d) { d.model = Model::continuous; }), Status::description_mismatch);

  // An update belongs to the keyframe of its own texture id.
  auto other = *Encoder::create(kDesc, {.texture_id = 1});
  auto decoder = *Decoder::create(kDesc);
  ASSERT_EQ(decoder.decode(next(other)), Status::ok);
  EXPECT_EQ(decoder.decode(update), Status::reference_missing);
  EXPECT_EQ(decoder.decode(next(other)), Status::ok);
}

TEST_F(SessionError, ViewsOfTheDecoder) {
  auto encoder = *Encoder::create(kDesc);
  auto decoder = *Decoder::create(kDesc);
  const auto packet = next(encoder);
  Texture out(kDesc);
  auto small = out.view();
  small.bytes = small.bytes.first(small.bytes.size() - 1);
  EXPECT_EQ(decoder.decode(packet, small), Status::view_too_small);
  EXPECT_EQ(decoder.sequence(), 0U);
  EXPECT_EQ(decoder.read(small), Status::view_too_small);
  EXPECT_EQ(decoder.read(small, std::vector<std::uint32_t>{0}), Status::view_too_small);
  EXPECT_EQ(decoder.read(out.view(), std::vector<std::uint32_t>{0, block_count(kDesc)}),
            Status::block_out_of_range);
  EXPECT_EQ(decoder.decode(packet, out.view()), Status::ok);
}

TEST_F(SessionError, BlocksOfATextureWithinAnother) {
  auto encoder = *Encoder::create(kDesc);
  auto decoder = *Decoder::create(kDesc);
  EXPECT_TRUE(std::all_of(decoder.records().begin(), decoder.records().end(),
                          [](std::byte b) { return b == std::byte{0}; }));
  ASSERT_EQ(decoder.decode(next(encoder)), Status::ok);
  Texture out(kDesc);
  const std::uint32_t last = block_count(kDesc) - 1;
  const auto read = [&](std::uint32_t block, std::uint32_t place) {
    return decoder.read({&block, 1}, kDesc, out.view(), {&place, 1});
  };
  EXPECT_EQ(read(0, last), Status::ok);
  EXPECT_EQ(read(last, 0), Status::ok);
  EXPECT_EQ(read(last + 1, 0), Status::block_out_of_range);
  EXPECT_EQ(read(0, last + 1), Status::block_out_of_range);
}

/// Where the list of blocks takes as much as they do.
TEST_F(SessionError, BoundHoldsForManyTinyBlocks) {
  const TextureDesc desc = map_texture(Format::R8_UINT, {64, 64, 1}, {1, 1, 1});
  auto encoder = *Encoder::create(desc, {.backend = "raw", .gop = 0});
  Texture texture(desc);
  ASSERT_TRUE(encoder.encode(std::as_const(texture).view()).ok());
  texture.fill(Fill::noise, random_);
  std::vector<std::uint32_t> some;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    if (pick(random_, 0, 1) == 0) some.push_back(block);
  }
  const auto packet = encoder.encode(std::as_const(texture).view(), some);
  ASSERT_TRUE(packet.ok());
  EXPECT_GT(packet->size(), some.size() + 256);
  EXPECT_LE(packet->size(), encoder.bound(some.size()));
}

TEST_F(SessionError, PacketLimit) {
  auto encoder = *Encoder::create(kDesc);
  const auto packet = next(encoder);
  DecoderOptions options;
  options.limits.max_packet_bytes = packet.size() - 1;
  EXPECT_EQ(Decoder::create(kDesc, options)->decode(packet), Status::limit_exceeded);
  options.limits.max_packet_bytes = packet.size();
  EXPECT_EQ(Decoder::create(kDesc, options)->decode(packet), Status::ok);
}

TEST_F(SessionError, FailingBackends) {
  using Mood = MoodyBackend::Mood;
  auto mood = Mood::fail;
  const MoodyBackend backend(mood);
  const EncoderOptions options{.backend = "moody", .gop = 0, .backends = {&backend}};
  EXPECT_EQ(Encoder::create(kDesc, options).status(), Status::backend_unavailable);
  EXPECT_EQ(Decoder::create(kDesc, {.backends = {&backend}}).status(), Status::backend_unavailable);
  mood = Mood::throw_bad_alloc;
  EXPECT_EQ(Encoder::create(kDesc, options).status(), Status::out_of_memory);
  mood = Mood::good;
  TextureDesc unsupported = kDesc;
  unsupported.record = Format::R32_SFLOAT;
  EXPECT_EQ(Encoder::create(unsupported, options).status(), Status::unsupported_format);
  EXPECT_TRUE(Decoder::create(unsupported, {.backends = {&backend}}).ok());

  auto encoder = *Encoder::create(kDesc, options);
  auto decoder = *Decoder::create(kDesc, {.backends = {&backend}});
  auto without = *Decoder::create(kDesc);
  const auto first = next(encoder);
  EXPECT_EQ(without.decode(first), Status::backend_missing);
  ASSERT_EQ(decoder.decode(first), Status::ok);
  for (const auto& [bad, status] : {std::pair{Mood::fail, Status::backend_failed},
                                    std::pair{Mood::throw_bad_alloc, Status::out_of_memory},
                                    std::pair{Mood::throw_other, Status::backend_failed},
                                    std::pair{Mood::exceed_bound, Status::backend_failed}}) {
    mood = bad;
    const auto before = contents(encoder);
    const auto sequence = encoder.sequence();
    texture_.fill_block(0, Fill::noise, random_);
    EXPECT_EQ(encoder.encode(view()).status(), status);
    EXPECT_TRUE(contents(encoder) == before);
    EXPECT_EQ(encoder.sequence(), sequence);
    mood = Mood::good;
    const auto packet = next(encoder);
    EXPECT_FALSE(is_keyframe(peek(packet)->type));  // As if nothing had happened.
    if (bad != Mood::exceed_bound) {
      const auto held = contents(decoder);
      mood = bad;
      EXPECT_EQ(decoder.decode(packet), status);
      EXPECT_TRUE(contents(decoder) == held);
      mood = Mood::good;
    }
    ASSERT_EQ(decoder.decode(packet), Status::ok);
    EXPECT_TRUE(contents(decoder) == texture_.blocks());
  }
}

/// The same, whether a decoder of another texture has made the backend in the memory they share.
TEST_F(SessionError, SharedMemoryChangesNoVerdict) {
  auto scratch = DecoderScratch::create();
  ASSERT_TRUE(scratch.ok());
  TextureDesc other = kDesc;
  other.record = Format::BC7_UNORM_BLOCK;
  other.guard_band = 0;
  other.presence = Presence::count;
  auto first = *Decoder::create(kDesc, {.scratch = *scratch});
  auto second = *Decoder::create(other, {.scratch = *scratch});
  auto alone = *Decoder::create(other);
  const Bytes presence(2 * block_count(other));
  ASSERT_EQ(second.set_presence(presence), Status::ok);
  ASSERT_EQ(alone.set_presence(presence), Status::ok);
  auto encoder = *Encoder::create(kDesc);
  const auto packet = next(encoder);
  ASSERT_EQ(first.decode(packet), Status::ok);
  // The same payload in a packet for the other texture.
  const auto parts = *parse_packet(packet);
  PacketHead head{
      .info = parts.info, .index_mode = parts.index_mode, .base = description_hash(other)};
  Packet forged;
  write_packet_head(head, parts.index, {}, forged);
  forged.insert(forged.end(), parts.payload.begin(), parts.payload.end());
  seal_packet(forged);
  EXPECT_EQ(alone.decode(forged), Status::corrupt);
  EXPECT_EQ(second.decode(forged), Status::corrupt);
  EXPECT_EQ(second.sequence(), 0U);
}

TEST_F(SessionError, NullBackendsAreSkippedByTheEncoder) {
  EXPECT_TRUE(Encoder::create(kDesc, {.backend = "raw", .backends = {nullptr}}).ok());
}

}  // namespace
}  // namespace gicodec

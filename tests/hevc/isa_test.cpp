// The HEVC backend's own loops on every instruction set: the same payloads and records, and none of
// another set. (x265, libde265 and FFmpeg choose for themselves.)
#include "backend/hevc/picture.h"
#include "hevc/session.h"
#include "trap_kernels.h"

#include <gtest/gtest.h>

namespace gicodec::test {
namespace {

constexpr Format kFormats[] = {Format::A2R10G10B10_UNORM_PACK32, Format::R16G16_SFLOAT};

/// A picture of noise by one set, and the records that come back.
struct Outcome {
  std::vector<std::byte> samples, raster;
  bool operator==(const Outcome&) const = default;
};
Outcome pack_with(Isa isa, Format format, HevcPacking packing) {
  const TextureDesc desc = probe_texture(format, {5, 2, 2}, 9, 1, Tiling::atlas_xy_z);
  const auto shape = *hevc::frame_shape(desc, packing, HevcLayout::atlas, 0);
  std::mt19937 random(5);
  Outcome out;
  out.raster.resize(hevc::raster_bytes(desc, shape));
  for (auto& byte : out.raster) byte = static_cast<std::byte>(random());
  hevc::Picture picture;
  hevc::raster_to_picture(isa, desc, shape, out.raster, picture);
  out.samples = picture.samples;
  hevc::picture_to_raster(isa, desc, shape, picture, out.raster);
  return out;
}

TEST(HevcIsa, EverySetGivesTheSamePictures) {
  for (const Format format : kFormats) {
    for (const auto packing : {HevcPacking::paper, HevcPacking::planes}) {
      const auto expected = pack_with(Isa::scalar, format, packing);
      for (const Isa isa : supported_isas().subspan(1)) {
        EXPECT_TRUE(pack_with(isa, format, packing) == expected) << to_string(isa);
      }
    }
  }
}

TEST(HevcIsa, ASetThatTheMachineLacksIsRefused) {
  const auto desc = ddgi_irradiance({2, 1, 1});
  BackendSettings settings;
  settings.isa = static_cast<Isa>(200);
  EXPECT_EQ(HevcBackend().make_encoder(desc, settings).status(), Status::invalid_settings);
  const auto decoder = *HevcBackend().make_decoder(desc);
  DecodeJob job{desc, {}, {}, {}, {}, true};
  job.isa = settings.isa;
  EXPECT_EQ(decoder->decode(job), Status::invalid_settings);
}

#if defined(GICODEC_TRAPS)

/// A keyframe through a session with one set only. Ends the process.
[[noreturn]] void run_with(Isa isa) {
  for (const Isa other : supported_isas()) {
    if (other != isa) trap_kernels(other);
  }
  bool good = true;
  for (const Format format : kFormats) {
    for (const auto packing : {HevcPacking::paper, HevcPacking::planes}) {
      const TextureDesc desc = probe_texture(format, {3, 1, 2}, 8, 1, Tiling::atlas_xy_z);
      const HevcBackend backend({.packing = packing});
      const auto encoder = *backend.make_encoder(desc, {.preset = "ultrafast", .isa = isa});
      const auto decoder = *backend.make_decoder(desc);
      const auto blocks = all_blocks(desc);
      std::vector<std::byte> records(blocks.size() * block_bytes(desc), std::byte{0x35});
      std::vector<std::byte> back(records.size()), payload;
      good = good && encoder->encode({desc, blocks, {records.data(), block_bytes(desc)}, {}, true},
                                     payload) == Status::ok;
      DecodeJob job{desc, blocks, payload, {}, back, true};
      job.isa = isa;
      good = good && decoder->decode(job) == Status::ok && back == records;
    }
  }
  std::_Exit(good ? 0 : 1);
}

TEST(HevcIsa, SessionsUseItAndNoOther) {
  for (const Isa isa : supported_isas()) {
    EXPECT_EXIT(run_with(isa), testing::ExitedWithCode(0), "") << to_string(isa);
  }
}

#endif

}  // namespace
}  // namespace gicodec::test

// The reference decoder, written from docs/native.md alone, reads every native golden file.
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"
#include "golden/native_golden.h"
#include "native/reference_decoder.h"

#include <gicodec/container.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>

namespace gicodec {
namespace {

using test::Bytes;

/// Core texels of every probe.
Bytes cores_of(const test::Texture& texture) {
  const auto& desc = texture.desc();
  const std::size_t texel = find_format(desc.format)->texel_bytes;
  const std::size_t side = desc.core + 2U * desc.border;
  Bytes cores;
  for (std::uint32_t probe = 0; probe < probe_count(desc); ++probe) {
    const Bytes block = texture.block(probe);
    for (std::size_t y = desc.border; y < side - desc.border; ++y) {
      const auto row =
          block.begin() + static_cast<std::ptrdiff_t>((y * side + desc.border) * texel);
      cores.insert(cores.end(), row, row + static_cast<std::ptrdiff_t>(desc.core * texel));
    }
  }
  return cores;
}

struct Files {
  std::string name;
  void (*paint)(test::Texture&, std::uint32_t frame);
  std::uint32_t frame_step;  ///< frame numbers in the container per painted frame
};
class NativeGolden : public testing::TestWithParam<Files> {};

TEST_P(NativeGolden, ReferenceDecoderReadsIt) {
  std::ifstream file(std::string(GICODEC_GOLDEN_DIR "/") + GetParam().name, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  MemorySource source(std::as_bytes(std::span(text)));
  auto reader = ContainerReader::open(source);
  ASSERT_TRUE(reader.ok()) << reader.status();
  const auto& textures = reader->description().textures;
  std::vector<Bytes> mirrors(textures.size());
  ContainerPacket packet;
  std::size_t packets = 0;
  for (; reader->next(packet) == Status::ok; ++packets) {
    const auto& desc = textures[packet.texture_id].desc;
    const std::size_t size = core_bytes(desc);
    const auto parts = parse_packet(packet.bytes);
    ASSERT_TRUE(parts.ok());
    ASSERT_EQ(parts->info.backend, kBackendNative);
    const bool keyframe = parts->info.keyframe;
    std::vector<std::uint32_t> probes;
    const auto count = parts->info.all_probes ? probe_count(desc) : parts->info.probes;
    ASSERT_EQ(
        decode_index_buffer(parts->index_mode, count, probe_count(desc), parts->index, probes),
        Status::ok);
    Bytes& mirror = mirrors[packet.texture_id];
    const auto texels =
        reference::decode(desc, probes, keyframe ? Bytes{} : mirror, parts->payload);
    ASSERT_TRUE(texels.has_value()) << packet.frame << " " << desc;
    if (keyframe) mirror.assign(probe_count(desc) * size, std::byte{0});
    test::Texture painted(desc);
    GetParam().paint(painted, static_cast<std::uint32_t>(packet.frame) / GetParam().frame_step);
    const Bytes expected = cores_of(painted);
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const std::size_t at = probes[i] * size;
      EXPECT_EQ(std::memcmp(texels->data() + i * size, expected.data() + at, size), 0)
          << "frame " << packet.frame << " " << desc << " probe " << probes[i];
      std::memcpy(mirror.data() + at, texels->data() + i * size, size);
    }
  }
  EXPECT_EQ(packets % textures.size(), 0U);
  EXPECT_GE(packets, 3 * textures.size());
}

INSTANTIATE_TEST_SUITE_P(Files, NativeGolden,
                         testing::Values(Files{"sequence_native.gic", golden::paint, 10},
                                         Files{"native_fast.gic", golden::paint_native, 1},
                                         Files{"native_strong.gic", golden::paint_native, 1}),
                         [](const auto& test) {
                           return test.param.name.substr(0, test.param.name.find('.'));
                         });

}  // namespace
}  // namespace gicodec

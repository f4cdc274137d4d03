// Payloads that are cut, damaged or out of place: the exact records or an error, never anything
// else, and a working session after the next keyframe.
#include "backend/hevc/payload.h"
#include "base/compressor.h"
#include "hevc/session.h"

#include <gtest/gtest.h>

#include <string>

namespace gicodec::test {
namespace {

constexpr std::size_t kHeadBytes = 9;

struct Case {
  TextureDesc desc;
  HevcSettings settings;
};

std::vector<Case> cases() {
  const TextureDesc colour =
      probe_texture(Format::A2R10G10B10_UNORM_PACK32, {3, 1, 2}, 8, 1, Tiling::atlas_xy_z);
  const TextureDesc visibility =
      probe_texture(Format::R16G16_SFLOAT, {3, 1, 1}, 8, 1, Tiling::atlas_xy_z);
  return {{colour, {}},
          {colour, {.packing = HevcPacking::planes, .layout = HevcLayout::packed}},
          {visibility, {}},
          {visibility, {.packing = HevcPacking::planes}}};
}

// A keyframe, an update, another keyframe.
struct Stream {
  explicit Stream(const Case& test) : sender(test.desc, test.settings) {
    updates.push_back(sender.next(all_blocks(test.desc), true, 3));
    updates.push_back(sender.next(all_blocks(test.desc), false, 3));
    updates.push_back(sender.next(all_blocks(test.desc), true, 3));
  }
  Sender sender;
  std::vector<Update> updates;
};

// Feeds damaged bytes in place of update `index` and checks everything the contract says.
void expect_sound(Receiver& receiver, const Stream& stream, std::size_t index,
                  std::span<const std::byte> damaged, const std::string& what) {
  if (index == 1) {
    ASSERT_EQ(receiver.receive(stream.updates[0]), Status::ok) << what;
  }
  const Update& update = stream.updates[index];
  if (receiver.receive(update, damaged) == Status::ok) {
    ASSERT_EQ(receiver.records(), update.records) << what;
  } else {
    ASSERT_EQ(receiver.receive(stream.updates[1]), Status::reference_missing) << what;
  }
  ASSERT_EQ(receiver.receive(stream.updates[2]), Status::ok) << what;
  ASSERT_EQ(receiver.records(), stream.updates[2].records) << what;
}

class Hostile : public testing::TestWithParam<const char*> {};

TEST_P(Hostile, EveryPrefix) {
  for (const Case& test : cases()) {
    const Stream stream(test);
    Receiver receiver(test.desc, GetParam());
    for (const std::size_t index : {0U, 1U}) {
      const std::span<const std::byte> payload = stream.updates[index].payload;
      // Heads and parameter sets byte by byte, slice data in steps.
      for (std::size_t size = 0; size < payload.size(); size += size < 120 ? 1 : 13) {
        expect_sound(receiver, stream, index, payload.first(size), "size " + std::to_string(size));
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST_P(Hostile, SingleBits) {
  std::mt19937 random(7);
  for (const Case& test : cases()) {
    const Stream stream(test);
    Receiver receiver(test.desc, GetParam());
    for (const std::size_t index : {0U, 1U}) {
      std::vector<std::byte> damaged = stream.updates[index].payload;
      const std::size_t bits = 8 * damaged.size(), dense = std::min<std::size_t>(bits, 8 * 120);
      for (int i = 0; i < 250; ++i) {
        const std::size_t bit = random() % (i % 2 == 0 ? dense : bits);
        const auto mask = static_cast<std::byte>(1U << bit % 8);
        damaged[bit / 8] ^= mask;
        expect_sound(receiver, stream, index, damaged, "bit " + std::to_string(bit));
        if (HasFatalFailure()) return;
        damaged[bit / 8] ^= mask;
      }
    }
  }
}

TEST_P(Hostile, OverwrittenBytes) {
  std::mt19937 random(11);
  for (const Case& test : cases()) {
    const Stream stream(test);
    Receiver receiver(test.desc, GetParam());
    for (int i = 0; i < 150; ++i) {
      const std::size_t index = i % 2 == 0 ? 0U : 1U;
      std::vector<std::byte> damaged = stream.updates[index].payload;
      const std::size_t from = kHeadBytes + random() % (damaged.size() - kHeadBytes);
      const std::size_t until = std::min(damaged.size(), from + 1 + random() % 32);
      for (std::size_t k = from; k < until; ++k) damaged[k] = static_cast<std::byte>(random());
      expect_sound(receiver, stream, index, damaged, "from " + std::to_string(from));
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(Hostile, UpdatesOutOfPlace) {
  for (const Case& test : cases()) {
    const Stream stream(test);
    Receiver receiver(test.desc, GetParam());
    // Before any keyframe; a picture that needs another in place of a keyframe; another shape.
    EXPECT_EQ(receiver.receive(stream.updates[1]), Status::reference_missing);
    Update false_keyframe = stream.updates[1];
    false_keyframe.keyframe = true;
    EXPECT_EQ(receiver.receive(false_keyframe), Status::corrupt);
    ASSERT_EQ(receiver.receive(stream.updates[0]), Status::ok);
    auto other_packing = stream.updates[1].payload;
    other_packing[1] ^= std::byte{1};
    EXPECT_NE(receiver.receive(stream.updates[1], other_packing), Status::ok);
    // Fewer blocks than the hash was made of.
    ASSERT_EQ(receiver.receive(stream.updates[0]), Status::ok);
    Update fewer = stream.updates[1];
    fewer.blocks.pop_back();
    EXPECT_EQ(receiver.receive(fewer), Status::corrupt);
    // A payload where none belongs, none where one belongs.
    Update none = stream.updates[0];
    none.blocks.clear();
    EXPECT_EQ(receiver.receive(none), Status::corrupt);
    EXPECT_EQ(receiver.receive(stream.updates[0], {}), Status::truncated);
  }
}

TEST_P(Hostile, PayloadsOfOtherTextures) {
  const auto all = cases();
  for (const Case& made : all) {
    const Stream stream(made);
    for (const Case& read : all) {
      if (read.desc == made.desc) continue;
      Receiver receiver(read.desc, GetParam());
      Update update = stream.updates[0];
      update.blocks = all_blocks(read.desc);
      EXPECT_NE(receiver.receive(update), Status::ok);
    }
  }
}

// What the head and the alpha section must be, besides what damage finds.
TEST_P(Hostile, HeadsAndAlphaSectionsOutOfForm) {
  // Nine records: the last of three bytes has one code and six bits that must be zero.
  const TextureDesc desc =
      probe_texture(Format::A2R10G10B10_UNORM_PACK32, {1, 1, 1}, 3, 1, Tiling::atlas_xy_z);
  Sender sender(desc, {});
  const Update update = sender.next(all_blocks(desc), true);
  const auto payload = *hevc::read_payload(update.payload);
  ASSERT_EQ(payload.head.alpha, hevc::kAlphaCoded);
  Receiver receiver(desc, GetParam());
  const auto with_section = [&](std::span<const std::byte> section) {
    std::vector<std::byte> bytes;
    hevc::write_payload(payload.head, section, payload.access_unit, bytes);
    return receiver.receive(update, bytes);
  };
  const std::vector<std::byte> good(payload.alpha_section.begin(), payload.alpha_section.end());
  EXPECT_EQ(with_section(good), Status::ok);

  const auto frame_of = [](std::span<const std::byte> bytes) {
    std::vector<std::byte> frame;
    EXPECT_EQ(Compressor::create(Compression::zstd, 0)->compress(bytes, frame), Status::ok);
    return frame;
  };
  std::vector<std::byte> codes(3);
  ASSERT_EQ(Decompressor::create(Compression::zstd)->decompress(good, codes), Status::ok);
  ASSERT_EQ(std::to_integer<unsigned>(codes[2]) >> 2, 0U);
  EXPECT_EQ(with_section(frame_of(codes)), Status::ok);
  // Two frames of the right bytes, a skippable frame before or behind, something behind, nothing.
  auto two = frame_of(std::span(codes).first(1));
  const auto second = frame_of(std::span(codes).last(2));
  two.insert(two.end(), second.begin(), second.end());
  EXPECT_EQ(with_section(two), Status::corrupt);
  const std::byte skippable[] = {std::byte{0x50}, std::byte{0x2A}, std::byte{0x4D}, std::byte{0x18},
                                 std::byte{0},    std::byte{0},    std::byte{0},    std::byte{0}};
  auto before = good, behind = good;
  before.insert(before.begin(), std::begin(skippable), std::end(skippable));
  behind.insert(behind.end(), std::begin(skippable), std::end(skippable));
  EXPECT_EQ(with_section(before), Status::corrupt);
  EXPECT_EQ(with_section(behind), Status::corrupt);
  behind = good;
  behind.push_back(std::byte{0});
  EXPECT_EQ(with_section(behind), Status::corrupt);
  EXPECT_EQ(with_section({}), Status::corrupt);
  // Bits behind the last code.
  codes[2] |= std::byte{0x04};
  EXPECT_EQ(with_section(frame_of(codes)), Status::corrupt);
  codes[2] ^= std::byte{0x84};
  EXPECT_EQ(with_section(frame_of(codes)), Status::corrupt);

  // Only colour of 10 bits may be lossy or have alpha.
  const TextureDesc other =
      probe_texture(Format::R16G16_SFLOAT, {1, 1, 1}, 3, 1, Tiling::atlas_xy_z);
  Sender plain(other, {});
  const Update exact = plain.next(all_blocks(other), true);
  Receiver plain_receiver(other, GetParam());
  const auto with_byte = [&](std::size_t at, int value) {
    auto bytes = exact.payload;
    bytes[at] = static_cast<std::byte>(value);
    return plain_receiver.receive(exact, bytes);
  };
  EXPECT_EQ(with_byte(1, 0), Status::ok);
  EXPECT_EQ(with_byte(0, 2), Status::unsupported_version);
  EXPECT_EQ(with_byte(1, 4), Status::corrupt);  // Lossy.
  for (const int luma : {8, 9, 12, 13}) EXPECT_EQ(with_byte(1, luma), Status::corrupt) << luma;
  for (const int bit : {16, 32, 64, 128}) {
    EXPECT_EQ(with_byte(1, bit), Status::unsupported_feature);
  }
  EXPECT_EQ(with_byte(2, 10), Status::corrupt);  // Bit depth.
  EXPECT_EQ(with_byte(3, 1), Status::corrupt);   // A size class in an atlas.
  // Longer than any picture of that size needs.
  auto endless = exact.payload;
  endless.resize(plain.encoder().bound(exact.blocks.size()) + 1, std::byte{1});
  EXPECT_EQ(plain_receiver.receive(exact, endless), Status::corrupt);
  for (const int alpha : {1, 4, 5}) EXPECT_EQ(with_byte(4, alpha), Status::corrupt) << alpha;
}

INSTANTIATE_TEST_SUITE_P(Hevc, Hostile, testing::Values("libde265", "ffmpeg"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace gicodec::test

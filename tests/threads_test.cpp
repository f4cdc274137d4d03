// Sessions on several threads, with textures large enough that all of them get something to do.
#include "shapes.h"
#include "support.h"

#include "base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

TEST(Threads, RangesAreAllItemsOnce) {
  for (const std::size_t items : {0, 1, 7, 64, 1000}) {
    for (const unsigned threads : {1U, 3U, 8U}) {
      std::vector<int> visits(items);
      for_each_range(threads, items, 5, [&](unsigned, std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) ++visits[i];
      });
      EXPECT_TRUE(std::ranges::all_of(visits, [](int n) { return n == 1; })) << items;
    }
  }
}

TEST(Threads, AnExceptionOfAnyIsPassedOn) {
  const auto fail = [](unsigned, std::size_t first, std::size_t) {
    if (first > 0) throw std::runtime_error("range");
  };
  EXPECT_THROW(for_each_range(4, 100, 1, fail), std::runtime_error);
}

/// Both ends with one thread and with several.
class Pair {
 public:
  Pair(const TextureDesc& desc, unsigned threads)
      : encoder(*Encoder::create(desc, options(threads))),
        decoder(*Decoder::create(desc, decoding(threads))),
        out(desc) {}

  Encoder encoder;
  Decoder decoder;
  Texture out;  ///< what decode() wrote

 private:
  static EncoderOptions options(unsigned threads) {
    EncoderOptions options = options_of({"raw", 0, true});
    options.gop = 0;
    options.settings.threads = threads;
    return options;
  }
  static DecoderOptions decoding(unsigned threads) {
    DecoderOptions options;
    options.threads = threads;
    return options;
  }
};

TextureDesc masked() {
  TextureDesc desc = pool_texture(Format::R32G32B32A32_SFLOAT, 600, {8, 8, 8});
  desc.presence = Presence::mask;
  return desc;
}

/// Records and presence change in many blocks or few, guard bands by the rule or not.
void change(Texture& texture, Bytes& presence, std::uint32_t one_in, Random& random) {
  const auto& desc = texture.desc();
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    if (!chance(random, one_in)) continue;
    texture.fill_block(block, Fill::small, random);
    if (one_in != 2 && !chance(random, 50)) texture.fill_band(block);
  }
  if (!presence.empty() && one_in < 5) presence = any_presence(random, desc);
}

TEST(Threads, SessionsDoWhatTheyDoOnOne) {
  Random random(91);
  for (const TextureDesc& desc :
       {probe_texture(Format::R32G32B32A32_SFLOAT, {16, 8, 9}, 16, 1), masked()}) {
    Texture texture(desc);
    texture.fill(Fill::noise, random);
    Bytes presence = any_presence(random, desc);
    Pair one(desc, 1), many(desc, 3);
    Texture read(desc), sent(desc);
    std::vector<std::uint32_t> some;
    for (std::uint32_t block = 0; block < block_count(desc); block += 1 + block % 7 / 6) {
      some.push_back(block);
    }
    std::vector<std::uint32_t> twice = some;
    twice.insert(twice.end(), some.begin(), some.end());
    for (const std::uint32_t one_in : {1, 2, 40, 3, 100000}) {
      change(texture, presence, one_in, random);
      const bool keyframe = one_in == 3;  // Of some blocks.
      Packet packets[2];
      for (Pair* pair : {&one, &many}) {
        ASSERT_EQ(pair->encoder.set_presence(presence), Status::ok);
        if (keyframe) pair->encoder.request_keyframe();
        Packet& packet = packets[pair == &many ? 1 : 0];
        const auto view = std::as_const(texture).view();
        ASSERT_EQ(pair->encoder.encode_to(view, keyframe ? some : Selection::changed(), packet),
                  Status::ok);
        ASSERT_EQ(pair->decoder.set_presence(presence), Status::ok);
        ASSERT_EQ(pair->decoder.decode(packet, pair->out.view()), Status::ok);
      }
      ASSERT_TRUE(packets[0] == packets[1]);
      ASSERT_EQ(one.decoder.state_hash(), many.decoder.state_hash());
      const auto same_view = [&](Texture& other) {
        return same(many.out.view().bytes, other.view().bytes);
      };
      ASSERT_TRUE(same_view(one.out));
      ASSERT_EQ(many.encoder.read(sent.view()), Status::ok);
      ASSERT_TRUE(same_view(sent));
      ASSERT_EQ(many.decoder.read(read.view(), twice), Status::ok);
      ASSERT_EQ(many.decoder.read(read.view(), some), Status::ok);
      ASSERT_EQ(many.decoder.read(read.view()), Status::ok);
      ASSERT_TRUE(same_view(read));
    }
  }
}

}  // namespace
}  // namespace gicodec

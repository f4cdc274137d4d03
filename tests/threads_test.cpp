// Sessions on several threads, with textures large enough that all of them get something to do.
#include "shapes.h"
#include "support.h"

#include "base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
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

/// What an engine may make of it: one after the other, the last first.
Executor backwards(unsigned& calls) {
  const auto run = [](void* self, unsigned count, void (*work)(void*, unsigned) noexcept,
                      void* context) {
    ++*static_cast<unsigned*>(self);
    while (count > 0) work(context, --count);
  };
  return {run, &calls};
}

TEST(Threads, GivenExecutorsRunTheWork) {
  unsigned calls = 0;
  std::vector<unsigned> by_thread(4);
  for_each_item({4, backwards(calls)}, 100,
                [&](unsigned thread, std::size_t) { ++by_thread[thread]; });
  EXPECT_EQ(calls, 1U);
  EXPECT_EQ(by_thread, (std::vector<unsigned>{0, 0, 0, 100}));

  const TextureDesc desc = probe_texture(Format::R16G16_SFLOAT, {12, 12, 20}, 6, 1);
  Texture texture(desc), out(desc);
  Random random(3);
  texture.fill(Fill::noise, random);
  auto encoder =
      *Encoder::create(desc, {.settings = {.chunk = 64, .threads = {4, backwards(calls)}}});
  auto decoder = *Decoder::create(desc, {.threads = {4, backwards(calls)}});
  calls = 0;
  const auto packet = encoder.encode(std::as_const(texture).view());
  ASSERT_EQ(packet.status(), Status::ok);
  EXPECT_GT(std::exchange(calls, 0), 0U);
  ASSERT_EQ(decoder.decode(*packet, out.view()), Status::ok);
  EXPECT_GT(calls, 0U);
  EXPECT_TRUE(same(out.view().bytes, texture.view().bytes));
}

TEST(Threads, ExecutorsThatDoNothingLeaveTheWorkToTheCaller) {
  const Executor none{[](void*, unsigned, void (*)(void*, unsigned) noexcept, void*) {}};
  unsigned done = 0;
  for_each_item({4, none}, 100, [&](unsigned thread, std::size_t) { done += thread == 0; });
  EXPECT_EQ(done, 100U);
}

TEST(Threads, OwnThreadsServeManyCallersAndNestedWork) {
  std::atomic<unsigned> done{0};
  std::vector<std::thread> callers;
  for (int caller = 0; caller < 6; ++caller) {
    callers.emplace_back([&] {
      for (int round = 0; round < 50; ++round) {
        for_each_item(3, 5, [&](unsigned, std::size_t) {
          for_each_item(4, 7, [&](unsigned, std::size_t) { ++done; });
        });
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(done, 6U * 50 * 5 * 7);
}

/// Each place is given to one thread at a time, and all of them are, if they have time for it.
TEST(Threads, PlacesAreOfOneThreadAtATime) {
  std::vector<std::atomic<int>> busy(5);
  std::vector<std::thread::id> seen(1000);
  for_each_item(5, seen.size(), [&](unsigned thread, std::size_t item) {
    EXPECT_EQ(busy[thread].fetch_add(1), 0);
    seen[item] = std::this_thread::get_id();
    if (item < 50) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    busy[thread].fetch_sub(1);
  });
  std::sort(seen.begin(), seen.end());
  const auto threads = std::unique(seen.begin(), seen.end()) - seen.begin();
  EXPECT_GT(threads, 1);
  EXPECT_LE(threads, 5);
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
void change_one_in(Texture& texture, Bytes& presence, std::uint32_t one_in, Random& random) {
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
      change_one_in(texture, presence, one_in, random);
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

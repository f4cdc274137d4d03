// A job that is cancelled ends early and says so; the pool can be used again.
#include "ddgi/parallel.h"

#include <gtest/gtest.h>

#include <atomic>

namespace gicodec::ddgi {
namespace {

TEST(ThreadPool, ACancelledJobEndsEarly) {
  constexpr std::size_t kItems = 100000, kEnough = 10;
  for (const unsigned threads : {1U, 3U}) {
    std::atomic<std::size_t> done{0};
    std::atomic<bool> cancelled{false};
    ThreadPool pool(threads, [&] { return cancelled.load(); });
    const auto body = [&](std::size_t) {
      if (++done == kEnough) cancelled = true;
    };
    EXPECT_THROW(pool.run(kItems, body), Cancelled);
    EXPECT_GE(done, kEnough);
    EXPECT_LT(done, kEnough + threads);
    EXPECT_THROW(pool.run(1, body), Cancelled);

    cancelled = false;
    done = kEnough;
    pool.run(kItems, body);
    EXPECT_EQ(done, kEnough + kItems);
  }
}

}  // namespace
}  // namespace gicodec::ddgi

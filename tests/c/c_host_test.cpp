// Memory, threads and instruction sets that callers of the C interface give to a handle.
#include "c_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <new>
#include <thread>

namespace gicodec {
namespace {

using namespace test;

/// Counts what it gives, and fails on demand.
struct CArena {
  std::mutex mutex;
  std::map<void*, std::align_val_t> given;
  std::size_t most = SIZE_MAX, calls = 0;

  static void* allocate(void* self, std::size_t bytes, std::size_t alignment) {
    CArena& arena = *static_cast<CArena*>(self);
    const std::lock_guard lock(arena.mutex);
    if (arena.calls >= arena.most) return nullptr;
    ++arena.calls;
    const auto aligned = static_cast<std::align_val_t>(std::max(alignment, sizeof(void*)));
    void* const memory = ::operator new(bytes, aligned, std::nothrow);
    if (memory != nullptr) arena.given.emplace(memory, aligned);
    return memory;
  }
  static void release(void* self, void* memory, std::size_t) {
    CArena& arena = *static_cast<CArena*>(self);
    const std::lock_guard lock(arena.mutex);
    const auto found = arena.given.find(memory);
    ASSERT_NE(found, arena.given.end());
    ::operator delete(memory, found->second);
    arena.given.erase(found);
  }
  [[nodiscard]] gicodec_host host() {
    auto out = sized<gicodec_host>();
    out.allocate = allocate;
    out.release = release;
    out.memory = this;
    return out;
  }
};

TEST(CHost, EachHandleHasItsOwnMemory) {
  const auto desc = irradiance(16, 8, 4);
  CTexture ours(desc), theirs(desc);
  CArena first, second;
  auto host_of_encoder = first.host(), host_of_decoder = second.host();
  host_of_encoder.threads = host_of_decoder.threads = 3;
  auto encoding = sized<gicodec_encoder_options>();
  encoding.host = &host_of_encoder;
  auto decoding = sized<gicodec_decoder_options>();
  decoding.host = &host_of_decoder;
  {
    const auto encoder =
        made<OwnedEncoder>([&](auto out) { return gicodec_encoder_create(&desc, &encoding, out); });
    const auto decoder =
        made<OwnedDecoder>([&](auto out) { return gicodec_decoder_create(&desc, &decoding, out); });
    ASSERT_TRUE(encoder && decoder);
    for (unsigned frame = 0; frame < 2; ++frame) {
      ours.paint(frame);
      const auto from = ours.const_view();
      const auto to = theirs.view();
      std::vector<std::uint8_t> packet(gicodec_encoder_bound(encoder.get(), SIZE_MAX));
      std::size_t size = 0;
      ASSERT_EQ(gicodec_encoder_encode(encoder.get(), &from, GICODEC_SELECT_ALL, nullptr, 0,
                                       packet.data(), packet.size(), &size),
                GICODEC_OK);
      ASSERT_EQ(gicodec_decoder_decode(decoder.get(), packet.data(), size, &to), GICODEC_OK);
    }
    EXPECT_EQ(theirs.bytes, ours.bytes);
    EXPECT_GT(first.given.size(), 3U);
    EXPECT_GT(second.given.size(), 3U);
  }
  EXPECT_TRUE(first.given.empty());
  EXPECT_TRUE(second.given.empty());
}

TEST(CHost, MemoryThatEndsIsAStatus) {
  const auto desc = irradiance();
  CTexture ours(desc);
  ours.paint(0);
  const auto view = ours.const_view();
  std::size_t refused = 0;
  for (std::size_t most = 0;; ++most) {
    CArena arena;
    arena.most = most;
    const auto host = arena.host();
    auto options = sized<gicodec_encoder_options>();
    options.host = &host;
    gicodec_encoder* encoder = nullptr;
    gicodec_status status = gicodec_encoder_create(&desc, &options, &encoder);
    std::vector<std::uint8_t> packet(1U << 20);
    std::size_t size = 0;
    if (status == GICODEC_OK) {
      status = gicodec_encoder_encode(encoder, &view, GICODEC_SELECT_ALL, nullptr, 0, packet.data(),
                                      packet.size(), &size);
    }
    gicodec_encoder_destroy(encoder);
    EXPECT_TRUE(arena.given.empty());
    if (status == GICODEC_OK) break;
    ASSERT_EQ(status, GICODEC_OUT_OF_MEMORY);
    ++refused;
  }
  EXPECT_GT(refused, 3U);
}

/// Runs work on threads of its own, and counts it.
struct CExecutor {
  unsigned runs = 0;
  static void run(void* self, std::uint32_t count, void (*work)(void*, unsigned), void* context) {
    ++static_cast<CExecutor*>(self)->runs;
    std::vector<std::thread> threads;
    for (std::uint32_t i = 0; i < count; ++i) threads.emplace_back(work, context, i);
    for (std::thread& thread : threads) thread.join();
  }
};

TEST(CHost, ThreadsAreTheExecutors) {
  const auto desc = irradiance(16, 8, 16);
  CTexture ours(desc);
  ours.paint(0);
  const auto view = ours.const_view();
  std::vector<std::uint8_t> packets[2];
  for (const unsigned threads : {1U, 4U}) {
    CExecutor executor;
    auto host = sized<gicodec_host>();
    host.threads = threads;
    host.run = CExecutor::run;
    host.executor = &executor;
    auto options = sized<gicodec_encoder_options>();
    options.host = &host;
    const auto encoder =
        made<OwnedEncoder>([&](auto out) { return gicodec_encoder_create(&desc, &options, out); });
    auto& packet = packets[threads == 4];
    packet.resize(gicodec_encoder_bound(encoder.get(), SIZE_MAX));
    std::size_t size = 0;
    ASSERT_EQ(gicodec_encoder_encode(encoder.get(), &view, GICODEC_SELECT_ALL, nullptr, 0,
                                     packet.data(), packet.size(), &size),
              GICODEC_OK);
    packet.resize(size);
    EXPECT_EQ(executor.runs > 0, threads == 4);
  }
  EXPECT_EQ(packets[0], packets[1]);
}

}  // namespace
}  // namespace gicodec

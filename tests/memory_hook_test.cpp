// Buffers come from the program's allocator, all of them, and go back to it.
#include "allocation_counter.h"
#include "shapes.h"

#include <gicodec/memory.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace gicodec {
namespace {

using namespace test;

/// Remembers what it gave, and fails on demand.
class Arena {
 public:
  [[nodiscard]] MemoryHook hook() { return {allocate, release, this}; }
  [[nodiscard]] std::size_t held() const { return held_; }
  [[nodiscard]] std::size_t pieces() const { return given_.size(); }
  std::size_t most = SIZE_MAX;  ///< bytes that it has

 private:
  static void* allocate(void* self, std::size_t bytes, std::size_t alignment) {
    Arena& arena = *static_cast<Arena*>(self);
    const std::lock_guard lock(arena.mutex_);
    if (bytes > arena.most - arena.held_) return nullptr;
    // Not std::aligned_alloc(), which ThreadSanitizer hides from heap_bytes().
    void* const whole = std::malloc(bytes + alignment);
    if (whole == nullptr) return nullptr;
    void* memory = whole;
    std::size_t room = bytes + alignment;
    EXPECT_NE(std::align(alignment, bytes, memory, room), nullptr);
    EXPECT_TRUE(arena.given_.emplace(memory, Piece{whole, bytes, alignment}).second);
    arena.held_ += bytes;
    return memory;
  }
  static void release(void* self, void* memory, std::size_t alignment) {
    Arena& arena = *static_cast<Arena*>(self);
    const std::lock_guard lock(arena.mutex_);
    const auto found = arena.given_.find(memory);
    ASSERT_NE(found, arena.given_.end());
    EXPECT_EQ(found->second.alignment, alignment);
    arena.held_ -= found->second.bytes;
    std::free(found->second.whole);
    arena.given_.erase(found);
  }

  struct Piece {
    void* whole;
    std::size_t bytes, alignment;
  };
  std::mutex mutex_;
  std::map<void*, Piece> given_;
  std::size_t held_ = 0;
};

struct HookOfTest {
  explicit HookOfTest(Arena& arena) { EXPECT_EQ(set_memory(arena.hook()), Status::ok); }
  ~HookOfTest() { EXPECT_EQ(set_memory({}), Status::ok); }
};

TEST(MemoryHook, BuffersComeFromIt) {
  const TextureDesc desc = probe_texture(Format::R16G16B16A16_SFLOAT, {20, 12, 12}, 8, 1);
  Random random(5);
  Texture texture(desc), out(desc);
  texture.fill(Fill::noise, random);
  for (const Coding& coding :
       {Coding{"native", 0, true, "fast"}, Coding{"zstd", 3, true}, Coding{"lz4", 1, true}}) {
    Arena arena;
    const HookOfTest hook(arena);
    {
      EncoderOptions options = options_of(coding);
      options.settings.threads = 2;
      auto encoder = *Encoder::create(desc, options);
      auto decoder = *Decoder::create(desc, {.threads = 2});
      Packet packet;
      packet.reserve(encoder.bound(block_count(desc)));
      std::size_t held = arena.held(), all = heap_bytes();
      ASSERT_EQ(encoder.encode_to(std::as_const(texture).view(), Selection::all(), packet),
                Status::ok);
      ASSERT_EQ(decoder.decode(packet, out.view()), Status::ok);
      EXPECT_TRUE(same(out.view().bytes, texture.view().bytes));
      // What is not the arena's: coded bytes on their way into the packet, tables, states.
      const std::size_t records = block_count(desc) * block_bytes(desc);
      EXPECT_GT(arena.held(), 2 * records);
      const std::size_t elsewhere = heap_bytes() - all - (arena.held() - held);
      EXPECT_LT(elsewhere, 3 * packet.capacity() + (std::size_t{1} << 20)) << coding.backend;
      EXPECT_EQ(set_memory({}), Status::out_of_order);  // There are buffers.
    }
    EXPECT_EQ(arena.pieces(), 0U) << coding.backend;
  }
}

TEST(MemoryHook, WhereItHasNothingCallsSaySo) {
  const TextureDesc desc = ddgi_irradiance({8, 4, 8});
  Random random(5);
  Texture texture(desc), out(desc);
  texture.fill(Fill::small, random);
  Arena arena;
  const HookOfTest hook(arena);
  std::size_t refused = 0;
  for (std::size_t most = 1000;; most += most / 4) {
    arena.most = most;
    auto encoder = Encoder::create(desc);
    const auto packet =
        encoder ? encoder->encode(std::as_const(texture).view()) : Result<Packet>(encoder.status());
    auto decoder = Decoder::create(desc);
    Status status = !packet ? packet.status() : decoder.status();
    if (status == Status::ok) status = decoder->decode(*packet, out.view());
    if (status == Status::ok) break;
    ASSERT_EQ(status, Status::out_of_memory);
    ++refused;
  }
  EXPECT_GT(refused, 10U);
  EXPECT_TRUE(same(out.view().bytes, texture.view().bytes));
}

TEST(MemoryHook, HalfAHookIsRefused) {
  Arena arena;
  MemoryHook half = arena.hook();
  half.release = nullptr;
  EXPECT_EQ(set_memory(half), Status::invalid_argument);
  half = arena.hook();
  half.allocate = nullptr;
  EXPECT_EQ(set_memory(half), Status::invalid_argument);
  EXPECT_EQ(set_memory({}), Status::ok);
}

}  // namespace
}  // namespace gicodec

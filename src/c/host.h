// What the application gives to a handle: memory, threads, an instruction set.
#pragma once

#include <gicodec/c/base.h>
#include <gicodec/isa.h>
#include <gicodec/memory.h>
#include <gicodec/threads.h>

namespace gicodec::c {

/// Must stay where it is while something was created with it.
class Host {
 public:
  Host() = default;
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// Null: the defaults. invalid_argument, invalid_settings, unsupported_feature.
  Status set(const gicodec_host* given);
  /// Null: the program's.
  [[nodiscard]] const MemoryHook* memory() const noexcept {
    return memory_.allocate == nullptr ? nullptr : &memory_;
  }
  [[nodiscard]] const Threads& threads() const noexcept { return threads_; }
  [[nodiscard]] Isa isa() const noexcept { return isa_; }

 private:
  static void run(void* self, unsigned count, void (*work)(void*, unsigned) noexcept,
                  void* context);

  gicodec_host given_{};
  MemoryHook memory_;
  Threads threads_;
  Isa isa_ = best_isa();
};

}  // namespace gicodec::c

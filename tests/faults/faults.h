// Allocations and thread starts that fail on purpose: the n-th of a call, alone or with all that
// follow it. The file behind it replaces operator new and pthread_create of the whole program.
#pragma once

#include "support.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <utility>

namespace gicodec::test {

/// The fault of one run of a script. A script makes its calls of the library through it.
class Fault {
 public:
  /// In the call with this number, counted from 0, the n-th allocation or thread start fails,
  /// counted from 1; if `lasting`, all later ones of that call fail, too.
  Fault(std::size_t call, std::size_t nth, bool lasting) noexcept
      : call_(call), nth_(nth), lasting_(lasting) {}

  template <typename Call>
  auto operator()(Call&& call) {
    if (over_ || calls_++ != call_) return call();
    arm(nth_, lasting_);
    auto result = call();
    failed_ = disarm();
    return result;
  }
  /// From here on nothing fails.
  void end() noexcept { over_ = true; }
  [[nodiscard]] std::size_t calls() const noexcept { return calls_; }
  [[nodiscard]] bool failed() const noexcept { return failed_; }

 private:
  static void arm(std::size_t nth, bool lasting) noexcept;
  static bool disarm() noexcept;  ///< true if something failed

  std::size_t call_, nth_, calls_ = 0;
  bool lasting_, failed_ = false, over_ = false;
};

/// Runs script(fault) with every fault that there is, or with one_case_in() of those of a call.
/// Returns about how many there are.
template <typename Script>
std::size_t with_every_fault(Script&& script) {
  Fault none(SIZE_MAX, 1, false);
  script(none);
  const std::size_t step = one_case_in();
  std::size_t faults = 0;
  for (const bool lasting : {false, true}) {
    for (std::size_t call = 0; call < none.calls(); ++call) {
      for (std::size_t nth = 1 + call % step;; nth += step) {
        Fault fault(call, nth, lasting);
        script(fault);
        if (testing::Test::HasFailure()) {
          ADD_FAILURE() << "call " << call << ", allocation " << nth << (lasting ? " and on" : "");
          return faults * step;
        }
        if (!fault.failed()) break;
        ++faults;
      }
    }
  }
  return faults * step;
}

}  // namespace gicodec::test

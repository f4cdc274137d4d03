// Allowance: limits how often each address may do something, by a burst and a rate per second. Its
// memory is bounded.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace gicodec::streaming {

class Allowance {
 public:
  Allowance(double burst, double per_second) : burst_(burst), per_second_(per_second) {}

  /// True if the address has some left.
  [[nodiscard]] bool has(const std::string& host, double now) const;
  /// Uses one, even if none is left.
  void take(const std::string& host, double now);

 private:
  struct Left {
    double count = 0, at = 0;
  };
  [[nodiscard]] double left(const Left& left, double now) const;

  double burst_, per_second_;
  std::map<std::string, Left> hosts_;  ///< addresses that have less than the burst
};

}  // namespace gicodec::streaming

// How often somebody may do something: so many times at once, and so many more a second. Counted
// for each address, in bounded room.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace gicodec::streaming {

class Allowance {
 public:
  Allowance(double burst, double per_second) : burst_(burst), per_second_(per_second) {}

  /// True if nothing is used up.
  [[nodiscard]] bool has(const std::string& host, double now) const;
  /// Uses up one, whether there is one or not.
  void take(const std::string& host, double now);

 private:
  struct Left {
    double count = 0, at = 0;
  };
  [[nodiscard]] double left(const Left& left, double now) const;

  double burst_, per_second_;
  std::map<std::string, Left> hosts_;  ///< those who have less than the burst
};

}  // namespace gicodec::streaming

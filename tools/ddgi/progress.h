// Progress on a terminal.
#pragma once

#include "ddgi_volume.h"

#include <cstddef>

namespace gicodec::ddgi {

/// "frame 12 of 64, 2.3 Mrays/s, 41 s left" on standard error; silent where that is no terminal.
class TraceProgress {
 public:
  TraceProgress(std::size_t total, bool quiet);
  ~TraceProgress();
  TraceProgress(const TraceProgress&) = delete;
  TraceProgress& operator=(const TraceProgress&) = delete;

  /// An update of which no rays are told shows no speed.
  void step(const UpdateStatistics& update);

 private:
  std::size_t total_, done_ = 0;
  bool shown_;
  double rays_ = 0, seconds_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace gicodec::ddgi

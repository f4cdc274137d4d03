#include "progress.h"

#include "dump/text.h"

#include <unistd.h>

#include <fmt/core.h>

#include <cstdio>
#include <string>

namespace gicodec::ddgi {

TraceProgress::TraceProgress(std::size_t total, bool quiet)
    : total_(total), shown_(!quiet && isatty(STDERR_FILENO) != 0) {}

TraceProgress::~TraceProgress() {
  if (shown_ && done_ > 0) tools::print(stderr, "\r\033[K");
}

void TraceProgress::step(const UpdateStatistics& update) {
  ++done_;
  rays_ += static_cast<double>(update.probe_rays + update.shadow_rays);
  seconds_ += update.seconds;
  if (!shown_) return;
  const double elapsed =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double left = elapsed / static_cast<double>(done_) * static_cast<double>(total_ - done_);
  const std::string speed =
      rays_ > 0 ? fmt::format("{:.2f} Mrays/s, ", rays_ / seconds_ * 1e-6) : "";
  tools::print(stderr, "\r\033[Kframe {} of {}, {}{:.0f} s left", done_, total_, speed, left);
  std::fflush(stderr);
}

}  // namespace gicodec::ddgi

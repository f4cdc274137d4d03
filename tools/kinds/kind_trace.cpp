#include "kind_trace.h"

#include "ddgi/program.h"
#include "ddgi/progress.h"

#include <fmt/core.h>

#include <optional>

namespace gicodec::kinds {
namespace {

template <typename Work>
auto unless_cancelled(const Work& work) {
  try {
    return work();
  } catch (const ddgi::Cancelled&) {
    ddgi::check_interrupt();
    throw;
  }
}

void print_remarks(const std::vector<std::string>& remarks, bool quiet) {
  if (quiet) return;
  for (const std::string& remark : remarks) tools::print(stderr, "gi-trace: {}\n", remark);
}

void print_sums(const KindTrace& trace, const SourceContainer& container, double seconds) {
  std::uint64_t all = 0;
  std::string textures;
  for (const SourceContainer::Sum& sum : container.sums()) {
    all += sum.bytes;
    textures += fmt::format("{}{} {:.1f} kB", textures.empty() ? "" : ", ", sum.texture,
                            static_cast<double>(sum.bytes) * 1e-3);
  }
  tools::print(stderr, "gi-trace: {}: {} frame{} of {}, {:.1f} kB ({}); {:.3f} s per frame\n",
               trace.output, trace.frames, trace.frames == 1 ? "" : "s", trace.kind.name,
               static_cast<double>(all) * 1e-3, textures, seconds / trace.frames);
}

}  // namespace

tools::Exit write_trace(const KindTrace& trace) {
  const Source source = unless_cancelled(
      [&] { return trace_kind(trace.kind, trace.flags, trace.scene, trace.seed, trace.threads); });
  print_remarks(source.remarks, trace.quiet);
  SourceContainer container(trace.output, source, trace.times, trace.backend);
  std::optional<ddgi::TraceProgress> progress(std::in_place, trace.frames, trace.quiet);
  double seconds = 0;
  std::uint32_t frame = 0;
  try {
    for (; frame < trace.frames; ++frame) {
      ddgi::check_interrupt();
      const SourceFrame contents = unless_cancelled([&] {
        return source.next({trace.times.at(frame), {}});
      });
      print_remarks(contents.remarks, trace.quiet);
      container.add(frame, contents);
      seconds += contents.seconds;
      progress->step({});
    }
    container.finish();
  } catch (const ddgi::Interrupted&) {
    if (frame > 0) container.finish();
    progress.reset();
    tools::print(stderr, "gi-trace: {}: interrupted; {}\n", trace.output,
                 frame == 0 ? "no frame was finished"
                            : fmt::format("it holds {} of {} frames", frame, trace.frames));
    throw;
  } catch (const tools::Error& problem) {
    const std::string left = frame > 0 ? container.leave() : "";
    if (left.empty()) throw;
    tools::fail(problem.code(), "{}; {} holds {} of {} frames, for --allow-incomplete",
                problem.what(), left, frame, trace.frames);
  }
  progress.reset();
  if (!trace.quiet) print_sums(trace, container, seconds);
  return tools::Exit::ok;
}

}  // namespace gicodec::kinds

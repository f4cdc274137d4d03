#include "kind_trace.h"

#include "ddgi/program.h"
#include "ddgi/progress.h"

#include <fmt/core.h>

#include <optional>
#include <utility>

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

void print_sums(const KindTrace& trace, const SourceContainer& container,
                const ddgi::UpdateStatistics& work) {
  std::uint64_t all = 0;
  std::string textures;
  for (const SourceContainer::Sum& sum : container.sums()) {
    all += sum.bytes;
    textures += fmt::format("{}{} {:.1f} kB", textures.empty() ? "" : ", ", sum.texture,
                            static_cast<double>(sum.bytes) * 1e-3);
  }
  const std::string speed =
      work.probe_rays == 0 ? ""
                           : fmt::format(", {:.2f} Mrays/s", static_cast<double>(work.probe_rays) /
                                                                 work.seconds * 1e-6);
  tools::print(stderr, "gi-trace: {}: {} frame{} of {}, {:.1f} kB ({}); {:.3f} s per frame{}\n",
               trace.output, trace.frames, trace.frames == 1 ? "" : "s", trace.flags.kind,
               static_cast<double>(all) * 1e-3, textures, work.seconds / trace.frames, speed);
}

}  // namespace

tools::Exit write_trace(KindTrace trace) {
  const Source source = unless_cancelled([&] {
    return trace_kind(trace.flags, std::move(trace.scene), trace.label, trace.seed, trace.threads);
  });
  print_remarks(source.remarks, trace.quiet);
  SourceContainer container(trace.output, source, trace.times, trace.backend);
  std::optional<ddgi::TraceProgress> progress(std::in_place, trace.frames, trace.quiet);
  ddgi::UpdateStatistics sum;
  std::uint32_t frame = 0;
  try {
    for (; frame < trace.frames; ++frame) {
      ddgi::check_interrupt();
      const SourceFrame contents = unless_cancelled([&] {
        return source.next({trace.times.at(frame), {}});
      });
      print_remarks(contents.remarks, trace.quiet);
      container.add(frame, contents);
      const ddgi::UpdateStatistics update{.probe_rays = contents.rays, .seconds = contents.seconds};
      progress->step(update);
      sum.probe_rays += update.probe_rays;
      sum.seconds += update.seconds;
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
  if (!trace.quiet) print_sums(trace, container, sum);
  return tools::Exit::ok;
}

}  // namespace gicodec::kinds

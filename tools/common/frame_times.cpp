#include "frame_times.h"

#include <fmt/core.h>

#include <charconv>

namespace gicodec::tools {
namespace {

constexpr const char* kStart = "start";
constexpr const char* kFps = "fps";

std::optional<double> number(const Metadata& metadata, const char* name, double least) {
  const std::string* text = find_metadata(metadata, name);
  if (text == nullptr) return std::nullopt;
  double value = 0;
  const char* const end = text->data() + text->size();
  const auto parsed = std::from_chars(text->data(), end, value);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == end;
  return whole && value >= least && value <= 1e9 ? std::optional(value) : std::nullopt;
}

}  // namespace

void add_times(Metadata& metadata, const FrameTimes& times) {
  metadata.emplace_back(kStart, fmt::format("{}", times.start));
  metadata.emplace_back(kFps, fmt::format("{}", times.fps));
}

std::optional<FrameTimes> times_of(const ContainerDescription& description) {
  const auto start = number(description.metadata, kStart, 0);
  const auto fps = number(description.metadata, kFps, 1e-3);
  if (!start || !fps) return std::nullopt;
  return FrameTimes{*start, *fps};
}

}  // namespace gicodec::tools

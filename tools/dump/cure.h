// What a user can do about a fault of files or flags, in words: each advice once.
#pragma once

#include <fmt/core.h>

#include <string>
#include <string_view>

namespace gicodec::tools {

enum class Cure {
  // A command or a flag of ours.
  keep_values,
  read_as_format,
  describe_raw,
  fix_format,
  check_format,
  cut_rest,
  map_channels,
  pick_channels,
  more_bits,
  leave_format_out,
  grid_or_block,
  give_flag,
  fix_columns,
  fix_layout,
  leave_layout_out,
  decode_first,
  name_dumps,
  gaps,
  stills,
  frames_from,
  play_gaps,
  one_folder,
  fewer_files,
  name_others,
  one_kind,
  fewer_textures,
  fewer_frames,
  crop,
  raw_files,
  other_files,
  as_floats,
  other_folder,
  one_frame,
  more_memory,
  incomplete,
  one_volume,
  other_volume,
  overwrite,
  name_container,
  rename,
  name_it,
  // A program of others, or another file.
  transcode,
  flatten,
  erase_attribute,
  one_level,
  write_zip,
  write_plain,
  split_array,
  fetch_lfs,
  get_again,
  encode_again,
};
inline constexpr auto kLastOwnCure = Cure::name_it;

/// The text of the table, in which {} stand for the arguments.
[[nodiscard]] std::string_view cure_text(Cure cure) noexcept;
template <typename... Args>
[[nodiscard]] std::string to_cure(Cure cure, const Args&... args) {
  return fmt::vformat(cure_text(cure), fmt::make_format_args(args...));
}

}  // namespace gicodec::tools

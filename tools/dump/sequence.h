// Sequences of dumps by file name: NAME.FFFF.EXT is frame FFFF of texture NAME, as are
// NAME_FFFF.EXT, NAME-FFFF.EXT and NAMEFFFF.EXT, unless their numbers are none of frames.
#pragma once

#include "dump/cure.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

struct FrameFile {
  std::uint64_t frame = 0;  ///< the file's number less Sequence::base
  std::string path;
};

/// What names of files add to the name of their texture.
struct FileNames {
  unsigned digits = 0;          ///< least digits of the number; 0: one file without a number
  std::string extension = {};   ///< without the dot
  std::string separator = ".";  ///< between name and number: ".", "_", "-" or empty
  std::int64_t base = 0;        ///< the number of frame 0, not above 0; of all textures the same
  bool counts_sign = false;     ///< digits count the sign of a negative number, as of printf()

  /// "color.0003.exr" of "color" and 3, "color.exr" for digits 0.
  [[nodiscard]] std::string of(const std::string& name, std::uint64_t frame) const;
  [[nodiscard]] bool operator==(const FileNames&) const = default;
};

/// All frames of one texture.
struct Sequence {
  std::string name;  ///< without number and extension
  FileNames names = {};
  std::vector<FrameFile> frames = {};  ///< ascending by frame

  [[nodiscard]] const FrameFile* find(std::uint64_t frame) const noexcept;
  [[nodiscard]] std::string file_name(std::uint64_t frame) const { return names.of(name, frame); }
};

/// What a user is told of files.
struct SequenceRemarks {
  std::vector<std::string> left_out;  ///< by folders, a line each
  std::vector<std::string> guesses;   ///< what numbers were taken for, a line each
};

/// How numbers in names of files are read.
struct NumberOptions {
  bool allow_gaps = false;  ///< missing frames are no error
  Cure cure = Cure::gaps;   ///< of missing ones
  bool stills = false;      ///< no number is a frame's, but those at patterns
  /// Numbers at their # are frames': "irr_#", "*.#.exr".
  std::vector<std::string> patterns = {};
  /// Names that are known, as those of a container: their files are read as these are.
  std::vector<Sequence> known = {};
};

/// Groups files by texture, in order of first appearance. A directory stands for its .exr, .dds,
/// .ktx2, .raw and .bin files, at most 10,000. A number behind a point is always a frame's, one
/// behind another separator or none if it has three digits (none: four) or several files differ
/// only in it, and they are one run of files of one shape; else it belongs to the name. Stills are
/// of the first frame that numbers give. `remarks`: may be null. Errors: a texture with two
/// separators; the same frame twice; numbers of different width; unless `allow_gaps`, a missing
/// frame that another numbered texture has or that lies between two frames, with `cure` as a hint.
[[nodiscard]] std::vector<Sequence> group_sequences(const std::vector<std::string>& paths,
                                                    const NumberOptions& options = {},
                                                    SequenceRemarks* remarks = nullptr);
/// "dumps/color" of "dumps/color.0003.exr".
[[nodiscard]] std::string texture_path(const std::string& path);
[[nodiscard]] bool is_separator(const std::string& text) noexcept;
/// A question to the user, with a hint, if textures of one frame each differ only in a number that
/// may be a frame's; else empty.
[[nodiscard]] std::string question_of(const std::vector<Sequence>& sequences);
/// All frame numbers, ascending.
[[nodiscard]] std::vector<std::uint64_t> all_frames(const std::vector<Sequence>& sequences);

}  // namespace gicodec::tools

// Sequences of dumps by file name: NAME.FFFF.EXT is frame FFFF of texture NAME, as are
// NAME_FFFF.EXT, NAME-FFFF.EXT and NAMEFFFF.EXT.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

struct FrameFile {
  std::uint64_t frame = 0;
  std::string path;
};

/// All frames of one texture.
struct Sequence {
  std::string name;               ///< without number and extension
  unsigned digits = 0;            ///< least digits of the number; 0: one file without a number
  std::string extension;          ///< without the dot
  std::string separator = ".";    ///< between name and number: ".", "_", "-" or empty
  std::vector<FrameFile> frames;  ///< ascending by frame

  [[nodiscard]] const FrameFile* find(std::uint64_t frame) const noexcept;
};

/// Groups files by texture, in order of first appearance. A directory stands for its .exr, .dds,
/// .ktx2, .raw and .bin files. A number behind a point is always a frame's. Behind another
/// separator or none it is a frame's if it has three digits (none: four), or if several files
/// differ only in it; else it belongs to the name.
/// Errors: a texture with two separators; the same frame twice; numbers of different width; unless
/// `allow_gaps`, a missing frame that another numbered texture has or that lies between two frames,
/// with `cure` as a hint.
[[nodiscard]] std::vector<Sequence> group_sequences(const std::vector<std::string>& paths,
                                                    bool allow_gaps = false,
                                                    const char* cure = "--allow-gaps accepts that");
/// "color.0003.exr"; "color.exr" for digits 0.
[[nodiscard]] std::string frame_file_name(const std::string& name, unsigned digits,
                                          std::uint64_t frame, const std::string& extension,
                                          const std::string& separator = ".");
/// "dumps/color" of "dumps/color.0003.exr".
[[nodiscard]] std::string texture_path(const std::string& path);
[[nodiscard]] bool is_separator(const std::string& text) noexcept;
/// A question to the user, with a hint, if textures of one frame each differ only in a number that
/// may be a frame's; else empty.
[[nodiscard]] std::string question_of(const std::vector<Sequence>& sequences);
/// All frame numbers, ascending.
[[nodiscard]] std::vector<std::uint64_t> all_frames(const std::vector<Sequence>& sequences);

}  // namespace gicodec::tools

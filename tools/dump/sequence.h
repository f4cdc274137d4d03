// Sequences of dumps by their file names: NAME.FFFF.EXT is frame FFFF of texture NAME; so are
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
  unsigned digits = 0;            ///< least digits of the number; 0: a single file without a number
  std::string extension;          ///< without the dot
  std::string separator = ".";    ///< between name and number: ".", "_", "-" or nothing
  std::vector<FrameFile> frames;  ///< ascending by frame

  [[nodiscard]] const FrameFile* find(std::uint64_t frame) const noexcept;
};

/// Groups files by texture, in order of first appearance. A directory stands for the .exr, .dds,
/// .ktx2, .raw and .bin files in it. A number behind a point is always a frame's. Behind another
/// separator or none it is one from three digits on (none: four), and a shorter one where several
/// files differ in nothing else; else it belongs to the name. Errors: a texture with two
/// separators, the same frame twice, numbers of mixed width; unless `allow_gaps`, a frame that
/// another texture has, or that lies between two frames; `cure` tells what to do about that.
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
/// Textures of one frame each that differ in nothing but a number, so that it may be a frame's: a
/// question to the user, with what to do; empty if there are no such textures.
[[nodiscard]] std::string question_of(const std::vector<Sequence>& sequences);
/// All frame numbers, ascending.
[[nodiscard]] std::vector<std::uint64_t> all_frames(const std::vector<Sequence>& sequences);

}  // namespace gicodec::tools

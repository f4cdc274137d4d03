// What a container stores of a texture's files, as metadata of its TextureEntry, so that decode
// gives the same files (gicodec(1), "Metadata").
#pragma once

#include "dump/dump.h"
#include "dump/sequence.h"
#include "frame_times.h"
#include "probe_set.h"

#include <gicodec/container.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

/// An attribute of a frame that differs from the first frame's; an empty type: the frame lacks it.
struct FrameAttribute {
  std::uint64_t frame = 0;
  Attribute attribute;
};

/// Attribute of dumps that were decoded with loss; its value is StoredTexture::lossy. Containers
/// made of such dumps keep it.
inline constexpr const char* kLossyAttribute = "gicodec:lossy";

struct StoredTexture {
  std::string name;
  std::string
      file;  ///< its files' name; textures of one file are its images, info.place says which
  FileNames names = {.digits = 4, .extension = "exr"};
  DumpInfo info;                        ///< of the first frame
  std::vector<FrameAttribute> changes;  ///< ascending by frame
  std::optional<FrameTimes> times;      ///< gives gicodec:time of each frame
  ProbeSet inactive;                    ///< probes that were not encoded
  std::string lossy;                    ///< e.g. "qp=20"; empty for lossless
  float largest_error = 0;              ///< TextureEntry::largest_error
  std::string encoder;                  ///< of hevc, e.g. "libx265"; empty for other backends
  std::string dropped;                  ///< what of the files is not kept, in words
  std::string dropped_in;               ///< the first file with some of that; not stored
  std::string unsaid;                   ///< attributes that its kind of file cannot hold
  std::string unlike;                   ///< what files of another kind show otherwise, in words
  std::uint64_t file_bytes = 0;         ///< of all files that it came from; 0: unknown
  bool made_of_files = false;           ///< it has the headers of its files
  std::string no_dump;                  ///< why it cannot become a dump; empty if it can

  /// What decode does not restore, in words; empty if it restores all.
  [[nodiscard]] std::string lacks() const;
  /// A sentence that bits were lost; empty if none were.
  [[nodiscard]] std::string loss() const;

  [[nodiscard]] DumpInfo info_at(std::uint64_t frame) const;
  /// info_at() of a decoded dump, with kLossyAttribute if bits were lost.
  [[nodiscard]] DumpInfo decoded_info(std::uint64_t frame) const;
  [[nodiscard]] std::string file_name(std::uint64_t frame) const;
};

/// True for kinds of files that are only read; decode writes EXR for them.
[[nodiscard]] bool becomes_exr(const Sequence& sequence);
/// Extension of the files that a sequence decodes to: its own, or EXR for images only read.
[[nodiscard]] std::string written_extension(const Sequence& sequence);

/// Reads the headers of all files of a sequence: a texture for each image of a file. Colours are
/// 10-bit codes if nothing says what they are and all of their values are. Throws if a file does
/// not fit the first.
[[nodiscard]] std::vector<StoredTexture> inspect(const Sequence& sequence, Hints hints);
/// True if both are images of the same files.
[[nodiscard]] bool of_one_file(const StoredTexture& a, const StoredTexture& b);

/// True if files can have a texture's name: UTF-8 that a terminal shows unchanged, without
/// directories, not hidden.
[[nodiscard]] bool is_file_name(const std::string& name);

/// Takes what belongs beside a container's description (ContainerWriter::add_metadata()): what is
/// of one frame, and of attributes, inactive probes and losses what has more than `most` bytes.
[[nodiscard]] Metadata take_beside(Metadata& metadata, std::size_t most);
/// The container's entry of a texture with all its metadata; does not set its volume.
[[nodiscard]] TextureEntry to_entry(const StoredTexture& texture);
/// The inverse. An entry without metadata gets frame numbers of four digits, default channels, the
/// attributes of make_info() and no padding. Throws for malformed metadata.
[[nodiscard]] StoredTexture from_entry(const TextureEntry& entry, const std::string& path);

}  // namespace gicodec::tools

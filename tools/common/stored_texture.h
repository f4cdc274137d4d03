// What a container keeps about the files a texture came from, as metadata of its TextureEntry, so
// that decode gives back the same files (gicodec(1), "Metadata").
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

/// An attribute that one frame has otherwise than the first; an empty type means it has none.
struct FrameAttribute {
  std::uint64_t frame = 0;
  Attribute attribute;
};

/// Attribute of decoded dumps that lost bits to coding, with StoredTexture::lossy; containers that
/// are made of them say so, too.
inline constexpr const char* kLossyAttribute = "gicodec:lossy";

struct StoredTexture {
  std::string name;
  unsigned digits = 4;
  std::string extension = "exr";
  std::string separator = ".";
  DumpInfo info;                        ///< of the first frame
  std::vector<FrameAttribute> changes;  ///< ascending by frame
  std::optional<FrameTimes> times;      ///< gives each frame its gicodec:time
  ProbeSet inactive;                    ///< probes that were not encoded
  std::string lossy;                    ///< e.g. "qp=20"; empty for lossless
  float largest_error = 0;              ///< TextureEntry::largest_error
  std::string encoder;                  ///< of hevc, e.g. "libx265"; empty for other backends
  std::string dropped;                  ///< attributes and channels of the files that are not kept
  std::string unsaid;                   ///< attributes that its kind of file cannot have
  std::uint64_t file_bytes = 0;         ///< of all files it came from; 0 if that is not known
  bool made_of_files = false;           ///< it says what the headers of its files were
  std::string no_dump;                  ///< why no dump can be made of it; empty if one can

  /// What decode does not give back, in words; empty if that is nothing.
  [[nodiscard]] std::string lacks() const;
  /// That bits were lost, as a sentence; empty if none were.
  [[nodiscard]] std::string loss() const;

  [[nodiscard]] DumpInfo info_at(std::uint64_t frame) const;
  /// info_at() of a decoded dump: with the mark of what was lost.
  [[nodiscard]] DumpInfo decoded_info(std::uint64_t frame) const;
  [[nodiscard]] std::string file_name(std::uint64_t frame) const;
};

/// Of the files that a sequence comes back as: its own, or EXR for images that are only read.
[[nodiscard]] std::string written_extension(const Sequence& sequence);

/// Reads the headers of all files of a sequence; throws where one does not fit the first.
[[nodiscard]] StoredTexture inspect(const Sequence& sequence, const Hints& hints);

/// Whether files can be named after a texture: UTF-8 that a terminal shows as it is, no directory
/// and nothing hidden.
[[nodiscard]] bool is_file_name(const std::string& name);

/// Of its volume no more than the texture itself is said.
[[nodiscard]] TextureEntry to_entry(const StoredTexture& texture);
/// Entries without such metadata get names of four digits, default channels and the attributes of
/// make_info(), and no padding. Throws for metadata that is not well formed.
[[nodiscard]] StoredTexture from_entry(const TextureEntry& entry, const std::string& path);

}  // namespace gicodec::tools

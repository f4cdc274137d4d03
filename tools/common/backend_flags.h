// The backends of this build, and the flags that choose and tune one.
#pragma once

#include "common/block_box.h"
#include "common/command_line.h"
#include "common/http_source.h"

#include <gicodec/gicodec.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

struct BackendFlags {
  std::string backend = "native";
  int level = 0;
  std::string preset;
  std::uint32_t chunk = 0;
  bool no_difference = false;
  std::uint32_t gop = 30;
  std::string hevc_packing = "paper";
  std::string hevc_layout = "atlas";
  std::string hevc_encoder = "x265";
  std::string lossy;  ///< "qp=N" or empty
  Isa isa = best_isa();
};

void add_backend_flags(Command& command, BackendFlags& flags);

/// True if --lossy is given and applies to the record: colour in 10-bit codes.
[[nodiscard]] bool is_lossy(const BackendFlags& flags, const Record& record);

/// The given flags of level, preset and chunk, for messages: " --level 3 --chunk 8".
[[nodiscard]] std::string given_settings(const BackendSettings& settings);

/// An encoder of one texture. Throws Error of Exit::usage for settings that the backend refuses.
[[nodiscard]] Encoder make_encoder(const BackendFlags& flags, const TextureDesc& desc,
                                   const std::string& texture, std::uint8_t texture_id,
                                   float max_error, unsigned threads);
/// The HEVC encoder that make_encoder() would use; empty for other backends, and if there is none,
/// which make_encoder() reports.
[[nodiscard]] std::string encoder_in_use(const BackendFlags& flags, const TextureDesc& desc,
                                         unsigned threads);
/// Flags for decoding packets.
struct DecoderFlags {
  std::string hevc_decoder = "libde265";
  unsigned threads = 1;
  Isa isa = best_isa();
  std::uint64_t memory = 2048;  ///< MiB for all textures of a container together
  bool memory_flag = false;     ///< the program has --max-memory
  HttpFlags http;               ///< of containers on servers
  std::optional<BlockBox> box;  ///< of volumes that are cut reads the regions that it meets
  bool follow = false;          ///< waits for what is added to a container without its end
};
/// Adds "--max-memory MIB"; help shows `more` after its text.
void add_memory_flag(Command& command, DecoderFlags& flags, const std::string& more = "");
/// Adds "--hevc-decoder libde265|ffmpeg", "--isa", "--threads" and "--max-memory".
void add_decoder_flags(Command& command, DecoderFlags& flags);
/// The HEVC backend of the flags, which loads with its first packet; nullptr if this build has
/// none.
[[nodiscard]] std::unique_ptr<const Backend> hevc_decoder(const DecoderFlags& flags);

/// HEVC that loses bits of 10-bit colour by a quantiser, 0 to 51. Throws Error where this build has
/// none, or it cannot be loaded.
[[nodiscard]] std::unique_ptr<const Backend> lossy_hevc(int quantiser);

/// Loads the module of a backend, if it has one. Throws Error if the module is missing.
void load_backend(std::uint8_t id);

/// Every backend of this build, ascending by id.
[[nodiscard]] std::vector<const Backend*> all_backends();

}  // namespace gicodec::tools

// Flags of gi-client.
#pragma once

#include "client_camera.h"
#include "common/cli.h"
#include "common/token.h"
#include "programs/kind_flags.h"
#include "programs/scene_flags.h"
#include "viewer.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gicodec::streaming {

/// As the command line gives them.
struct ClientFlags {
  std::string connect, output, record, delivery = "unicast", size = "480x270", subscribe,
                                       format = "text", pin;
  kinds::SceneFlags scene;
  CameraFlags camera;
  tools::TokenFlags token;
  ViewerOptions viewer;
  std::uint32_t simulate = 0, samples = 1, window_kb = 1024, max_record_mb = 16384, memory = 4096;
  unsigned threads = 0;
  kinds::DrawingFlags drawing;
  bool expect_proofs = false, overwrite = false, quiet = false;
};

void add_client_flags(tools::Command& app, ClientFlags& flags);

}  // namespace gicodec::streaming

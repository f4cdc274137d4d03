// One client: receives, draws at its own rate, checks proofs.
#pragma once

#include "client_camera.h"
#include "client_link.h"
#include "common/block_box.h"
#include "renderer.h"

#include <gicodec/client.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace gicodec::streaming {

struct ViewerOptions {
  LinkOptions link;
  ClientOptions client;
  std::uint64_t updates = 0;  ///< updates until it leaves; 0: no limit
  double seconds = 0;         ///< seconds until it leaves; 0: no limit
  std::uint32_t frames = 0;   ///< pictures to draw
  double fps = 10;            ///< of the pictures
  float aspect = 16.0F / 9;
  std::optional<SceneId> scene;  ///< that the server must stream
  bool subscribe_all = false;
  std::optional<tools::BlockBox> subscribe;  ///< of the world volume
  bool status = false;                       ///< show a status line on a terminal
};

struct ViewerResult {
  ClientLink::State state{};
  std::string message;
  bool unusable = false;  ///< this client could not use the server's messages
  ClientStatistics statistics;
  std::uint64_t updates = 0;
  std::uint64_t blocks = 0, held = 0;  ///< of all textures, and those received
  unsigned connections = 0, round_trip_ms = 0;
  bool resumed = false;            ///< the session continued after every lost connection
  std::vector<std::string> lossy;  ///< textures with errors, and their bounds
  std::uint32_t frames = 0;
  double seconds = 0;          ///< from the first update to the last
  double connect_seconds = 0;  ///< from the first attempt to connect to a connection
  double first_seconds = 0;    ///< the same to the first update
  double longest_pause = 0;    ///< seconds between two updates
  double all_seconds = 0;      ///< from the first attempt to connect to the end
  double render_seconds = 0;   ///< of all frames
};

/// `renderer` may be nullptr if options.frames is 0. Throws tools::Error.
[[nodiscard]] ViewerResult watch(const ViewerOptions& options, const CameraPath& path,
                                 Renderer* renderer);

}  // namespace gicodec::streaming

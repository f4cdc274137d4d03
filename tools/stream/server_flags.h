// Flags of gi-server.
#pragma once

#include "common/token.h"
#include "programs/kind_flags.h"
#include "programs/scene_flags.h"
#include "service.h"

#include <gicodec/server.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::streaming {

/// As the command line gives them.
struct ServerFlags {
  std::string listen, listen_web, users, play, region, format = "text";
  kinds::SceneFlags scene;
  kinds::KindFlags kind;
  tools::TokenFlags token;
  ServiceOptions service;
  ServerOptions server;
  std::string backend = "native", preset = "auto";
  std::uint32_t color_interval = 1, visibility_interval = 1, view_samples = 1024, view_margin = 1;
  float color_threshold = 0, visibility_threshold = 0;
  std::vector<std::string> max_error;
  std::uint32_t max_clients = 64, max_message_kb = 1024, max_in_flight_mb = 16;
  std::uint32_t max_memory = 2048;
  std::uint32_t per_address = 12, window_kb = 1024;
  double bandwidth_mbps = 0;
  std::optional<double> max_messages;
  unsigned trace_threads = 0;
  bool loop = false, no_culling = false, allow_incomplete = false;
  std::uint32_t client_kbps = 0;
  std::vector<std::string> ask, add_user;
  WebListen web;
  bool web_scene = false;
  std::string metrics_token_file;
  bool insecure_web = false;
  NatsPublisherOptions nats;
  std::uint32_t nats_max_mb = 256;
  bool standby = false;
};

void add_server_flags(tools::Command& app, ServerFlags& flags);

}  // namespace gicodec::streaming

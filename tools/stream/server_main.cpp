// gi-server: streams the light of a scene to clients, of any kind, traced live or played.
#include "clock.h"
#include "common/backend_flags.h"
#include "common/error_flags.h"
#include "common/installed.h"
#include "common/program.h"
#include "ddgi/gltf.h"
#include "ddgi/scene_id.h"
#include "ddgi/scenes.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/text.h"
#include "dump/url.h"
#include "feed_fit.h"
#include "loading.h"
#include "log.h"
#include "publishing.h"
#include "server_flags.h"
#include "service.h"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <set>
#include <sstream>
#include <thread>

namespace {

using namespace gicodec;
using namespace gicodec::streaming;
using tools::Exit;
using tools::fail;

kinds::Feed make_feed(const ServerFlags& o) {
  if (!o.play.empty()) {
    return play_feed(
        o.play, {o.loop, o.service.rate, o.allow_incomplete, o.server.settings.isa, o.max_memory});
  }
  ddgi::Scene scene = kinds::load_scene(o.scene);
  place_volume(o.scene, scene);
  return trace_kind(o.kind, std::move(scene), scene_label(o.scene), 1, o.trace_threads);
}

/// The scene for culling and for clients' SceneId: that of the flags, or the built-in one that a
/// recording names.
std::optional<ddgi::Scene> scene_of(const ServerFlags& o, kinds::Feed& feed) {
  kinds::SceneFlags flags = o.scene;
  if (flags.scene.empty() && flags.gltf.empty()) {
    auto recorded = ddgi::make_scene(feed.scene.name);
    if (recorded) feed.scene = ddgi::scene_id(feed.scene.name, *recorded);
    return recorded;
  }
  const std::string label = ddgi::scene_name(kinds::scene_label(flags));
  if (!feed.scene.name.empty() && feed.scene.name != label)
    fail(Exit::bad_input, "{}: was traced in {}, not in {}", o.play, feed.scene.name, label);
  ddgi::Scene scene = kinds::load_scene(flags);
  if (feed.scene.geometry == 0) feed.scene = ddgi::scene_id(label, scene);
  return scene;
}

/// Limits the memory of a played feed, which may claim large textures in a few bytes.
void check_memory(const ServerFlags& o, const kinds::Feed& feed) {
  // Textures as read, shown and published, and the server's data per block.
  constexpr std::uint64_t kCopies = 3, kBlock = 256;
  std::uint64_t bytes = 0;
  for (const FeedVolume& volume : feed.volumes) {
    for (const NamedTexture* texture : textures_of(volume.desc)) {
      bytes += kCopies * texture_bytes(texture->desc) + kBlock * block_count(texture->desc);
    }
  }
  const std::uint64_t wanted = (bytes >> 20) + 1;
  if (wanted > o.max_memory)
    fail(Exit::bad_input,
         "{}: streaming it takes up to {} MiB, and {} are allowed; --max-memory {} allows it",
         o.play, wanted, o.max_memory, wanted);
}

/// Everything slow to load before there is a server.
struct Loaded {
  kinds::Feed feed;
  std::unique_ptr<Views> views;
  std::string gltf;  ///< the scene for the page, if it is asked for
};

Loaded load(const ServerFlags& o) {
  Loaded loaded{make_feed(o), nullptr, {}};
  const bool culls = std::ranges::any_of(loaded.feed.volumes, kinds::is_culled) && !o.no_culling;
  if (!culls && !loaded.feed.played && !o.web_scene) return loaded;
  auto scene = scene_of(o, loaded.feed);
  if (o.web_scene && !scene)
    fail(Exit::usage, "--web-scene: {} does not name a built-in scene; --scene or --gltf does",
         o.play);
  if (o.web_scene) loaded.gltf = ddgi::gltf_bytes(*scene, o.service.start);
  if (!scene || !culls) return loaded;
  loaded.views = std::make_unique<Views>(*std::move(scene), o.view_samples, o.view_margin);
  return loaded;
}

/// The error bound for a texture of a kind other than probes.
float max_error(const ServerFlags& o, const TextureGroup& group, const NamedTexture& texture) {
  const bool first = &texture == &group.textures.front();
  const bool exact = texture.threshold == Threshold::exact || (first && group.presence == 0);
  if (!exact) return tools::max_error_for(o.max_error, texture.name, texture.desc.record);
  tools::refuse_error_of(o.max_error, texture.name);
  return 0;
}

/// The backends of textures that lose bits by a quantiser; they outlive the server.
using LossyBackends = std::vector<std::unique_ptr<const Backend>>;

/// Streams a texture by HEVC with a loss.
void use_quantiser(const ServerFlags& o, int quantiser, StreamedTexture& texture,
                   LossyBackends& lossy) {
  if (texture.max_error > 0)
    fail(Exit::usage,
         "texture {}: --set qp and --max-error exclude each other; --max-error {}=0 leaves it to "
         "the quantiser",
         texture.texture, texture.texture);
  lossy.push_back(tools::lossy_hevc(quantiser));
  texture.backend = lossy.back().get();
  texture.settings.preset = "veryfast";  // in real time
  texture.settings.isa = o.server.settings.isa;
}

/// The options of all textures; colour and visibility of probes have their own.
std::vector<std::vector<StreamedTexture>> streamed(const ServerFlags& o, const kinds::Feed& feed,
                                                   LossyBackends& lossy) {
  std::vector<std::vector<StreamedTexture>> all;
  std::vector<std::string> names;
  for (const FeedVolume& volume : feed.volumes) {
    auto& textures = all.emplace_back();
    for (const TextureGroup& group : volume.desc.groups) {
      for (const NamedTexture& texture : group.textures) {
        names.push_back(texture.name);
        StreamedTexture& made = textures.emplace_back();
        made.texture = texture.name;
        if (!volume.errors.empty()) made.source_error = volume.errors[textures.size() - 1];
        if (!is_probes(volume)) {
          made.max_error = max_error(o, group, texture);
          const std::size_t place = textures.size() - 1;
          if (!volume.quantisers.empty() && volume.quantisers[place] >= 0)
            use_quantiser(o, volume.quantisers[place], made, lossy);
          continue;
        }
        const bool color = texture.desc.record.count >= 3;
        // Bundled textures, and groups that depend on one another, have one interval.
        const bool apart = !group.bundled && volume.desc.groups.size() == 1;
        made.interval = color || !apart ? o.color_interval : o.visibility_interval;
        made.threshold = color ? o.color_threshold : o.visibility_threshold;
        made.max_error = tools::max_error_for(o.max_error, texture.name, texture.desc.record);
        if (made.threshold > 0 && made.max_error > 0) {
          tools::fail(Exit::usage,
                      "texture {}: --{}-threshold and --max-error exclude each other; --max-error "
                      "{}=0 leaves it to the threshold",
                      texture.name, color ? "color" : "visibility", texture.name);
        }
      }
    }
  }
  tools::check_error_names(o.max_error, names);
  const auto is_exact = [](const StreamedTexture& texture) { return texture.max_error == 0; };
  const bool any_off = std::ranges::any_of(
      all, [&](const auto& textures) { return !std::ranges::all_of(textures, is_exact); });
  if (!o.max_error.empty() && !any_off && !std::ranges::any_of(feed.volumes, is_probes))
    fail(Exit::usage, "--max-error: every bit of what is streamed counts; leave it out");
  return all;
}

/// Reports replace earlier files, so none may be named twice or be an input.
void check_reports(const ServerFlags& o) {
  tools::InputFiles inputs(
      {o.token.file, o.play, o.users, o.web.certificate, o.web.key, o.metrics_token_file});
  std::set<std::string> names;
  for (const std::string* path :
       {&o.service.port_file, &o.service.statistics.file, &o.service.statistics.log}) {
    if (path->empty()) continue;
    check_output(*path, inputs, tools::Existing::replace);
    tools::require_folder(*path);
    if (!names.insert(*path).second)
      fail(Exit::usage, "{}: is named for two reports; name another file", *path);
  }
}

constexpr const char* kExitCodes =
    "Exit codes:\n"
    "  0  all updates were made, or it was interrupted\n"
    "  2  the command line makes no sense\n"
    "  3  a file is damaged, incomplete, of another scene or holds nothing that can be streamed;\n"
    "     the server refused what --ask said\n"
    "  4  a file or standard output cannot be opened, read or written, or an address or socket\n"
    "     cannot be listened to or reached\n"
    "  5  an internal error, or memory ran out";

/// Throws where the server could not listen, before it loads or traces anything.
void check_listening(const ServiceOptions& o) {
  const Net net(o.listen, o.web, o.net);
  if (!o.control.empty()) const Control control(o.control);
}

/// Prints the summary of a server that was interrupted before its first update.
void summarise_nothing(const ServerFlags& o) {
  auto server = tools::take(Server::create(), "server");
  ServerStatistics(o.service.statistics, {}).finish(server, now());
}

/// Reads the addresses to listen at. Refuses those without the protection a user would expect.
void take_addresses(ServerFlags& o) {
  if (o.listen_web.empty()) {
    if (!o.web.certificate.empty() || !o.web.key.empty() || o.insecure_web ||
        !o.metrics_token_file.empty() || !o.web.page.empty() || o.web_scene ||
        !o.web.origins.empty() || o.web.behind_proxy)
      fail(Exit::usage,
           "--certificate, --key, --insecure-web, --web-page, --web-scene, --allow-origin, "
           "--behind-proxy and --metrics-token-file are for --listen-web");
    if (o.listen.empty()) o.listen = "127.0.0.1:0";
  }
  if (!o.listen.empty()) o.service.listen = parse_address(o.listen, "--listen");
  if (o.listen_web.empty()) return;
  o.web.address = parse_address(o.listen_web, "--listen-web");
  o.web.address.via = o.insecure_web ? Via::plain_web : Via::web;
  if (o.web.certificate.empty() != o.web.key.empty())
    fail(Exit::usage, "--certificate and --key belong together; name both");
  if (o.insecure_web && !o.web.certificate.empty())
    fail(Exit::usage,
         "--insecure-web is for a server without a certificate; leave one of them out");
  if (o.insecure_web && !tools::is_loopback(o.web.address.host))
    fail(Exit::usage,
         "--insecure-web: {} can be reached from other machines, and nothing would be encrypted; "
         "use --certificate and --key, or listen on 127.0.0.1 or [::1]",
         o.web.address.host);
  if (!o.insecure_web && o.web.certificate.empty())
    fail(Exit::usage,
         "--listen-web needs --certificate and --key; on 127.0.0.1 or [::1], --insecure-web does "
         "without");
  if (!o.metrics_token_file.empty())
    o.web.metrics_token = tools::read_token({"", o.metrics_token_file}).text;
  if (o.web.page.empty()) o.web.page = tools::installed_folder("web");
  if (o.web.page == "none") o.web.page.clear();
  if (o.web.page.empty() && o.web_scene)
    fail(Exit::usage, "--web-scene is for a page, and there is none; --web-page names its folder");
  o.service.web = o.web;
}

Exit run(ServerFlags& o) {
  if (!o.add_user.empty()) {
    tools::print("{}\n", add_user(o.add_user[1], o.add_user[0]));
    if (std::fflush(stdout) != 0)
      fail(
          Exit::io,
          "standard output cannot be written: {}; nobody saw the token: remove the line of {} from "
          "{}, and add the user again",
          std::strerror(errno), o.add_user[0], o.add_user[1]);
    return Exit::ok;
  }
  if (!o.ask.empty()) {
    std::istringstream lines(ask(o.ask[0], o.ask[1]));
    for (std::string line; std::getline(lines, line);) tools::print("{}\n", line);
    return Exit::ok;
  }
  if (o.play.empty() && o.scene.scene.empty() && o.scene.gltf.empty())
    fail(Exit::usage,
         "what to stream is needed: --scene or --gltf to trace, or --play FILE; see --help");
  if (o.service.wait > o.max_clients)
    fail(Exit::usage,
         "--wait {} is for more clients than --max-clients {} lets in; change one of them",
         o.service.wait, o.max_clients);
  take_addresses(o);
  if (o.preset != "auto") o.server.settings.preset = o.preset;
  o.service.statistics.json = o.format == "json";
  o.service.statistics.quiet = o.service.quiet;
  check_reports(o);
  const tools::Token token = tools::read_token(o.token);
  if (!token.remark.empty() && !o.service.quiet) log_line("gi-server: {}", token.remark);
  if (!o.users.empty() && !token.text.empty())
    fail(Exit::usage, "--users and a token for all exclude each other; name one of them");
  const auto access = std::make_shared<Access>(token.text, o.users);
  o.server.access.authorise = [access](ConnectionId connection, std::string_view said) {
    return access->judge(connection, said, now());
  };
  // Connections without a Hello take no places of sessions.
  constexpr std::uint32_t kWaiting = 48;
  o.server.limits.max_waiting = kWaiting;
  o.server.interval = 1 / o.service.rate;
  o.server.limits.max_connections = o.max_clients + kWaiting + 16;
  o.server.limits.max_message_bytes = std::uint64_t{o.max_message_kb} << 10;
  o.server.limits.max_in_flight_bytes = std::uint64_t{o.max_in_flight_mb} << 20;
  o.server.limits.max_bytes_per_second = std::uint64_t{o.client_kbps} * 125;
  o.server.backend = o.backend;
  const auto region = o.region.empty() ? std::optional(Grid{}) : tools::grid_from_string(o.region);
  if (!region || std::max({region->x, region->y, region->z}) > kMaxGridSide)
    fail(Exit::usage, "--region: expected a grid such as 4x4x4, of sides to {}, not \"{}\"",
         kMaxGridSide, o.region);
  o.server.region = *region;
  o.server.limits.max_clients = o.max_clients;
  // More than the server's limit, so that it can answer further clients that it is full.
  o.service.net.links = std::min<std::size_t>(4095, o.server.limits.max_connections + 16);
  o.service.net.links_per_address = o.per_address;
  o.service.net.max_received = static_cast<std::size_t>(o.server.limits.max_message_bytes) + 1;
  o.service.net.max_unsent = static_cast<std::size_t>(o.server.limits.max_in_flight_bytes);
  o.service.net.open_timeout = o.server.timeouts.hello;
  o.service.net.window = o.window_kb << 10;
  o.server.limits.max_total_bytes_per_second =
      static_cast<std::uint64_t>(o.bandwidth_mbps * 125000);

  check_listening(o.service);
  auto loaded = unless_interrupted([&o] { return load(o); });
  if (!loaded) {
    summarise_nothing(o);
    end_now(Exit::ok);
  }
  auto& [feed, views, gltf] = *loaded;
  if (o.service.web) o.service.web->scene = std::move(gltf);
  if (!o.play.empty()) check_memory(o, feed);
  o.server.scene = feed.scene;
  LossyBackends lossy;
  const auto textures = streamed(o, feed, lossy);
  for (const FeedVolume& volume : feed.volumes) check_backend(o, volume);
  // Per update an Acknowledge and a Viewpoint, and some more.
  o.server.limits.messages_per_second =
      o.max_messages.value_or(std::max(200.0, 100 + 2 * o.service.rate));
  auto nats = begin_publishing(o, feed);
  if (tools::interrupted()) {
    summarise_nothing(o);
    return Exit::ok;
  }
  auto server = tools::take(Server::create(o.server), "backend " + o.backend);
  Service service(o.service, std::move(server), access, feed, std::move(views), textures,
                  std::move(nats));
  service.run();
  return Exit::ok;
}

}  // namespace

int main(int argc, char** argv) {
  tools::Command app{"Streams the light of a scene to gi-client and others, losslessly.",
                     "gi-server"};
  ServerFlags options;
  options.server.limits.max_unicast_per_origin =
      6;  // Four addresses leave some of --max-unicast to others.
  options.server.threads = std::max(1U, std::thread::hardware_concurrency());
  add_server_flags(app, options);
  app.footer(fmt::format(
      "Over ENet nothing is encrypted and clients cannot verify the server: across networks\n"
      "that are not trusted, use --listen-web.\n\n{}{}\n\n"
      "Examples:\n"
      "  gi-server --scene villa --grid 8x4x8 --listen 127.0.0.1:4600\n"
      "  gi-server --play villa.gic --loop --listen 0.0.0.0:4600 --token-file secret\n"
      "  gi-server --add-user ada users\n"
      "  gi-server --play villa.gic --loop --listen-web [::]:8443 --certificate chain.pem --key "
      "key.pem "
      "--users users\n"
      "  gi-server --ask /run/gi-server/control list\n"
      "  gi-server --scene tomb --fine 8x4x8 --fine-spacing 0.5 --stats json\n"
      "  gi-server --scene tomb --kind photons --listen 127.0.0.1:4600\n",
      kinds::settings_help(), kExitCodes));
  return tools::run_program(app, argc, argv, [&] {
    constexpr std::array kOfProbes{"--grid",
                                   "--bounds",
                                   "--color-interval",
                                   "--visibility-interval",
                                   "--color-threshold",
                                   "--visibility-threshold",
                                   "--view-margin"};
    constexpr std::array kOfCulled{"--view-samples", "--no-culling"};
    constexpr std::array kOfTracing{"--kind", "--set", "--grid", "--bounds"};
    if (!options.play.empty()) kinds::refuse_flags_of_tracing(app, options.kind, kOfTracing);
    for (const char* const flag : {"--loop", "--allow-incomplete"}) {
      if (options.play.empty() && app.given(flag)) fail(Exit::usage, "{} is for --play", flag);
    }
    kinds::refuse_flags_of_probes(app, options.kind, kOfProbes);
    // Clients do not wait for a warm-up that nobody sees.
    auto& warmup = options.kind.own.at("warmup");
    if (warmup.empty()) warmup = {"0"};
    kinds::refuse_flags_of_culled(app, options.kind, kOfCulled);
    return run(options);
  });
}

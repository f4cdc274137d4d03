// gi-client: receives the light probes that gi-server streams, draws with them, checks them.
#include "client_recording.h"
#include "client_summary.h"
#include "common/cli.h"
#include "common/program.h"
#include "ddgi/scene_id.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/text.h"
#include "loading.h"
#include "log.h"
#include "programs/kind_flags.h"
#include "simulate.h"
#include "tls.h"
#include "token.h"
#include "viewer.h"

#include <fmt/core.h>
#include <unistd.h>

#include <charconv>
#include <limits>

namespace {

using namespace gicodec;
using namespace gicodec::streaming;
using tools::Exit;
using tools::fail;

constexpr int kMax = std::numeric_limits<int>::max();

struct Options {
  std::string connect, output, record, delivery = "own", size = "480x270", subscribe,
                                       format = "text", pin;
  kinds::SceneFlags scene;
  CameraFlags camera;
  TokenFlags token;
  ViewerOptions viewer;
  std::uint32_t simulate = 0, samples = 1, window_kb = 1024, max_record_mb = 16384, memory = 4096;
  unsigned threads = 0;
  kinds::DrawingFlags drawing;
  bool expect_proofs = false, overwrite = false, quiet = false;
};

void add_flags(tools::Command& app, Options& o) {
  app.add_option("--connect", o.connect,
                 "The server: over ENet, over WebSockets and TLS with wss:// in front, or in clear "
                 "on this machine with ws://")
      ->type_name("[wss://]ADDR:PORT")
      ->required();
  app.add_option("--ca", o.viewer.link.net.trust.ca,
                 "wss://: PEM file of authorities that may vouch for the server; default: the "
                 "system's")
      ->type_name("FILE");
  app.add_option("--pin", o.pin,
                 "wss://: trust the server with this certificate, by its SHA-256, and no other")
      ->type_name("sha256:HEX");
  add_token_flags(app, o.token);
  app.add_option("--delivery", o.delivery,
                 "own: packets made for this client; shared: packets of regions, made for all")
      ->allow(tools::one_of({"own", "shared"}))
      ->show_default();
  app.add_option("--budget-blocks", o.viewer.client.budget.blocks,
                 "Blocks (probes) per update, at most; 0: no limit")
      ->allow(tools::in_range(0, kMax));
  app.add_option("--budget-bytes", o.viewer.client.budget.bytes,
                 "Bytes per update, at most; 0: no limit")
      ->allow(tools::in_range(0, kMax));
  app.add_option("--max-memory", o.memory,
                 "MiB that decoding may take, and drawing; a server may ask "
                 "for much")
      ->allow(tools::in_range(1, 1 << 24))
      ->show_default()
      ->type_name("MIB");
  app.add_option("--subscribe", o.subscribe,
                 "all, or the probes of a box in the grid, whatever is looked at")
      ->type_name("all|X0-X1,Y0-Y1,Z0-Z1");
  app.add_option("--updates", o.viewer.updates, "Leave after N updates; 0: do not")
      ->allow(tools::in_range(0, kMax))
      ->type_name("N");
  app.add_option("--seconds", o.viewer.seconds, "Leave after so long; 0: do not")
      ->allow(tools::in_range(0.0, 1e9));
  app.add_option("--patience", o.viewer.link.patience,
                 "Seconds without a connection after which it gives up")
      ->allow(tools::in_range(0.1, 1e6))
      ->show_default();
  app.add_option("--timeout", o.viewer.link.net.timeout,
                 "Seconds after which a connection counts as lost")
      ->allow(tools::in_range(0.1, 1000.0))
      ->show_default();
  app.add_option("--record", o.record,
                 "Write what is received to a container, as it came; where the server's volumes "
                 "change, or a session begins anew, it goes on in FILE.2.gic and so on")
      ->type_name("FILE.gic");
  app.add_option("--max-record-mb", o.max_record_mb,
                 "--record: MiB of all its files, after which the recording ends and the client "
                 "goes on; 0: no limit")
      ->allow(tools::in_range(0, 1 << 30))
      ->show_default();
  tools::add_isa(app, o.viewer.client.isa);
  app.add_option("--threads", o.threads, "Threads to draw with; default: one per processor")
      ->allow(tools::in_range(1, 256));

  const std::string pictures = "Pictures";
  kinds::add_scene_flags(app, o.scene);
  app.remove_option(app.get_option("--grid"));
  app.remove_option(app.get_option("--bounds"));
  add_camera_flags(app, o.camera);
  for (const char* flag : {"--scene", "--gltf", "--camera", "--orbit"})
    app.get_option(flag)->group(pictures);
  app.add_option("-o,--output", o.output,
                 "Folder for the pictures: with a scene what the camera sees, else the textures")
      ->type_name("DIR")
      ->group(pictures);
  app.add_flag("--overwrite", o.overwrite, "Replace pictures and recordings that are there already")
      ->group(pictures);
  app.add_option("--frames", o.viewer.frames, "Pictures to draw")->group(pictures);
  app.add_option("--fps", o.viewer.fps, "Pictures per second")
      ->allow(tools::in_range(0.01, 1000.0))
      ->show_default()
      ->group(pictures);
  app.add_option("--size", o.size, "Size of the pictures")
      ->type_name("WxH")
      ->show_default()
      ->group(pictures);
  app.add_option("--samples", o.samples, "Rays per pixel in each direction")
      ->allow(tools::in_range(1, 16))
      ->show_default()
      ->group(pictures);
  kinds::add_drawing_flag(app, o.drawing);
  app.get_option("--set")->group(pictures);

  const std::string checks = "Checks and load";
  app.add_flag("--expect-proofs", o.expect_proofs,
               "Exit code 1 unless the server sent hashes of what this client holds, all were "
               "equal and nothing was lost on the way")
      ->group(checks);
  app.add_option("--simulate", o.simulate,
                 "Be N clients, their cameras along the path; no pictures")
      ->allow(tools::in_range(1, 4000))
      ->type_name("N")
      ->group(checks);
  app.add_flag("--discard", o.viewer.client.discard,
               "--simulate: acknowledge updates without decoding them")
      ->group(checks);
  app.add_option("--window-kb", o.window_kb, "Data under way at ENet's level")
      ->allow(tools::in_range(4, 1 << 16))
      ->show_default()
      ->group(checks);
  app.add_option("--stats", o.format, "Summary as text or json")
      ->allow(tools::one_of({"text", "json"}))
      ->show_default();
  app.add_flag("-q,--quiet", o.quiet, "Nothing but errors");
}

std::optional<Box3> parse_box(const std::string& text) {
  if (text.empty() || text == "all") return std::nullopt;
  Box3 box;
  const char* at = text.data();
  const char* const end = at + text.size();
  bool good = true;
  const auto number = [&](std::uint32_t& value, char before) {
    if (before != 0 && (at == end || *at++ != before)) return good = false;
    const auto parsed = std::from_chars(at, end, value);
    at = parsed.ptr;
    return good = good && parsed.ec == std::errc{};
  };
  for (std::size_t axis = 0; good && axis < 3; ++axis) {
    good = number(box.first[axis], axis == 0 ? '\0' : ',') && number(box.last[axis], '-') &&
           box.first[axis] <= box.last[axis];
  }
  if (!good || at != end)
    fail(Exit::usage, "--subscribe: expected all or a box such as 0-7,0-3,4-11, not \"{}\"", text);
  return box;
}

ddgi::RenderOptions render_options(const Options& o) {
  ddgi::RenderOptions r;
  const auto size = tools::grid_from_string(o.size + "x1");
  if (!size || size->x < 1 || size->y < 1 || size->x > 16384 || size->y > 16384) {
    fail(Exit::usage, "--size: expected a size such as 480x270, at most 16384x16384, not \"{}\"",
         o.size);
  }
  r.width = size->x;
  r.height = size->y;
  r.samples = o.samples;
  return r;
}

/// Says what came short of what was asked for; fewer pictures than that are well, none are not.
Exit enough(const Options& o, std::uint64_t updates, std::uint32_t pictures,
            const std::string& why) {
  if (updates < o.viewer.updates) {
    log_line("gi-client: received {} of {}: {}", updates, count(o.viewer.updates, "update"), why);
    return Exit::different;
  }
  if (pictures >= o.viewer.frames) return Exit::ok;
  log_line("gi-client: drew {} of {}: {}", pictures, count(o.viewer.frames, "picture"), why);
  return pictures == 0 ? Exit::different : Exit::ok;
}

[[noreturn]] void fail_unanswered(const Options& o) {
  fail(Exit::io, "{}", no_answer(o.viewer.link.server));
}

/// Of what came.
struct Received {
  std::uint64_t updates = 0, proofs = 0, failed_proofs = 0, lost = 0;
};

Exit judge(const Options& o, const Received& r) {
  if (r.failed_proofs > 0) {
    log_line("gi-client: {} of {} differ from the server's", r.failed_proofs,
             count(r.proofs, "state"));
    return Exit::different;
  }
  if (!o.expect_proofs) return Exit::ok;
  if (r.updates == 0) {
    log_line("gi-client: no update came, and with it no proof{}",
             o.record.empty() ? "" : "; --record had nothing to write");
    return Exit::different;
  }
  if (r.proofs == 0) {
    log_line("gi-client: the server sent no proofs; it does with --proofs");
    return Exit::different;
  }
  if (r.lost > 0) {
    log_line("gi-client: {} missing",
             r.lost == 1 ? "1 message was" : fmt::format("{} messages were", r.lost));
    return Exit::different;
  }
  return Exit::ok;
}

Exit run_load_test(const Options& o, const CameraPath& path) {
  const SimulateOptions options{
      o.viewer.link.server, o.viewer.link.net, o.viewer.client,        o.simulate,
      o.viewer.updates,     o.viewer.seconds,  o.viewer.link.patience, o.viewer.scene};
  const SimulateResult r = simulate(options, path);
  if (r.connected == 0 && r.reason == Reason::left && r.unusable.empty() && !tools::interrupted())
    fail_unanswered(o);
  if (!o.quiet || o.format == "json") summarise(r, o.simulate, o.format == "json");
  if (r.unanswered && r.failed_proofs == 0) fail_unanswered(o);
  const bool served = r.served == o.simulate && r.unusable.empty() &&
                      (r.reason == Reason::left || r.reason == Reason::shutdown);
  if (!served && r.failed_proofs == 0) {
    const std::string why = !r.unusable.empty() ? "; " + r.unusable
                            : r.reason == Reason::left
                                ? ""
                                : fmt::format("; the server says: {}", to_string(r.reason));
    fail(r.unusable.empty() ? Exit::io : Exit::bad_input, "{} of {} {} served{}", r.served,
         count(o.simulate, "client"), o.simulate == 1 ? "was" : "were", why);
  }
  const Exit exit = judge(o, {r.updates, r.proofs, r.failed_proofs, r.lost == 0 ? r.gaps : 0});
  if (exit != Exit::ok) return exit;
  return enough(o, r.fewest_updates, 0,
                tools::interrupted()           ? "interrupted"
                : r.reason == Reason::shutdown ? "the server has ended"
                                               : "the time was over");
}

/// After all else was well.
Exit recorded(const Options& o, const ClientRecording* recording) {
  if (recording == nullptr || recording->exit() != Exit::ok)
    return recording == nullptr ? Exit::ok : recording->exit();
  if (!recording->files().empty()) return Exit::ok;
  log_line("gi-client: {}: is not there, since no update came: --record had nothing to write",
           o.record);
  return Exit::different;
}

Exit run_viewer(Options& o, const CameraPath& path, Renderer* renderer,
                ClientRecording* recording) {
  std::unique_ptr<tools::OutputDirectory> folder;
  if (renderer != nullptr) folder = std::make_unique<tools::OutputDirectory>(o.output);
  o.viewer.client.listener = recording;
  const ViewerResult result = watch(o.viewer, path, renderer);
  if (recording != nullptr) recording->finish();
  const bool failed = result.state == ClientLink::State::failed;
  if (result.connections == 0 && !failed && !tools::interrupted()) fail_unanswered(o);
  const Recorded made = recording == nullptr
                            ? Recorded{}
                            : Recorded{recording->files(), recording->left(), recording->bytes()};
  if (!o.quiet || o.format == "json") summarise(result, made, o.format == "json");
  const std::uint64_t lost = result.connections == 1 ? result.statistics.gaps : 0;
  // Unless there is worse to tell.
  if (failed && result.statistics.failed_proofs == 0)
    fail(result.unusable ? Exit::bad_input : Exit::io, "{}", result.message);
  const Exit exit =
      judge(o, {result.updates, result.statistics.proofs, result.statistics.failed_proofs, lost});
  if (exit != Exit::ok) return exit;
  const bool all_came = o.viewer.updates > 0 && result.updates >= o.viewer.updates;
  if (result.state == ClientLink::State::connecting && !all_came && !tools::interrupted()) {
    fail(Exit::io, "{}: the connection was lost, and no server answered until the time was over",
         o.connect);
  }
  const Exit came = enough(o, result.updates, result.frames,
                           tools::interrupted()                       ? "interrupted"
                           : result.state == ClientLink::State::ended ? result.message
                                                                      : "the time was over");
  return came == Exit::ok ? recorded(o, recording) : came;
}

/// All that takes long before there is a client.
struct Loaded {
  std::unique_ptr<ddgi::Scene> scene;
  std::unique_ptr<Renderer> renderer;
};

Loaded load(const Options& o, const ddgi::RenderOptions& render) {
  Loaded loaded;
  if (!o.scene.scene.empty() || !o.scene.gltf.empty())
    loaded.scene = std::make_unique<ddgi::Scene>(kinds::load_scene(o.scene));
  if (o.viewer.frames > 0)
    loaded.renderer = std::make_unique<Renderer>(
        loaded.scene.get(), render, o.threads,
        PictureFolder(o.output, tools::overwrite_if(o.overwrite),
                      loaded.scene ? tools::InputFiles(loaded.scene->files) : tools::InputFiles()),
        kinds::DrawingFlags{o.memory, o.drawing.set});
  return loaded;
}

Exit run(Options& o) {
  o.viewer.link.server = parse_server(o.connect, "--connect");
  Trust& trust = o.viewer.link.net.trust;
  if (o.viewer.link.server.via != Via::web && (!trust.ca.empty() || !o.pin.empty()))
    fail(Exit::usage, "--ca and --pin are for --connect wss://...");
  if (!trust.ca.empty() && !o.pin.empty())
    fail(Exit::usage, "--ca and --pin exclude each other: a pin needs no authority");
  if (!o.pin.empty()) trust.pin = parse_pin(o.pin);
  check_trust(trust);
  o.viewer.link.net.window = o.window_kb << 10;
  o.viewer.link.quiet = o.quiet;
  const Token token = read_token(o.token);
  if (!token.remark.empty() && !o.quiet) log_line("gi-client: {}", token.remark);
  o.viewer.client.token = token.text;
  o.viewer.client.delivery = o.delivery == "own" ? Delivery::own : Delivery::shared;
  DecodeLimits& limits = o.viewer.client.limits;
  limits.max_texture_bytes = limits.max_total_bytes = std::uint64_t{o.memory} << 20;
  o.viewer.subscribe = parse_box(o.subscribe);
  o.viewer.status = !o.quiet && isatty(STDERR_FILENO) != 0;
  if (o.viewer.client.discard && o.simulate == 0) fail(Exit::usage, "--discard is for --simulate");
  if (o.simulate > 0 && (o.viewer.frames > 0 || !o.subscribe.empty()))
    fail(Exit::usage, "--simulate draws no pictures and takes no --subscribe");
  if (o.simulate == 0 && (o.viewer.frames > 0) != !o.output.empty())
    fail(Exit::usage, "pictures need both -o DIR and --frames N");
  if (!o.drawing.set.empty() &&
      (o.output.empty() || (o.scene.scene.empty() && o.scene.gltf.empty())))
    fail(Exit::usage, "--set is for pictures of a scene: -o DIR with --scene or --gltf");
  if (o.overwrite && o.output.empty() && o.record.empty())
    fail(Exit::usage, "--overwrite is for -o DIR and --record");
  if (o.simulate > 0 && !o.record.empty())
    fail(Exit::usage, "--simulate takes no --record: one client records");
  tools::InputFiles inputs({o.token.file, trust.ca, o.scene.gltf});
  if (!o.record.empty()) check_recording(o.record, inputs, tools::overwrite_if(o.overwrite));
  const ddgi::RenderOptions render = render_options(o);
  o.viewer.aspect = static_cast<float>(render.width) / static_cast<float>(render.height);

  const auto loaded = unless_interrupted([&] { return load(o, render); });
  if (!loaded) {
    end_now(enough(o, 0, 0, "interrupted"));
  }
  const ddgi::Scene* const scene = loaded->scene.get();
  if (scene != nullptr) o.viewer.scene = ddgi::scene_id(kinds::scene_label(o.scene), *scene);
  const CameraPath path(o.camera, scene);
  // Without a view there is nothing that the server could choose by.
  o.viewer.subscribe_all = o.subscribe == "all" || (o.subscribe.empty() && !path.known());
  if (o.simulate > 0) return run_load_test(o, path);
  std::unique_ptr<ClientRecording> recording;
  if (!o.record.empty()) {
    if (scene != nullptr) {
      for (const std::string& file : scene->files) inputs.add(file);
    }
    check_recording(o.record, inputs, tools::overwrite_if(o.overwrite));
    recording = std::make_unique<ClientRecording>(RecordingOptions{
        o.record, tools::overwrite_if(o.overwrite), std::uint64_t{o.max_record_mb} << 20, o.quiet});
  }
  return run_viewer(o, path, loaded->renderer.get(), recording.get());
}

}  // namespace

int main(int argc, char** argv) {
  tools::Command app{"Receives light probes from gi-server and draws with them.", "gi-client"};
  Options options;
  add_flags(app, options);
  app.footer(
      kinds::drawing_help() +
      "Exit codes: 0 success, 1 a state differs from the server's, or fewer updates, proofs or\n"
      "pictures came than were asked for, 2 wrong usage, 3 textures that cannot be used as asked, "
      "or\n"
      "another scene, 4 the server cannot be reached or turned the client away, or a file cannot "
      "be\n"
      "written, 5 an internal error.\n\n"
      "Examples:\n"
      "  gi-client --connect 127.0.0.1:4600 --scene villa --frames 50 -o pictures\n"
      "  gi-client --connect 127.0.0.1:4600 --updates 100 --expect-proofs\n"
      "  gi-client --connect 127.0.0.1:4600 --seconds 60 --record minute.gic\n"
      "  gi-client --connect wss://probes.example.org:8443 --token-file ada --scene villa\n"
      "  gi-client --connect 127.0.0.1:4600 --scene villa --simulate 50 --discard --seconds 10\n");
  return tools::run_program(app, argc, argv, [&] { return run(options); });
}

// gi-client: receives the light probes that gi-server streams, draws with them, checks them.
#include "client_flags.h"
#include "client_recording.h"
#include "client_summary.h"
#include "common/backend_flags.h"
#include "common/cli.h"
#include "common/program.h"
#include "ddgi/scene_id.h"
#include "dump/directory.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/text.h"
#include "loading.h"
#include "log.h"
#include "nats_flags.h"
#include "nats_tracks.h"
#include "programs/kind_flags.h"
#include "simulate.h"
#include "tls.h"
#include "viewer.h"

#include <fmt/core.h>
#include <unistd.h>

#include <memory>
#include <string>

namespace {

using namespace gicodec;
using namespace gicodec::streaming;
using tools::Exit;
using tools::fail;

/// Reports fewer updates than requested, or no picture; some missing pictures are no failure.
Exit enough(const ClientFlags& o, std::uint64_t updates, std::uint32_t pictures,
            const std::string& why) {
  if (updates < o.viewer.updates) {
    log_line("gi-client: received {} of {}: {}", updates, count(o.viewer.updates, "update"), why);
    return Exit::different;
  }
  if (pictures >= o.viewer.frames) return Exit::ok;
  log_line("gi-client: drew {} of {}: {}", pictures, count(o.viewer.frames, "picture"), why);
  return pictures == 0 ? Exit::different : Exit::ok;
}

[[noreturn]] void fail_unanswered(const ClientFlags& o) {
  fail(Exit::io, "{}", no_answer(o.viewer.link.server));
}

/// What was received, for judge().
struct Received {
  std::uint64_t updates = 0, proofs = 0, failed_proofs = 0, lost = 0;
};

Exit judge(const ClientFlags& o, const Received& r) {
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
    log_line("gi-client: no proofs came; a server with --proofs sends one with each packet");
    return Exit::different;
  }
  if (r.lost > 0) {
    log_line("gi-client: {} missing",
             r.lost == 1 ? "1 message was" : fmt::format("{} messages were", r.lost));
    return Exit::different;
  }
  return Exit::ok;
}

Exit run_load_test(const ClientFlags& o, const CameraPath& path) {
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
                                : "; the server says: " + reason_and_cure(r.reason);
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

/// The exit code of the recording, if all else succeeded. `recording`: null if it did not begin.
Exit recorded(const ClientFlags& o, const ClientRecording* recording) {
  if (o.record.empty()) return Exit::ok;
  if (recording != nullptr && recording->exit() != Exit::ok) return recording->exit();
  if (recording != nullptr && !recording->files().empty()) return Exit::ok;
  log_line("gi-client: {}: is not there, since no update came: --record had nothing to write",
           o.record);
  return Exit::different;
}

Exit run_viewer(ClientFlags& o, const CameraPath& path, Renderer* renderer,
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
  // A failed proof is worse and comes first.
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
  const bool ended = result.state == ClientLink::State::ended;
  if (result.updates == 0 && o.viewer.updates == 0 && o.record.empty() && !ended &&
      !tools::interrupted()) {
    log_line("gi-client: no update came until the time was over");
    return Exit::different;
  }
  const Exit came = enough(o, result.updates, result.frames,
                           tools::interrupted() ? "interrupted"
                           : ended              ? result.message
                                                : "the time was over");
  return came == Exit::ok ? recorded(o, recording) : came;
}

/// Everything slow to load before there is a client.
struct Loaded {
  std::unique_ptr<ddgi::Scene> scene;
  std::unique_ptr<Renderer> renderer;
};

Loaded load(const ClientFlags& o, const ddgi::RenderOptions& render) {
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

/// Reads where the server is, or the servers of NATS.
void take_server(ClientFlags& o) {
  NatsFlags& nats = o.viewer.link.net.nats;
  check_nats_flags(nats);
  if (o.connect.empty() == nats.urls.empty())
    fail(Exit::usage, "{}",
         o.connect.empty()
             ? "--connect ADDR:PORT says where the server is, or --nats URL where NATS is"
             : "--connect and --nats exclude each other; name one of them");
  if (nats.urls.empty()) {
    if (o.viewer.link.net.tracks.reach > 0) fail(Exit::usage, "--reach is for --nats");
    o.viewer.link.server = parse_server(o.connect, "--connect");
    return;
  }
  if (!nats.password_file.empty()) nats.password = tools::read_token({"", nats.password_file}).text;
  const Budget& budget = o.viewer.client.budget;
  if (budget.blocks > 0 || budget.bytes > 0)
    fail(Exit::usage,
         "--budget-blocks and --budget-bytes are for --connect; --reach limits what "
         "comes over NATS");
  if (!o.token.token.empty() || !o.token.file.empty())
    fail(Exit::usage, "a token is for --connect; NATS has --nats-user and --nats-password-file");
  o.connect = nats.urls;
  o.viewer.link.server = {nats.urls, 0, Via::nats};
  o.delivery = "shared";
}

Exit run(ClientFlags& o) {
  take_server(o);
  Trust& trust = o.viewer.link.net.trust;
  if (o.viewer.link.server.via != Via::web && (!trust.ca.empty() || !o.pin.empty()))
    fail(Exit::usage, "--ca and --pin are for --connect wss://...");
  if (!trust.ca.empty() && !o.pin.empty())
    fail(Exit::usage, "--ca and --pin exclude each other: a pin needs no authority");
  if (!o.pin.empty()) trust.pin = parse_pin(o.pin);
  check_trust(trust);
  o.viewer.link.net.window = o.window_kb << 10;
  o.viewer.link.quiet = o.quiet;
  const tools::Token token = tools::read_token(o.token);
  if (!token.remark.empty() && !o.quiet) log_line("gi-client: {}", token.remark);
  o.viewer.client.token = token.text;
  o.viewer.client.delivery = o.delivery == "unicast" ? Delivery::unicast : Delivery::shared;
  const auto hevc = tools::hevc_decoder({});
  if (hevc != nullptr) o.viewer.client.backends = {hevc.get()};
  DecodeLimits& limits = o.viewer.client.limits;
  limits.max_texture_bytes = limits.max_total_bytes = std::uint64_t{o.memory} << 20;
  if (!o.subscribe.empty() && o.subscribe != "all") {
    o.viewer.subscribe = tools::box_from_flag("--subscribe", o.subscribe, "all or ");
    o.viewer.link.net.tracks.subscribed_only = true;
  }
  o.viewer.status = !o.quiet && isatty(STDERR_FILENO) != 0;
  if (o.viewer.client.discard && o.simulate == 0) fail(Exit::usage, "--discard is for --simulate");
  if (o.viewer.client.discard && o.expect_proofs)
    fail(Exit::usage,
         "--discard decodes nothing that --expect-proofs checks; leave out one of them");
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
  const ddgi::RenderOptions render = kinds::picture_options(o.size, o.samples, "480x270");
  o.viewer.aspect = static_cast<float>(render.width) / static_cast<float>(render.height);

  const auto loaded = unless_interrupted([&] { return load(o, render); });
  if (!loaded) {
    Exit exit = judge(o, {});
    if (exit == Exit::ok) exit = enough(o, 0, 0, "interrupted");
    end_now(exit == Exit::ok ? recorded(o, nullptr) : exit);
  }
  const ddgi::Scene* const scene = loaded->scene.get();
  if (scene != nullptr) o.viewer.scene = ddgi::scene_id(kinds::scene_label(o.scene), *scene);
  const CameraPath path(o.camera, scene);
  if (o.viewer.link.net.tracks.reach > 0 && !path.known())
    fail(Exit::usage, "--reach: from where? --camera says it, or --scene has a path");
  if (o.viewer.link.net.tracks.reach > 0 && o.subscribe == "all")
    fail(Exit::usage, "--reach and --subscribe all exclude each other");
  // Without a viewpoint the server cannot choose blocks.
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
  ClientFlags options;
  add_client_flags(app, options);
  app.footer(
      kinds::drawing_help() +
      "Exit codes:\n"
      "  0  success\n"
      "  1  a state differs from the server's, --expect-proofs was not met, fewer than --updates\n"
      "     came, none of the --frames could be drawn, nothing came to --record, or far more was\n"
      "     recorded than came\n"
      "  2  the command line makes no sense\n"
      "  3  the server's textures cannot be used as asked, or it streams another scene\n"
      "  4  the server cannot be reached, is not trusted or turned the client away, or a file\n"
      "     cannot be written\n"
      "  5  an internal error, or memory ran out\n\n"
      "Examples:\n"
      "  gi-client --connect 127.0.0.1:4600 --scene villa --frames 50 -o pictures\n"
      "  gi-client --connect 127.0.0.1:4600 --updates 100 --expect-proofs\n"
      "  gi-client --connect 127.0.0.1:4600 --seconds 60 --record minute.gic\n"
      "  gi-client --connect wss://probes.example.org:8443 --token-file ada --scene villa\n"
      "  gi-client --nats nats://127.0.0.1:4222 --scene villa --reach 10 --frames 50 -o pictures\n"
      "  gi-client --connect 127.0.0.1:4600 --scene villa --simulate 50 --discard --seconds 10\n");
  return tools::run_program(app, argc, argv, [&] { return run(options); });
}

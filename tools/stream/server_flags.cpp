#include "server_flags.h"

#include "common/cli.h"
#include "common/error_flags.h"
#include "nats_flags.h"

#include <limits>

namespace gicodec::streaming {
namespace {

void add_source_flags(tools::Command& app, ServerFlags& o) {
  kinds::add_scene_flags(app, o.scene);
  kinds::add_kind_flags(app, o.kind);
  app.add_option("--play", o.play,
                 "Stream a container or a folder of dumps instead of tracing; the scene, if known, "
                 "is for culling")
      ->type_name("FILE|DIR");
  app.add_flag("--loop", o.loop, "With --play: begin again after the last frame");
  app.add_flag("--allow-incomplete", o.allow_incomplete,
               "With --play: stream the whole frames before what is missing or damaged");
  app.add_option("--start", o.service.start, "Time of the scene at the first update, seconds")
      ->allow(tools::in_range(0.0, 1e6));
  app.add_option("--trace-threads", o.trace_threads, "Default: one per processor")
      ->allow(tools::in_range(1, 256));
}

void add_update_flags(tools::Command& app, ServerFlags& o) {
  const std::string group = "Updates";
  app.add_option("--rate", o.service.rate, "Updates per second")
      ->allow(tools::in_range(0.01, 1000.0))
      ->show_default()
      ->group(group);
  app.add_option("--updates", o.service.updates, "End after N updates; 0: when interrupted")
      ->allow(tools::in_range(0, std::numeric_limits<int>::max()))
      ->type_name("N")
      ->group(group);
  app.add_option("--wait", o.service.wait, "Begin when N clients are there")
      ->allow(tools::in_range(0, 4000))
      ->type_name("N")
      ->group(group);
  app.add_flag("--lockstep", o.service.lockstep,
               "Each update shows the next 1/rate of the scene's time, however long tracing takes; "
               "else slow tracing leaves out what is past")
      ->group(group);
  app.add_option("--color-interval", o.color_interval, "Send colour in every Nth update")
      ->allow(tools::in_range(1, 100000))
      ->group(group);
  app.add_option("--visibility-interval", o.visibility_interval,
                 "Send visibility in every Nth update")
      ->allow(tools::in_range(1, 100000))
      ->group(group);
  app.add_option("--color-threshold", o.color_threshold,
                 "Codes by which colour may be off before it is sent; 0: exact")
      ->allow(tools::in_range(0.0, 1024.0))
      ->group(group);
  app.add_option("--visibility-threshold", o.visibility_threshold,
                 "Relative error of visibility before it is sent; 0: exact")
      ->allow(tools::in_range(0.0, 1.0))
      ->group(group);
  tools::add_error_flag(app, o.max_error, "LOSES BITS: how far clients' texels may be off", group);
  app.add_option("--view-samples", o.view_samples, "Rays per client and update for culling")
      ->allow(tools::in_range(16, 1000000))
      ->show_default()
      ->group(group);
  app.add_option("--view-margin", o.view_margin,
                 "Cells around what is seen whose probes are sent too, so that heads can turn")
      ->allow(tools::in_range(0, 16))
      ->show_default()
      ->group(group);
  app.add_flag("--no-culling", o.no_culling, "Send every client all active probes, all bricks")
      ->group(group);
  app.add_option("--backend", o.backend, "native, zstd, lz4 or raw")
      ->allow(tools::one_of({"native", "zstd", "lz4", "raw"}))
      ->show_default()
      ->group(group);
  app.add_option("--preset", o.preset,
                 "native: turbo, fast or strong; auto: what delivers first to each client, or to "
                 "those of shared packets, while updates are in time")
      ->show_default()
      ->group(group);
  app.add_option("--chunk", o.server.settings.chunk,
                 "native: blocks per chunk at most, 1 to 4096; 0: by the size of the volume")
      ->type_name("N")
      ->allow(tools::in_range(0, 4096))
      ->show_default()
      ->group(group);
  app.add_option("--level", o.server.settings.level, "lz4: -64 to 12; zstd: -64 to 22")
      ->group(group);
  tools::add_isa(app, o.server.settings.isa);
  app.add_option(
         "--region", o.region,
         "Blocks per region of shared packets, at most: smaller ones for slow links, larger "
         "ones for fewer bytes; default: 4x4x4, fewer where they are large")
      ->type_name("NXxNYxNZ")
      ->group(group);
  app.add_option("--threads", o.server.threads.count,
                 "Threads that encode; default: one per processor")
      ->allow(tools::in_range(1, 256))
      ->group(group);
  app.add_flag("--proofs", o.server.proofs, "Send a hash of every client's state, for checking")
      ->group(group);
}

void add_limit_flags(tools::Command& app, ServerFlags& o) {
  const std::string group = "Limits";
  const auto positive = tools::in_range(0.001, 1e9);
  app.add_option("--max-clients", o.max_clients, "Sessions, those without a connection included")
      ->allow(tools::in_range(1, 4000))
      ->show_default()
      ->group(group);
  app.add_option("--max-unicast", o.server.limits.max_unicast, "Sessions with unicast delivery")
      ->allow(tools::in_range(1, 4000))
      ->show_default()
      ->group(group);
  app.add_option("--max-unicast-per-address", o.server.limits.max_unicast_per_origin,
                 "Those of one address; 0: no limit")
      ->allow(tools::in_range(0, 4000))
      ->show_default()
      ->group(group);
  app.add_option("--max-per-address", o.per_address, "Connections from one address")
      ->allow(tools::in_range(1, 4095))
      ->show_default()
      ->group(group);
  app.add_option("--max-message-kb", o.max_message_kb, "Largest message of a client")
      ->allow(tools::in_range(1, 1 << 18))
      ->show_default()
      ->group(group);
  app.add_option(
         "--max-messages", o.max_messages,
         "Messages per second of a client, besides one subscription to everything; default: "
         "200, and more where the rate asks for them")
      ->allow(positive)
      ->group(group);
  app.add_option("--max-in-flight", o.server.limits.max_in_flight,
                 "Updates that wait for acknowledgement")
      ->allow(tools::in_range(1, 100000))
      ->show_default()
      ->group(group);
  app.add_option(
         "--max-memory", o.max_memory,
         "With --play: MiB that streaming may take besides what clients do; a small file may ask "
         "for much")
      ->allow(tools::in_range(1, 1 << 24))
      ->show_default()
      ->type_name("MIB")
      ->group(group);
  app.add_option("--max-in-flight-mb", o.max_in_flight_mb, "The same in MiB")
      ->allow(tools::in_range(1, 1 << 14))
      ->show_default()
      ->group(group);
  app.add_option("--hello-timeout", o.server.timeouts.hello, "Seconds to the first message")
      ->allow(positive)
      ->show_default()
      ->group(group);
  app.add_option("--stall-timeout", o.server.timeouts.stall, "Seconds without an acknowledgement")
      ->allow(positive)
      ->show_default()
      ->group(group);
  app.add_option("--linger", o.server.timeouts.linger, "Seconds that lost sessions can come back")
      ->allow(tools::in_range(0.0, 1e6))
      ->show_default()
      ->group(group);
  app.add_option("--timeout", o.service.net.timeout, "Seconds after which a link counts as lost")
      ->allow(tools::in_range(0.1, 1000.0))
      ->show_default()
      ->group(group);
  app.add_option("--window-kb", o.window_kb, "Data under way per link at ENet's level")
      ->allow(tools::in_range(4, 1 << 16))
      ->show_default()
      ->group(group);
  app.add_option("--max-kbps-per-client", o.client_kbps,
                 "Updates to a client, kilobits per second, whatever it asks for; 0: no limit")
      ->allow(tools::in_range(0, 30000000))
      ->type_name("N")
      ->group(group);
  app.add_option("--bandwidth", o.bandwidth_mbps,
                 "Mbps of updates that all clients share; 0: no limit")
      ->allow(tools::in_range(0.0, 30000.0))
      ->group(group);
}

void add_web_flags(tools::Command& app, ServerFlags& o) {
  const std::string group = "Encrypted";
  app.add_option(
         "--listen-web", o.listen_web,
         "Where to wait for clients over WebSockets and TLS 1.3; [::]:8443 is IPv6 and IPv4")
      ->type_name("ADDR:PORT")
      ->group(group);
  app.add_option("--certificate", o.web.certificate, "PEM file: the server's, then what signed it")
      ->type_name("FILE")
      ->group(group);
  app.add_option("--key", o.web.key, "PEM file of its key")->type_name("FILE")->group(group);
  app.add_flag("--insecure-web", o.insecure_web,
               "Allow --listen-web on this machine's own addresses without a certificate, in clear")
      ->group(group);
  app.add_option("--users", o.users,
                 "File of users, each with a token of its own; --ask PATH reload reads it again")
      ->type_name("FILE")
      ->group(group);
  app.add_option("--add-user", o.add_user,
                 "Add a user to such a file, print the token, which is kept nowhere, and end")
      ->type_name("NAME FILE")
      ->expected(2)
      ->group(group);
  app.add_option("--web-page", o.web.page,
                 "Folder of the page that a browser gets at --listen-web; default: the one that is "
                 "installed, if it is; \"none\": no page")
      ->type_name("FOLDER")
      ->group(group);
  app.add_flag(
         "--web-scene", o.web_scene,
         "The page shows the scene, too, to all who reach the port, whether they know the token "
         "or not")
      ->group(group);
  app.add_option("--allow-origin", o.web.origins,
                 "Lets pages of another origin connect, such as https://example.org; \"*\": all "
                 "pages; may be repeated")
      ->type_name("ORIGIN")
      ->group(group)
      ->expected(1)
      ->take_all();
  app.add_flag(
         "--behind-proxy", o.web.behind_proxy,
         "A proxy on this machine stands in front of --listen-web: limits of an address count "
         "the last one of its X-Forwarded-For")
      ->group(group);
  app.add_option("--metrics-token-file", o.metrics_token_file,
                 "Show /metrics to those who know the first line of this file as a bearer token; "
                 "else to this machine alone")
      ->type_name("FILE")
      ->group(group);
}

void add_track_flags(tools::Command& app, ServerFlags& o) {
  const std::string group = "Over NATS";
  add_nats_flags(app, o.nats.nats,
                 "Publish the light through these servers of NATS with JetStream, too, for any "
                 "number of viewers",
                 group);
  app.add_option("--nats-replicas", o.nats.streams.replicas,
                 "Servers that keep what was published, of a cluster")
      ->allow(tools::in_range(1, 5))
      ->type_name("N")
      ->show_default()
      ->group(group);
  app.add_option("--nats-max-mb", o.nats_max_mb, "MiB of updates that JetStream keeps")
      ->allow(tools::in_range(1, 1 << 20))
      ->type_name("N")
      ->show_default()
      ->group(group);
  app.add_option("--snapshot-seconds", o.service.tracks.snapshot_seconds,
                 "A region that changed gets a snapshot within so many seconds, or eight times as "
                 "many where little changes")
      ->allow(tools::in_range(0.1, 3600.0))
      ->type_name("S")
      ->show_default()
      ->group(group);
  app.add_option(
         "--snapshot-share", o.service.tracks.snapshot_share,
         "Of snapshots in all bytes, at most: more of them, and viewers who come late fetch "
         "less")
      ->allow(tools::in_range(0.01, 0.99))
      ->type_name("X")
      ->show_default()
      ->group(group);
  app.add_flag("--standby", o.standby,
               "Wait until the publisher is gone, then take over where it was")
      ->group(group);
  app.add_option("--standby-after", o.nats.standby_after,
                 "Seconds without an update after which a publisher counts as gone")
      ->allow(tools::in_range(0.1, 3600.0))
      ->type_name("S")
      ->show_default()
      ->group(group);
}

}  // namespace

void add_server_flags(tools::Command& app, ServerFlags& o) {
  app.add_option("--listen", o.listen,
                 "Where to wait for clients over ENet; port 0: any free one. Default: 127.0.0.1:0, "
                 "or nowhere with --listen-web")
      ->type_name("ADDR:PORT");
  app.add_option("--port-file", o.service.port_file,
                 "Write the ports when clients may come: a line for --listen, one for --listen-web")
      ->type_name("FILE");
  app.add_option("--control", o.service.control,
                 "Socket through which --ask lists and drops clients; only this user may open it")
      ->type_name("PATH");
  app.add_option("--ask", o.ask,
                 "Say a command to the server with this --control, and end: list, \"drop CLIENT\", "
                 "reload")
      ->type_name("PATH COMMAND")
      ->expected(2);
  tools::add_token_flags(
      app, o.token, "File whose first line both ends must know; over ENet it is sent in clear");
  add_web_flags(app, o);
  add_track_flags(app, o);
  add_source_flags(app, o);
  add_update_flags(app, o);
  add_limit_flags(app, o);
  app.add_option("--stats", o.format, "text: a table at the end; json: a line each second")
      ->allow(tools::one_of({"text", "json"}))
      ->show_default();
  app.add_option("--stats-file", o.service.statistics.file, "Write the JSON lines to a file")
      ->type_name("FILE");
  app.add_option("--log-updates", o.service.statistics.log,
                 "Write a CSV line for every update of every client")
      ->type_name("FILE");
  app.add_flag("-q,--quiet", o.service.quiet, "Nothing but errors");
}

}  // namespace gicodec::streaming

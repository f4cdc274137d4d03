#include "client_flags.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "nats_flags.h"

#include <charconv>
#include <limits>

namespace gicodec::streaming {

using tools::Exit;
using tools::fail;

static constexpr int kMax = std::numeric_limits<int>::max();

void add_client_flags(tools::Command& app, ClientFlags& o) {
  app.add_option("--connect", o.connect,
                 "The server: over ENet, over WebSockets and TLS with wss:// in front, or in clear "
                 "on this machine with ws://")
      ->type_name("[wss://]ADDR:PORT");
  add_nats_flags(app, o.viewer.link.net.nats,
                 "Instead of --connect: receive what a gi-server with --nats publishes",
                 "Over NATS");
  app.add_option("--reach", o.viewer.link.net.tracks.reach,
                 "With --nats: how far from the camera light is received, in world units, the "
                 "nearest first; 0: all")
      ->allow(tools::in_range(0.0F, 1e9F))
      ->group("Over NATS");
  app.add_option("--ca", o.viewer.link.net.trust.ca,
                 "wss://: PEM file of authorities that may vouch for the server; default: the "
                 "system's")
      ->type_name("FILE");
  app.add_option("--pin", o.pin,
                 "wss://: trust the server with this certificate, by its SHA-256, and no other")
      ->type_name("sha256:HEX");
  tools::add_token_flags(
      app, o.token, "File whose first line both ends must know; over ENet it is sent in clear");
  app.add_option("--delivery", o.delivery,
                 "unicast: packets made for this client; shared: packets of regions, made for all")
      ->allow(tools::one_of({"unicast", "shared"}))
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
  app.add_option(
         "--max-record-mb", o.max_record_mb,
         "With --record: MiB of all its files, after which the recording ends and the client "
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
               "With --simulate: acknowledge updates without decoding them")
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

}  // namespace gicodec::streaming

// Sizes and speeds of all backends and presets side by side, on probe dumps and containers.
//
// Per sequence and texture: bits per record of a keyframe and of updates of the changed probes
// (whole packets), the ratio to the full atlas over the sequence, and, for updates of every probe,
// bytes of records per second of processor time of one thread, encode and decode, and what encoder
// and decoder hold on the heap between two of them, scratch and state included. Then bytes per
// probe and time of updates of a few probes. Per sequence: how long updates of all textures, of
// every probe and of a few, take from end to end, by the clock, with --threads (2), and what
// delivers them first on which links.
#include "cases.h"
#include "delivery.h"
#include "small_updates.h"

#include "common/command_line.h"
#include "dump/error.h"

#include "allocation_counter.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>

namespace gicodec::bench {
namespace {

struct Costs {
  double encode = 1e30, decode = 1e30;               ///< best seconds of one update
  std::size_t encoder_bytes = 0, decoder_bytes = 0;  ///< on the heap
};

/// What the heap has more of once it is gone.
template <typename Session>
std::size_t bytes_of(std::optional<Session>& session) {
  const std::size_t before = test::heap_bytes();
  session.reset();
  return before - test::heap_bytes();
}

/// Frames 1 and 2 in turn on top of frame 0, all probes.
Costs measure_costs(const Texture& t, const Case& c, int rounds) {
  std::optional encoder = make_encoder(t.desc, c);
  std::optional decoder = make_decoder(t.desc, c);
  Costs s;
  Packet packet;
  std::vector<std::byte> out(texture_bytes(t.desc));
  for (int i = 0; i <= rounds; ++i) {
    const auto& frame =
        t.frames[static_cast<std::size_t>(i) % std::min<std::size_t>(t.frames.size(), 3)];
    double start = processor_time();
    if (encoder->encode_to(ConstTextureView(frame), Selection::all(), packet) != Status::ok)
      return {};
    if (i > 0) s.encode = std::min(s.encode, processor_time() - start);
    start = processor_time();
    if (decoder->decode(packet, TextureView{out}) != Status::ok) return {};
    if (i > 0) s.decode = std::min(s.decode, processor_time() - start);
    if (out != frame) return {};
  }
  s.encoder_bytes = bytes_of(encoder);
  s.decoder_bytes = bytes_of(decoder);
  return s;
}

void report(const std::string& path, const Texture& t, const Case& c, int rounds,
            std::ostream& json) {
  if (const std::string why = refusal(t.desc, c); !why.empty()) {
    fmt::print("{:<26} {}\n", c.label, why);
    return;
  }
  auto encoder = make_encoder(t.desc, c);
  auto decoder = make_decoder(t.desc, c);
  std::size_t key = 0, updates = 0, changed = 0;
  for (std::size_t f = 0; f < t.frames.size(); ++f) {
    auto packet = encoder.encode(ConstTextureView(t.frames[f]),
                                 f == 0 ? Selection::all() : Selection::changed());
    if (!packet || decoder.decode(*packet) != Status::ok) {
      fmt::print("{:<26} failed\n", c.label);
      return;
    }
    (f == 0 ? key : updates) += packet->size();
    if (f > 0) changed += decoder.changed().size();
  }
  const double texels = record_count(t.desc.block);
  const double full =
      static_cast<double>(texture_bytes(t.desc)) * static_cast<double>(t.frames.size());
  const double records = static_cast<double>(block_bytes(t.desc)) * block_count(t.desc);
  const Costs s = measure_costs(t, c, rounds);
  const double key_bits = static_cast<double>(key) * 8 / (texels * block_count(t.desc));
  const double update_bits =
      changed == 0 ? 0.0
                   : static_cast<double>(updates) * 8 / (texels * static_cast<double>(changed));
  const double ratio = full / static_cast<double>(key + updates);
  const double encode = records / s.encode / 1e6, decode = records / s.decode / 1e6;
  fmt::print("{:<26} {:8.3f} {:8.3f} {:9.2f} {:9.0f} {:9.0f} {:7.1f} {:7.1f}\n", c.label, key_bits,
             update_bits, ratio, encode, decode, static_cast<double>(s.encoder_bytes) / 1e6,
             static_cast<double>(s.decoder_bytes) / 1e6);
  std::fflush(stdout);
  json << nlohmann::json{{"path", path},
                         {"texture", t.name},
                         {"backend", c.label},
                         {"keyframe_bits", key_bits},
                         {"update_bits", update_bits},
                         {"ratio", ratio},
                         {"encode_mb_s", encode},
                         {"decode_mb_s", decode},
                         {"encoder_bytes", s.encoder_bytes},
                         {"decoder_bytes", s.decoder_bytes}}
       << std::endl;
}

/// All textures of a container whose volumes are not cut into regions.
std::vector<Texture> read_container(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file) throw std::runtime_error(path + ": cannot be opened");
  FileSource source(file.get());
  auto reader = tools::take(ContainerReader::open(source), path);
  std::vector<Texture> textures;
  std::vector<Decoder> decoders;
  for (const TextureEntry& entry : reader.description().textures) {
    Texture& t = textures.emplace_back();
    t.name = entry.name;
    t.desc = entry.desc;
    decoders.push_back(tools::take(Decoder::create(entry.desc), path));
  }
  ContainerPacket packet;
  std::optional<std::uint64_t> frame;
  Status status = Status::ok;
  const auto keep = [&] {
    for (std::size_t i = 0; i < textures.size(); ++i) {
      auto& texels = textures[i].frames.emplace_back(texture_bytes(textures[i].desc));
      tools::check(decoders[i].read(TextureView{texels}), path);
    }
  };
  while ((status = reader.next(packet)) == Status::ok) {
    if (packet.region != 0) throw std::runtime_error(path + ": is cut into regions");
    if (frame && *frame != packet.frame) keep();
    frame = packet.frame;
    tools::check(decoders[packet.texture_id].decode(packet.bytes), path);
  }
  if (status != Status::end) tools::check(status, path);
  if (frame) keep();
  return textures;
}

/// One texel per block of a grid, row after row, is a 3D texture: the same bytes in larger blocks.
void make_bricks(TextureDesc& desc, std::uint8_t side) {
  if (record_count(desc.block) != 1 || desc.guard_band != 0 ||
      desc.layout != Layout(Tiling::atlas_xy_z))
    return;
  const auto bricks = [&](std::uint32_t texels) { return (texels + side - 1) / side; };
  desc.records = desc.grid;
  desc.grid = {bricks(desc.grid.x), bricks(desc.grid.y), bricks(desc.grid.z)};
  desc.block = {side, side, side};
  desc.model = Model::continuous;
  desc.layout = Tiling::slices_xy_z;
  tools::check(validate(desc), "--bricks");
}

int run(int argc, char** argv) {
  bool quick = false;
  int bricks = 1;
  unsigned threads = 2;
  Isa isa = best_isa();
  std::ofstream json;  // Not open: goes nowhere.
  std::vector<std::string> paths;
  tools::Command app{"Sizes and speeds of all backends and presets side by side.",
                     "sizes_and_speeds"};
  app.add_option("dumps", paths, "Folders of dumps, and containers")
      ->type_name("DUMPS|FILE.gic")
      ->required();
  app.add_flag("--quick", quick, "Without hevc's slow presets, which take minutes");
  app.add_option(
         "--isa",
         [&](const std::string& name) {
           const auto named = isa_from_string(name);
           if (!named || !is_supported(*named))
             tools::fail(tools::Exit::usage, "this machine has no {}", name);
           isa = *named;
         },
         "Kernels of the library: scalar, sse4, avx2, avx512 or neon; default: the best here")
      ->type_name("NAME");
  app.add_option("--threads", threads, "For updates from end to end")
      ->allow(tools::in_range(1, 256))
      ->show_default();
  app.add_option("--bricks", bricks,
                 "Textures of one texel per probe, such as spherical harmonics, as a 3D texture in "
                 "bricks of N x N x N texels instead")
      ->allow(tools::in_range(1, 32))
      ->type_name("N");
  app.add_option(
         "--json",
         [&](const std::string& path) {
           json.open(path);
           if (!json) tools::fail(tools::Exit::io, "{}: cannot be written", path);
         },
         "Write all but small updates' rows there, too, an object a line")
      ->type_name("FILE");
  if (const auto exit = app.parse(argc, argv)) return static_cast<int>(*exit);
  for (const std::string& path : paths) {
    auto textures = path.ends_with(".gic") ? read_container(path) : read_dumps(path);
    for (Texture& t : textures) {
      if (bricks > 1) make_bricks(t.desc, static_cast<std::uint8_t>(bricks));
      fmt::print("\n{} {}: {} frames\n{:<26} {:>8} {:>8} {:>9} {:>9} {:>9} {:>7} {:>7}\n", path,
                 t.name, t.frames.size(), "", "key b/t", "upd b/t", "ratio", "enc MB/s", "dec MB/s",
                 "enc MB", "dec MB");
      for (const auto& c : cases(isa)) {
        if (!quick || !c.slow) report(path, t, c, c.slow || c.backend == "hevc" ? 2 : 25, json);
      }
      report_small_updates(t, isa);
    }
    report_delivery(path, textures, quick, isa, threads, json);
  }
  return 0;
}

}  // namespace
}  // namespace gicodec::bench

int main(int argc, char** argv) {
  try {
    return gicodec::bench::run(argc, argv);
  } catch (const gicodec::tools::Error& error) {
    fmt::print(stderr, "sizes_and_speeds: {}\n", error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    fmt::print(stderr, "sizes_and_speeds: {}\n", error.what());
    return 1;
  }
}

#include "backend_flags.h"

#include "cli.h"
#include "dump/error.h"
#include "volume_words.h"

#ifdef GICODEC_WITH_HEVC
#include "hevc_on_demand.h"
#include "modules/hevc.h"
#endif

#include <algorithm>
#include <charconv>

namespace gicodec::tools {
namespace {

constexpr unsigned kMaxThreads = 256;  // the library's limit

#ifdef GICODEC_WITH_HEVC
const Backend& default_hevc() {
  static const HevcOnDemand backend;
  return backend;
}

int lossy_qp(const BackendFlags& flags) {
  int qp = -1;
  const std::string& text = flags.lossy;
  const char* const end = text.data() + text.size();
  if (!text.starts_with("qp=") || std::from_chars(text.data() + 3, end, qp).ptr != end || qp < 0 ||
      qp > 51) {
    fail(Exit::usage, "--lossy does not take \"{}\"; expected qp=N with N from 0 to 51", text);
  }
  return qp;
}
#endif

}  // namespace

void add_backend_flags(Command& command, BackendFlags& flags) {
  std::vector<std::string> names;
  for (const Backend* backend : all_backends()) names.emplace_back(backend->name());
  const std::string group = "Coding";
  command.add_option("--backend", flags.backend, "What codes the records")
      ->allow(one_of(names))
      ->show_default()
      ->group(group);
  command
      .add_option("--level", flags.level,
                  "lz4: 1 to 12; zstd: 1 to 22; both -64 to -1, which are faster; 0: the default")
      ->type_name("N")
      ->group(group);
  command
      .add_option("--preset", flags.preset,
                  "native: turbo, fast or strong; hevc: x265's, ultrafast to placebo")
      ->type_name("NAME")
      ->group(group);
  command
      .add_option("--chunk", flags.chunk,
                  "native: blocks per chunk at most, 1 to 4096; smaller ones use more threads, "
                  "larger ones take fewer bytes; 0: by the size of the volume")
      ->type_name("N")
      ->allow(in_range(0, 4096))
      ->show_default()
      ->group(group);
  command
      .add_flag("--no-difference", flags.no_difference,
                "raw, lz4, zstd: code updates as they are, not their difference to the past")
      ->group(group);
  command.add_option("--gop", flags.gop, "A keyframe every N frames; 0: only the first")
      ->type_name("N")
      ->show_default()
      ->group(group);
  add_isa(command, flags.isa);
#ifdef GICODEC_WITH_HEVC
  command
      .add_option("--hevc-packing", flags.hevc_packing,
                  "paper: 4:4:4 planes as in the paper; planes: decorrelated, smaller; luma: with "
                  "--lossy, smallest")
      ->allow(one_of({"paper", "planes", "luma"}))
      ->show_default()
      ->group(group);
  command
      .add_option("--hevc-layout", flags.hevc_layout,
                  "atlas: every probe in each frame; packed: only the updated ones")
      ->allow(one_of({"atlas", "packed"}))
      ->show_default()
      ->group(group);
  command
      .add_option("--hevc-encoder", flags.hevc_encoder,
                  "x265, or FFmpeg encoders to try in turn, e.g. hevc_nvenc,hevc_vaapi,libx265")
      ->type_name("NAMES")
      ->show_default()
      ->group(group);
  command
      .add_option("--lossy", flags.lossy,
                  "hevc: LOSES BITS of 10-bit colour, quantiser N from 0 to 51; other textures "
                  "stay lossless")
      ->type_name("qp=N")
      ->group(group);
#endif
}

bool is_lossy(const BackendFlags& flags, const Record& record) {
  return !flags.lossy.empty() && (record.format == Format::A2R10G10B10_UNORM_PACK32 ||
                                  record.format == Format::A2B10G10R10_UNORM_PACK32);
}

namespace {

BackendSettings settings_of(const BackendFlags& flags, unsigned threads) {
  BackendSettings settings;
  settings.level = flags.level;
  settings.preset = flags.preset;
  settings.chunk = flags.chunk;
  settings.difference = !flags.no_difference;
  settings.threads = std::min(threads, kMaxThreads);
  settings.isa = flags.isa;
  return settings;
}

#ifdef GICODEC_WITH_HEVC
HevcSettings hevc_settings_of(const BackendFlags& flags, const TextureDesc& desc) {
  HevcSettings settings;
  settings.packing = flags.hevc_packing == "planes" ? HevcPacking::planes : HevcPacking::paper;
  settings.layout = flags.hevc_layout == "packed" ? HevcLayout::packed : HevcLayout::atlas;
  settings.encoder = flags.hevc_encoder;
  if (!flags.lossy.empty()) {
    const int qp = lossy_qp(flags);
    if (is_lossy(flags, desc.record)) {
      settings.lossy_qp = qp;
      if (flags.hevc_packing == "luma") settings.packing = HevcPacking::luma;
    }
  }
  return settings;
}
#endif

/// The values of --level, --preset and --chunk that a backend takes, in words.
const char* allowed_settings(const std::string& backend) {
  if (backend == "native")
    return "--preset turbo, fast or strong, --chunk 1 to 4096, and no --level";
  if (backend == "lz4") return "--level -64 to 12, no --preset and no --chunk";
  if (backend == "zstd") return "--level -64 to 22, no --preset and no --chunk";
  if (backend == "hevc") {
    return "--preset ultrafast, superfast, veryfast, faster, fast, medium, slow, slower, veryslow "
           "or placebo, no --level and no --chunk";
  }
  return "neither --level nor --preset nor --chunk";
}

/// Throws Error of Exit::usage for a flag that the backend does not have.
void check_own_flags(const BackendFlags& flags) {
  const BackendFlags none;
  if (flags.no_difference && (flags.backend == "native" || flags.backend == "hevc"))
    fail(Exit::usage, "--no-difference needs --backend raw, lz4 or zstd");
  if (flags.backend == "hevc") {
    if (!flags.lossy.empty() && flags.hevc_encoder != none.hevc_encoder) {
      fail(Exit::usage, "--lossy needs --hevc-encoder {}, not {}", none.hevc_encoder,
           flags.hevc_encoder);
    }
    if (flags.lossy.empty() && flags.hevc_packing == "luma")
      fail(Exit::usage, "--hevc-packing luma needs --lossy");
    return;
  }
  for (const auto& [flag, given] : {std::pair("--lossy", !flags.lossy.empty()),
                                    {"--hevc-packing", flags.hevc_packing != none.hevc_packing},
                                    {"--hevc-layout", flags.hevc_layout != none.hevc_layout},
                                    {"--hevc-encoder", flags.hevc_encoder != none.hevc_encoder}}) {
    if (given) fail(Exit::usage, "{} needs --backend hevc", flag);
  }
}

}  // namespace

std::string given_settings(const BackendSettings& settings) {
  std::string given;
  if (settings.level != 0) given += fmt::format(" --level {}", settings.level);
  if (!settings.preset.empty()) given += fmt::format(" --preset {}", settings.preset);
  if (settings.chunk != 0) given += fmt::format(" --chunk {}", settings.chunk);
  return given.empty() ? " these settings" : given;
}

Encoder make_encoder(const BackendFlags& flags, const TextureDesc& desc, const std::string& texture,
                     std::uint8_t texture_id, float max_error, unsigned threads) {
  EncoderOptions options;
  options.max_error = max_error;
  options.backend = flags.backend;
  options.settings = settings_of(flags, threads);
  options.gop = flags.gop;
  options.texture_id = texture_id;
  check_own_flags(flags);
#ifdef GICODEC_WITH_HEVC
  if (flags.backend == "hevc") load_backend(kBackendHevc);
  const HevcOnDemand hevc(hevc_settings_of(flags, desc));
  options.backends = {&hevc};
#endif
  auto encoder = Encoder::create(desc, options);
  if (encoder.status() == Status::invalid_settings) {
    fail(Exit::usage, "texture {}: backend {} refuses{}: it takes {}", texture, flags.backend,
         given_settings(options.settings), allowed_settings(flags.backend));
  }
  return take(std::move(encoder), fmt::format("texture {}: backend {}", texture, flags.backend));
}

std::string encoder_in_use([[maybe_unused]] const BackendFlags& flags,
                           [[maybe_unused]] const TextureDesc& desc,
                           [[maybe_unused]] unsigned threads) {
#ifdef GICODEC_WITH_HEVC
  if (flags.backend == "hevc") {
    const auto name = hevc_module().encoder_in_use(hevc_settings_of(flags, desc), desc,
                                                   settings_of(flags, threads));
    if (name.ok()) return *name;
  }
#endif
  return "";
}

void add_memory_flag(Command& command, DecoderFlags& flags, const std::string& more) {
  flags.memory_flag = true;
  command
      .add_option(
          "--max-memory", flags.memory,
          "MiB that decoding a container's textures may take; a small file may ask for much" + more)
      ->allow(in_range(1, 1 << 24))
      ->show_default()
      ->type_name("MIB");
}

void add_decoder_flags(Command& command, DecoderFlags& flags) {
  command
      .add_option("--hevc-decoder", flags.hevc_decoder,
                  "What decodes HEVC packets; default libde265")
      ->allow(one_of({"libde265", "ffmpeg"}));
  add_isa(command, flags.isa);
  add_threads(command, flags.threads);
  add_memory_flag(command, flags);
}

std::unique_ptr<const Backend> hevc_decoder([[maybe_unused]] const DecoderFlags& flags) {
#ifdef GICODEC_WITH_HEVC
  HevcSettings settings;
  settings.decoder = flags.hevc_decoder;
  return std::make_unique<HevcOnDemand>(settings);
#else
  return nullptr;
#endif
}

std::unique_ptr<const Backend> lossy_hevc([[maybe_unused]] int quantiser) {
#ifdef GICODEC_WITH_HEVC
  load_backend(kBackendHevc);
  HevcSettings settings;
  settings.packing = HevcPacking::luma;
  settings.lossy_qp = quantiser;
  return std::make_unique<HevcOnDemand>(settings);
#else
  fail(Exit::usage, "this program is built without HEVC, which loses bits by a quantiser");
#endif
}

void load_backend([[maybe_unused]] std::uint8_t id) {
#ifdef GICODEC_WITH_HEVC
  if (id == kBackendHevc) (void)hevc_module();
#endif
}

std::vector<const Backend*> all_backends() {
  const auto built_in = built_in_backends();
  std::vector<const Backend*> backends(built_in.begin(), built_in.end());
#ifdef GICODEC_WITH_HEVC
  backends.push_back(&default_hevc());
#endif
  std::sort(backends.begin(), backends.end(),
            [](const Backend* left, const Backend* right) { return left->id() < right->id(); });
  return backends;
}

}  // namespace gicodec::tools

// gicodec encode: packs dumps into a container, frame by frame.
#include "encode.h"
#include "common/backend_flags.h"
#include "common/cli.h"
#include "common/container_output.h"
#include "common/error_flags.h"
#include "common/file_names.h"
#include "common/stored_texture.h"
#include "common/volume_words.h"
#include "dump/block_place.h"
#include "dump/cure.h"
#include "dump/dump.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/sequence.h"
#include "encode_volumes.h"
#include "geometry_flags.h"
#include "jobs.h"
#include "region_encoder.h"
#include "texture_roles.h"
#include "world_flags.h"

#include <gicodec/gicodec.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>

namespace gicodec::tools {
namespace {

/// The state of one texture. Reading runs one frame ahead of encoding.
struct Lane {
  const Sequence& files;
  StoredTexture stored;
  RegionEncoder encoder;
  std::size_t next_file = 0;
  std::optional<Dump> current, next;

  void read_next() {
    next.reset();
    if (next_file == files.frames.size()) return;
    const FrameFile& file = files.frames[next_file++];
    next = read_dump(file.path, hints_of(stored.info));
    Attributes expected = stored.info_at(file.frame).attributes;
    if (!stored.info.head) expected.clear();
    if (becomes_exr(files)) describe(next->info.attributes, next->info.desc);
    if (next->info.channels != stored.info.channels || next->info.attributes != expected) {
      fail(Exit::bad_input, "{}: changed while it was being read; {}", file.path,
           to_cure(Cure::encode_again));
    }
    require_nothing_outside(*next, file.path);
  }
  void encode(std::uint64_t frame) {
    check(encoder.encode(current->texels), fmt::format("{}, frame {}", files.name, frame));
  }
};

void set_inactive(Lane& lane, const ProbeSet& inactive, const std::string& path) {
  const std::uint32_t probes = block_count(lane.stored.info.desc);
  if (!inactive.empty() && inactive.last() >= probes) {
    fail(Exit::bad_input, "{}: probe {} is out of range: texture {} has {} probes", path,
         inactive.last(), lane.stored.name, probes);
  }
  std::vector<std::uint8_t> active(probes, 1);
  for (const auto [first, last] : inactive.ranges()) {
    std::fill(active.begin() + first, active.begin() + last + 1, std::uint8_t{0});
  }
  check(lane.encoder.set_active(active), lane.stored.name);
}

std::vector<std::string> listed_names(
    std::span<const std::pair<const Sequence*, StoredTexture>> inputs) {
  std::vector<std::string> names;
  for (const auto& [sequence, stored] : inputs) names.push_back(stored.name);
  return names;
}

/// What flags for all textures mean for each texture.
struct Roles {
  std::vector<bool> states;
  std::vector<float> max_error;
};

Roles roles_of(const EncodeOptions& options,
               std::span<const std::pair<const Sequence*, StoredTexture>> inputs, bool silent) {
  const std::vector<std::string> names = listed_names(inputs);
  std::vector<TextureDesc> descs;
  for (const auto& [sequence, stored] : inputs) descs.push_back(stored.info.desc);
  const auto layout = layout_volume(options.geometry);
  const auto light = are_light(descs, shown_textures(layout.value_or(VolumeDesc{}), descs.size()));
  Roles roles{are_states(descs), max_errors(options.max_error, names, descs, light)};
  const std::string left = left_exact(options.max_error, names, light);
  if (!left.empty() && !silent) remark(left);
  return roles;
}

std::vector<Lane> make_lanes(const EncodeOptions& options, const std::vector<Sequence>& sequences,
                             bool silent) {
  ProbeSet inactive;
  if (!options.inactive.empty()) inactive = read_probe_set(options.inactive);
  bool any_lossy = false;
  std::vector<std::string> fell_back;
  std::vector<Lane> lanes;
  auto inputs = inspect_all(options.geometry, sequences);
  if (inputs.size() > DecodeLimits{}.max_textures) {
    fail(Exit::usage, "{} textures are too many for one container, which holds {}; {}",
         inputs.size(), DecodeLimits{}.max_textures, to_cure(Cure::fewer_textures));
  }
  check_error_names(options.max_error, listed_names(inputs));
  const Roles roles = roles_of(options, inputs, silent);
  const Grid region = region_of(options.region);
  for (auto& [sequence, stored] : inputs) {
    require_size(stored, sequence->frames.front().path);
    const bool leaves_out = !inactive.empty() && !roles.states[lanes.size()];
    if (leaves_out) stored.inactive = inactive;
    if (stored.info.fell_back) fell_back.push_back(stored.name);
    if (!stored.dropped.empty() && !shares_standard_error(options.output)) {
      remark(fmt::format("{}: {} not kept", stored.dropped_in, stored.dropped));
    }
    if (is_lossy(options.backend, stored.info.desc.record)) {
      stored.lossy = options.backend.lossy;
      stored.largest_error = std::numeric_limits<float>::infinity();
      any_lossy = true;
    }
    const float max_error = roles.max_error[lanes.size()];
    if (max_error > 0) {
      if (is_lossy(options.backend, stored.info.desc.record)) {
        fail(
            Exit::usage,
            "--max-error and --lossy exclude each other for texture {}; --max-error {}=0 leaves it "
            "to --lossy",
            stored.name, stored.name);
      }
      stored.largest_error = both_errors(stored.largest_error, max_error);
      if (std::isfinite(stored.largest_error)) {
        stored.lossy = error_text(stored.largest_error);
      } else {
        stored.lossy += ", then " + error_text(max_error);
      }
    }
    stored.encoder = encoder_in_use(options.backend, stored.info.desc, options.threads);
    if (options.backend.hevc_encoder.find(stored.encoder) == std::string::npos && !silent) {
      remark(fmt::format(
          "texture {}: no encoder of --hevc-encoder {} is available; {} is used instead",
          stored.name, options.backend.hevc_encoder, stored.encoder));
    }
    const std::string& name = stored.name;
    RegionEncoder encoder(stored.info.desc, region, [&](const TextureDesc& desc) {
      return make_encoder(options.backend, desc, name, static_cast<std::uint8_t>(lanes.size()),
                          max_error, options.threads);
    });
    lanes.push_back({*sequence, std::move(stored), std::move(encoder), 0, {}, {}});
    if (leaves_out) set_inactive(lanes.back(), inactive, options.inactive);
  }
  if (!fell_back.empty() && !silent) {
    remark(fmt::format(
        "kept as they are, since not all of their values are 10-bit codes, n/1023 or whole "
        "numbers up to 1023: {}",
        listed(std::span(fell_back).first(std::min<std::size_t>(4, fell_back.size())),
               fell_back.size())));
  }
  if (!options.backend.lossy.empty() && !any_lossy) {
    fail(Exit::usage, "--lossy has nothing to do: no texture holds 10-bit colour");
  }
  return lanes;
}

Described describe(const EncodeOptions& options, const std::vector<Lane>& lanes,
                   const std::vector<std::uint64_t>& frames) {
  const std::string& output = options.output;
  Described described;
  ContainerDescription& description = described.description;
  for (const Lane& lane : lanes) {
    // decode would give files of another name.
    if (file_stem(lane.stored) != lane.files.name) {
      fail(Exit::bad_input,
           "{}: the name of texture {} is not UTF-8, has control characters, begins with a dot or "
           "has a % where decode writes an escape; rename its dumps",
           output, lane.stored.name);
    }
    for (const auto& [name, value] : to_entry(lane.stored).metadata) {
      if (!is_utf8(name)) {
        fail(Exit::bad_input,
             "{}: attribute {} of texture {} has a name that is not UTF-8; rename it", output, name,
             lane.stored.name);
      }
    }
  }
  std::vector<const StoredTexture*> textures;
  for (const Lane& lane : lanes) textures.push_back(&lane.stored);
  add_volumes(description, options.geometry, textures, output);
  for (VolumeEntry& volume : description.volumes) volume.region = region_of(options.region);
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    TextureEntry own = to_entry(lanes[i].stored);
    description.textures[i].largest_error = own.largest_error;
    description.textures[i].metadata = std::move(own.metadata);
  }
  description.metadata.emplace_back("creator", fmt::format("gicodec {}", kVersionString));
  if (options.resume) description.metadata.emplace_back(kFlagsKey, options.given);
  describe_world(options.world, options.geometry.layout, frames, description);
  // A container that was cut off can thus name its missing frames.
  description.metadata.emplace_back("frames", fmt::format("{}-{}", frames.front(), frames.back()));
  spread_metadata(described, frames.size(), output);
  return described;
}

void encode_frame(std::vector<Lane>& lanes, std::uint64_t frame, unsigned threads,
                  ContainerOutput& output, std::uint64_t& texel_bytes) {
  std::vector<Lane*> present;
  for (Lane& lane : lanes) {
    if (lane.files.find(frame) != nullptr) present.push_back(&lane);
  }
  std::vector<std::function<void()>> tasks;
  for (Lane* lane : present) {
    lane->current = std::exchange(lane->next, std::nullopt);
    texel_bytes += lane->current->texels.size();
    tasks.emplace_back([lane, frame] { lane->encode(frame); });
  }
  for (Lane* lane : present) tasks.emplace_back([lane] { lane->read_next(); });
  run_all(threads, tasks);
  for (const Lane* lane : present) {
    check_interrupt();
    for (const auto& [region, packet] : lane->encoder.packets()) output.add(frame, packet, region);
  }
}

/// Refuses outputs that would destroy a file, before any work.
void check_container_output(const EncodeOptions& options, const std::vector<Sequence>& sequences) {
  InputFiles inputs;
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) {
      for (const std::string& path : files_of(file.path)) inputs.add(path);
    }
  }
  if (!options.inactive.empty()) inputs.add(options.inactive);
  check_output(options.output, inputs, Existing::container);
}

/// "hevc (libx265)".
std::string text_of_lanes(const std::string& backend, const std::vector<Lane>& lanes) {
  std::set<std::string> encoders;
  for (const Lane& lane : lanes) {
    if (!lane.stored.encoder.empty()) encoders.insert(lane.stored.encoder);
  }
  return encoders.empty() ? backend : fmt::format("{} ({})", backend, fmt::join(encoders, ", "));
}

void remark_inactive(const std::vector<Lane>& lanes) {
  std::uint64_t inactive = 0;
  std::string states;
  for (const Lane& lane : lanes) inactive = std::max(inactive, lane.stored.inactive.size());
  if (inactive == 0) return;
  for (const Lane& lane : lanes) {
    if (!lane.stored.inactive.empty()) continue;
    states += (states.empty() ? "; whole, as states of probes, " : ", ") + lane.stored.name;
  }
  remark(fmt::format("{} inactive probes are not stored; decode writes zeros there{}", inactive,
                     states));
}

}  // namespace

Exit encode(const EncodeOptions& options, const Cli& cli) {
  if (!options.jobs.empty()) {
    if (!options.output.empty() || !options.inputs.empty()) {
      fail(Exit::usage, "--jobs takes outputs and dumps from {}, and prints its plan",
           options.jobs);
    }
    return write_plan(options.jobs, cli);
  }
  if (options.output.empty()) fail(Exit::usage, "-o, --output is missing: the container to write");
  if (options.inputs.empty()) fail(Exit::usage, "no dumps are named to be packed");
  // First, because the shell expands -o *.exr to the first dump as output.
  check_output(options.output, {}, Existing::container);
  if (native_path(options.output).has_extension() && image_kind(options.output)) {
    fail(Exit::usage, "-o {}: is named like a dump; a container is named FILE.gic", options.output);
  }
  for (const std::string& path : options.inputs) require_exists(path);
  if (options.resume &&
      is_finished(options.output, options.given, options.inputs, options.max_error,
                  !options.backend.lossy.empty(), options.threads)) {
    if (!cli.quiet) remark(fmt::format("{}: is finished and verified: kept", options.output));
    return Exit::ok;
  }
  SequenceRemarks remarks;
  const auto sequences = group_sequences(options.inputs, options.geometry.numbers, &remarks);
  check_container_output(options, sequences);
  check_names(options.geometry, sequences);
  const bool silent = cli.quiet || shares_standard_error(options.output);
  for (const std::string& line : remarks.left_out) {
    if (!shares_standard_error(options.output)) remark(line);
  }
  for (const std::string& line : remarks.guesses) {
    if (!silent) remark(line);
  }
  const bool told = options.geometry.numbers.stills || !options.geometry.numbers.patterns.empty();
  if (const auto question = question_of(sequences); !question.empty() && !silent && !told) {
    remark(question);
  }
  if (const auto question = layout_question(options.geometry, sequences);
      !question.empty() && !silent)
    remark(question);
  const auto frames = all_frames(sequences);
  std::vector<Lane> lanes = make_lanes(options, sequences, silent);
  const Described described = describe(options, lanes, frames);
  const ContainerDescription& description = described.description;
  ContainerOutput output(
      options.output, description, Existing::container, described.beside,
      options.resume ? AtomicFile::Temporary::restart : AtomicFile::Temporary::partial);

  std::vector<std::function<void()>> first_reads;
  for (Lane& lane : lanes) first_reads.emplace_back([&lane] { lane.read_next(); });
  run_all(options.threads, first_reads);

  std::uint64_t texel_bytes = 0;
  {
    Progress progress("encoding frame", frames.size(), cli);
    for (const std::uint64_t frame : frames) {
      progress.step();
      encode_frame(lanes, frame, options.threads, output, texel_bytes);
    }
  }
  check_interrupt();
  output.finish();
  if (silent) return Exit::ok;
  const bool lossy = std::any_of(lanes.begin(), lanes.end(),
                                 [](const Lane& lane) { return !lane.stored.lossy.empty(); });
  remark_inactive(lanes);
  remark(fmt::format(
      "{}: {} volume{} of {} texture{}, {} frame{}, {} bytes of textures in {} bytes, {:.2f}:1, "
      "{}{}",
      options.output == "-" ? "standard output" : options.output, description.volumes.size(),
      description.volumes.size() == 1 ? "" : "s", lanes.size(), lanes.size() == 1 ? "" : "s",
      frames.size(), frames.size() == 1 ? "" : "s", texel_bytes, output.bytes(),
      static_cast<double>(texel_bytes) / static_cast<double>(output.bytes()),
      text_of_lanes(options.backend.backend, lanes), lossy ? ", LOSSY" : ", lossless"));
  return Exit::ok;
}

}  // namespace gicodec::tools

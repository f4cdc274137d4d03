// gicodec verify: checks that a container is sound and decodes to its dumps bit for bit.
#include "common/backend_flags.h"
#include "common/cli.h"
#include "common/container_input.h"
#include "common/error_flags.h"
#include "common/file_forms.h"
#include "common/file_names.h"
#include "common/volume_words.h"
#include "difference.h"
#include "dump/dump.h"
#include "dump/file.h"
#include "dump/sequence.h"
#include "finding.h"
#include "texture_roles.h"

#include <gicodec/kind.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>
#include <utility>

namespace gicodec::tools {
namespace {

constexpr const char* kVerifyFooter =
    "Decodes every frame and compares texels, channels and attributes with the files. Exit code 0\n"
    "means that all of them are the same, 1 that something differs, is missing or is left over.\n"
    "Probes that encode left out (--inactive) are skipped. Without files every "
    "packet\n"
    "is decoded and nothing is compared; so are packets of what dumps do not hold. Those of a "
    "volume\n"
    "of a kind that this program does not know are checked, not decoded.\n"
    "\n"
    "Examples:\n"
    "  gicodec verify villa.gic dumps/villa/*.exr\n"
    "  gicodec verify villa.gic dumps/villa/ --format json\n"
    "  gicodec verify --max-error color=1 villa.gic dumps/villa/\n"
    "  gicodec verify recording.gic\n";

struct VerifyOptions {
  std::string input;
  std::vector<std::string> files;
  std::string volume;
  std::string format = "text";
  std::vector<std::string> max_error;
  DecoderFlags decoder;
};

/// Findings so far. Equal files are only counted, unless `keep_all`, so memory does not grow with
/// frames.
struct Report {
  bool keep_all = false;
  std::vector<Sequence> sequences;  ///< dumps to compare with
  std::vector<Finding> findings;
  std::size_t files = 0, same = 0, good = 0;
  std::string last_file;  ///< of the last finding, and how its file is so far
  bool last_same = false, last_good = false;
  std::vector<float> max_error;                     ///< by texture
  std::vector<std::vector<std::uint64_t>> largest;  ///< largest distance, by texture and channel
  std::vector<std::uint64_t> packets;               ///< by texture
  std::set<std::string> unseen;                     ///< files not yet compared

  /// Findings about images of one file follow one another.
  void add(Finding finding) {
    if (finding.file.empty() || finding.file != last_file) {
      ++files, ++same, ++good;
      last_file = finding.file;
      last_same = last_good = true;
    }
    if (!finding.same() && std::exchange(last_same, false)) --same;
    if (!finding.good() && std::exchange(last_good, false)) --good;
    if (!finding.file.empty()) unseen.erase(finding.file);
    if (keep_all || !finding.good()) findings.push_back(std::move(finding));
  }
  /// Notes the largest distances of textures with an error bound.
  void note_distances(std::size_t texture, const Finding& finding) {
    if (!finding.difference || max_error[texture] == 0) return;
    largest[texture].resize(finding.difference->channels.size());
    for (std::size_t i = 0; i < largest[texture].size(); ++i) {
      std::uint64_t& most = largest[texture][i];
      most = std::max(most, finding.difference->channels[i].max_distance);
    }
  }
};

/// Compares headers without attributes about loss, which texels show.
std::vector<std::string> compare_given(DumpInfo given, DumpInfo stored) {
  for (DumpInfo* info : {&given, &stored}) {
    std::erase_if(info->attributes, [](const auto& a) { return a.name == kLossyAttribute; });
  }
  return compare_headers(given, stored);
}

/// The file of a frame; null if none was given. A still is of the frame that has it.
const FrameFile* file_of(const Sequence& sequence, std::uint64_t frame, const Report& report) {
  const FrameFile& first = sequence.frames.front();
  if (sequence.names.digits == 0 && report.unseen.contains(first.path)) return &first;
  return sequence.find(frame);
}

Finding compare_frame(std::size_t id, const ContainerInput& input, const Report& report) {
  const std::uint64_t frame = input.frame();
  const auto& sequences = report.sequences;
  const StoredTexture& texture = input.textures()[id];
  Finding finding;
  finding.texture = texture.name;
  finding.of_file = texture.file;
  finding.frame = frame;
  finding.desc = texture.info.desc;
  const auto sequence =
      std::find_if(sequences.begin(), sequences.end(),
                   [&](const Sequence& candidate) { return candidate.name == texture.file; });
  const FrameFile* file = sequence == sequences.end() ? nullptr : file_of(*sequence, frame, report);
  if (file == nullptr) {
    finding.missing = fmt::format("{} was not given", texture.file_name(frame));
    return finding;
  }
  finding.file = file->path;
  const Dump dump = read_dump(file->path, hints_of(texture.info));
  // Images of other kinds decode to EXR, so only texels can be compared.
  if (texture.made_of_files && sequence->names.extension == texture.names.extension) {
    const bool decoded = find_attribute(dump.info.attributes, kLossyAttribute) != nullptr;
    finding.headers =
        compare_given(dump.info, decoded ? texture.decoded_info(frame) : texture.info_at(frame));
  }
  finding.difference = compare_texels(texture.info.desc, dump.texels, input.texels(id),
                                      texture.inactive, report.max_error[id]);
  finding.max_error = report.max_error[id];
  return finding;
}

void add_left_over(const std::vector<Sequence>& sequences, Report& report,
                   const std::string& path) {
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) {
      if (!report.unseen.contains(file.path)) continue;
      Finding finding;
      finding.texture = finding.of_file = sequence.name;
      finding.frame = file.frame;
      finding.file = file.path;
      finding.missing = fmt::format("{} has no such frame of texture {}", path, sequence.name);
      report.add(std::move(finding));
    }
  }
}

/// How the packets of a volume were checked besides comparing, in words; may be empty.
std::string volume_text(const ContainerInput& input, std::size_t volume, const Report& report) {
  const ContainerDescription& description = input.description();
  const VolumeEntry& entry = description.volumes[volume];
  if (!input.is_selected(entry.first_texture)) return "";
  std::uint64_t packets = 0;
  bool dumps = true;
  for (std::size_t i = 0; i < entry.textures; ++i) {
    packets += report.packets[entry.first_texture + i];
    dumps &= input.textures()[entry.first_texture + i].no_dump.empty();
  }
  const std::string unknown = unknown_kind(description, volume);
  if (!unknown.empty()) {
    return fmt::format("{}: its {} packets were checked, not decoded", unknown, packets);
  }
  if (dumps && !report.sequences.empty()) return "";
  return fmt::format("volume {}: its {} packets were decoded, and compared with nothing",
                     volume_name(description, volume), packets);
}

/// True if a texture can become dumps, to compare with.
bool has_dumps(const ContainerInput& input) {
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    if (input.is_selected(i) && has_dumps(input, input.description().textures[i].volume))
      return true;
  }
  return false;
}

/// Compares a frame's textures with their dumps, if they have any.
void check_frame(const ContainerInput& input, unsigned threads, Report& report) {
  for (const ContainerPacket& packet : input.packets()) ++report.packets[packet.texture_id];
  if (report.sequences.empty()) return;
  auto arrived = input.arrived();
  std::erase_if(arrived, [&](std::size_t id) { return !input.textures()[id].no_dump.empty(); });
  std::vector<Finding> findings(arrived.size());
  std::vector<std::function<void()>> tasks;
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    tasks.emplace_back([&, i] { findings[i] = compare_frame(arrived[i], input, report); });
  }
  run_all(threads, tasks);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    report.note_distances(arrived[i], findings[i]);
    report.add(std::move(findings[i]));
  }
}

Exit verify(const VerifyOptions& options, const Cli& cli) {
  ContainerInput input(options.input, options.decoder);
  input.read_metadata();
  select_volume(input, options.volume);
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const StoredTexture& texture = input.textures()[i];
    if (texture.no_dump.empty() && input.is_selected(i)) require_attributes(texture, input.path());
  }
  std::vector<Sequence> sequences;
  for (const std::string& path : options.files) require_exists(path);
  if (!options.files.empty()) {
    NumberOptions numbers{.allow_gaps = true};
    for (const StoredTexture& texture : input.textures()) {
      numbers.known.push_back({file_stem(texture), texture.names});
    }
    SequenceRemarks remarks;
    sequences = group_sequences(options.files, numbers, &remarks);
    for (const std::string& line : remarks.left_out) remark(line);
  }
  for (Sequence& sequence : sequences) {
    const auto named = [&](const StoredTexture& texture) {
      return file_stem(texture) == sequence.name;
    };
    const auto texture = std::ranges::find_if(input.textures(), named);
    if (texture != input.textures().end()) sequence.name = texture->file;
  }
  const auto texture_of = [&](const Finding& finding) -> const StoredTexture* {
    for (const StoredTexture& texture : input.textures()) {
      if (texture.name == finding.texture) return &texture;
    }
    return nullptr;
  };

  if (!sequences.empty()) require_distinct_files(input);
  Report report;
  report.keep_all = options.format == "json";
  report.sequences = sequences;
  report.packets.resize(input.textures().size());
  report.largest.resize(input.textures().size());
  std::vector<std::string> names;
  std::vector<TextureDesc> descs;
  std::vector<bool> shown;
  for (const StoredTexture& texture : input.textures()) {
    names.push_back(texture.name);
    descs.push_back(texture.info.desc);
  }
  check_error_names(options.max_error, names);
  for (const VolumeEntry& volume : input.description().volumes) {
    const auto own = shown_textures(volume.desc, volume.textures);
    shown.insert(shown.end(), own.begin(), own.end());
  }
  report.max_error = max_errors(options.max_error, names, descs, are_light(descs, shown));
  if (!options.max_error.empty() && sequences.empty()) {
    fail(Exit::usage, "--max-error needs the dumps that {} was made from", input.path());
  }
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) report.unseen.insert(file.path);
  }
  std::size_t frames = 0;
  std::string damage, cure;
  try {
    Progress progress("verifying frame", all_frames(sequences).size(), cli);
    while (input.next_frame()) {
      progress.step();
      ++frames;
      check_frame(input, options.decoder.threads, report);
    }
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    cure = input.damaged() ? "; " + recovery(input) : "";
    if (options.format != "json") fail(error.code(), "{}{}", error.what(), cure);
    damage = error.what();
  }
  if (!cli.quiet) remark_cost(input);
  const Exit cut = report_cut_off(input, recovery(input), false);
  add_left_over(sequences, report, input.path());

  const bool compared = !sequences.empty();
  const bool identical = compared && report.same == report.files && report.files > 0;
  const bool good = compared && report.good == report.files && report.files > 0;
  if (options.format == "json") {
    nlohmann::ordered_json json = {{"container", input.path()},
                                   {"sound", cut == Exit::ok && damage.empty()},
                                   {"compared", compared},
                                   {"identical", nullptr},
                                   {"damage", damage.empty() ? nlohmann::ordered_json(nullptr)
                                                             : nlohmann::ordered_json(damage)},
                                   {"frames", frames},
                                   {"files", report.files},
                                   {"files_identical", report.same},
                                   {"files_within_max_error", report.good}};
    if (compared) json["identical"] = identical && cut == Exit::ok && damage.empty();
    for (std::size_t i = 0; i < input.description().volumes.size(); ++i) {
      const VolumeEntry& volume = input.description().volumes[i];
      const Kind* kind = find_kind(volume.kind);
      json["volumes"].push_back({{"name", volume.name},
                                 {"kind", kind == nullptr ? nlohmann::ordered_json(nullptr)
                                                          : nlohmann::ordered_json(kind->name)},
                                 {"kind_number", volume.kind},
                                 {"decoded", unknown_kind(input.description(), i).empty()}});
    }
    for (std::size_t i = 0; i < input.textures().size(); ++i) {
      const StoredTexture& texture = input.textures()[i];
      json["textures"].push_back({{"name", texture.name},
                                  {"volume", input.description().textures[i].volume},
                                  {"packets", report.packets[i]},
                                  {"lossy", !texture.lossy.empty()},
                                  {"max_error", report.max_error[i]},
                                  {"largest_distances", report.largest[i]},
                                  {"not_kept", texture.dropped},
                                  {"inactive_probes_skipped", texture.inactive.size()}});
    }
    for (const Finding& finding : report.findings)
      json["findings"].push_back(finding_json(finding));
    print_json(json);
  } else {
    for (const Finding& finding : report.findings) {
      if (!finding.good()) print_text(finding, texture_of(finding));
    }
    for (std::size_t i = 0; i < input.textures().size(); ++i) {
      if (report.largest[i].empty()) continue;
      const StoredTexture& texture = input.textures()[i];
      print("texture {}, --max-error {}: off are", texture.name, report.max_error[i]);
      const auto used = texture.info.desc.record.used();
      for (std::size_t c = 0; c < used.size(); ++c) {
        print("{} {} by {}", c > 0 ? "," : "", used[c].name(), report.largest[i][c]);
      }
      print(" at most (codes or ULP)\n");
    }
    for (const StoredTexture& texture : input.textures()) {
      if (const std::string loss = texture.loss(); !loss.empty()) print("{}\n", loss);
      if (!texture.dropped.empty()) {
        print("texture {}: {} of the files not kept and not compared\n", texture.name,
              texture.dropped);
      }
      if (texture.inactive.empty()) continue;
      print("texture {}: {} inactive probes were not stored and not compared\n", texture.name,
            texture.inactive.size());
    }
    for (std::size_t i = 0; i < input.description().volumes.size(); ++i) {
      const std::string text = volume_text(input, i, report);
      if (!text.empty()) print("{}\n", text);
    }
    for (std::size_t i = 0; compared && i < input.textures().size(); ++i) {
      const StoredTexture& texture = input.textures()[i];
      const float error = texture.largest_error;
      if (error == 0 || std::isinf(error) || report.max_error[i] > 0) continue;
      if (std::none_of(report.findings.begin(), report.findings.end(), [&](const Finding& f) {
            return f.texture == texture.name && f.difference && !f.difference->same();
          }))
        continue;
      print("texture {} was coded {}: --max-error {}={} compares it so\n", texture.name,
            error_text(error), texture.name, error);
    }
    if (compared) {
      print("{}: {} of {} file{} in {} frame{} {} bit-exact", input.path(), report.same,
            report.files, report.files == 1 ? "" : "s", frames, frames == 1 ? "" : "s",
            report.files == 1 ? "is" : "are");
      if (!options.max_error.empty()) print(", {} within --max-error", report.good);
      print("{}\n", good ? "" : ": NOT VERIFIED");
    } else if (damage.empty()) {
      print("{}: {} frame{} sound{}\n", input.path(), frames, frames == 1 ? " is" : "s are",
            has_dumps(input) ? "; name the dumps to compare them" : "");
    }
  }
  if (!damage.empty()) {
    remark(damage + cure);
    return Exit::bad_input;
  }
  if (compared && !good) return cut == Exit::ok ? Exit::different : cut;
  return cut;
}

}  // namespace

void add_verify(Cli& cli) {
  auto options = std::make_shared<VerifyOptions>();
  Command* command = cli.app.add_command(
      "verify", "Proves that a container is sound, and gives back its dumps bit by bit");
  command->footer(kVerifyFooter);
  command
      ->add_option("container", options->input,
                   "Container to check, file or URL; - for standard input")
      ->required()
      ->type_name("FILE");
  command->add_option("files", options->files, "The dumps it was made from, or their directory")
      ->type_name("FILE");
  command->add_option("--volume", options->volume, "Only this volume; default: all")
      ->type_name("NAME|NUMBER");
  add_error_flag(*command, options->max_error, "How far texels may be off from the files",
                 "Options");
  add_output_format(*command, options->format);
  add_decoder_flags(*command, options->decoder);
  add_http_flags(*command, options->decoder.http);
  command->callback(
      [&cli, options] { cli.run = [&cli, options] { return verify(*options, cli); }; });
}

}  // namespace gicodec::tools

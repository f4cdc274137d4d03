// gicodec verify: checks that a container is sound and decodes to its dumps bit for bit.
#include "common/error_flags.h"
#include "common/volume_words.h"
#include "verified.h"

#include <gicodec/kind.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

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

void report_json(const Verified& verified, Exit cut) {
  const ContainerInput& input = *verified.input;
  const Report& report = verified.report;
  const std::string& damage = verified.damage;
  const std::size_t frames = verified.frames;
  const bool compared = verified.compared();
  const bool identical = compared && report.same == report.files && report.files > 0;
  nlohmann::ordered_json json = {
      {"container", input.path()},
      {"sound", cut == Exit::ok && damage.empty()},
      {"compared", compared},
      {"identical", nullptr},
      {"damage", damage.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(damage)},
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
  for (const Finding& finding : report.findings) json["findings"].push_back(finding_json(finding));
  print_json(json);
}

void report_text(const Verified& verified, const VerifyOptions& options) {
  const ContainerInput& input = *verified.input;
  const Report& report = verified.report;
  const std::size_t frames = verified.frames;
  const bool compared = verified.compared(), good = verified.good();
  const auto texture_of = [&](const Finding& finding) -> const StoredTexture* {
    for (const StoredTexture& texture : input.textures()) {
      if (texture.name == finding.texture) return &texture;
    }
    return nullptr;
  };
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
    print("{}: {} of {} file{} in {} frame{} {} bit-exact", input.path(), report.same, report.files,
          report.files == 1 ? "" : "s", frames, frames == 1 ? "" : "s",
          report.files == 1 ? "is" : "are");
    if (!options.max_error.empty()) print(", {} within --max-error", report.good);
    print("{}\n", good ? "" : ": NOT VERIFIED");
  } else if (verified.damage.empty()) {
    print("{}: {} frame{} sound{}\n", input.path(), frames, frames == 1 ? " is" : "s are",
          has_dumps(input) ? "; name the dumps to compare them" : "");
  }
}

Exit verify(const VerifyOptions& options, const Cli& cli) {
  const Verified verified = verify_dumps(options, cli);
  if (!cli.quiet) remark_cost(*verified.input);
  const Exit cut = report_cut_off(*verified.input, recovery(*verified.input), false);
  if (options.format == "json") {
    report_json(verified, cut);
  } else {
    report_text(verified, options);
  }
  if (!verified.damage.empty()) {
    remark(verified.damage + verified.cure);
    return Exit::bad_input;
  }
  if (verified.compared() && !verified.good()) return cut == Exit::ok ? Exit::different : cut;
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

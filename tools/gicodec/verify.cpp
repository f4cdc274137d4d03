// gicodec verify: proof that a container gives back its dumps bit for bit.
#include "backend_flags.h"
#include "cli.h"
#include "container_input.h"
#include "difference.h"
#include "dump/dump.h"
#include "dump/sequence.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

namespace gicodec::tools {
namespace {

constexpr const char* kFooter =
    "Decodes every frame and compares texels, channels and attributes with the files. Exit code 0\n"
    "means that all of them are the same, 1 that something differs, is missing or is left over.\n"
    "Probes that encode was told to leave out (--inactive) are skipped.\n"
    "\n"
    "Examples:\n"
    "  gicodec verify villa.gic dumps/villa/*.exr\n"
    "  gicodec verify villa.gic dumps/villa/ --format json\n";

struct VerifyOptions {
  std::string input;
  std::vector<std::string> files;
  std::string format = "text";
  DecoderFlags decoder;
};

/// What was found about one file.
struct Finding {
  std::string texture;
  std::uint64_t frame = 0;
  std::string file;                  ///< empty if there is none
  std::string missing;               ///< what is missing, if something is
  std::vector<std::string> headers;  ///< differences besides texels
  std::optional<Difference> difference;
  Format texel_format{};

  [[nodiscard]] bool same() const {
    return missing.empty() && headers.empty() && difference && difference->same();
  }
};

Finding check_packet(const ContainerPacket& packet, const ContainerInput& input,
                     TextureStates& states, const std::vector<Sequence>& sequences) {
  const StoredTexture& texture = input.textures()[packet.texture_id];
  Finding finding;
  finding.texture = texture.name;
  finding.frame = packet.frame;
  finding.texel_format = texture.info.desc.format;
  states.apply(packet);
  const auto sequence =
      std::find_if(sequences.begin(), sequences.end(),
                   [&](const Sequence& candidate) { return candidate.name == texture.name; });
  const FrameFile* file = sequence == sequences.end() ? nullptr : sequence->find(packet.frame);
  if (file == nullptr) {
    finding.missing = fmt::format("{} was not given", texture.file_name(packet.frame));
    return finding;
  }
  finding.file = file->path;
  const Dump dump = read_dump(file->path, hints_of(texture.info));
  // Other images than EXR come back as EXR, so only their texels can be the same.
  if (sequence->extension == texture.extension) {
    const bool decoded = find_attribute(dump.info.attributes, kLossyAttribute) != nullptr;
    finding.headers = compare_headers(
        dump.info, decoded ? texture.decoded_info(packet.frame) : texture.info_at(packet.frame));
  }
  finding.difference = compare_texels(texture.info.desc, dump.texels,
                                      states.texels(packet.texture_id), texture.inactive);
  return finding;
}

/// What was found so far. Findings of equal files are counted and kept only if they are asked for,
/// so that memory does not grow with the frames.
struct Report {
  bool keep_all = false;
  std::vector<Finding> findings;
  std::size_t files = 0, same = 0;
  std::set<std::pair<std::string, std::uint64_t>> unseen;  ///< texture and frame of the files

  void add(Finding finding) {
    ++files;
    if (finding.same()) ++same;
    if (!finding.file.empty()) unseen.erase({finding.texture, finding.frame});
    if (keep_all || !finding.same()) findings.push_back(std::move(finding));
  }
};

void add_left_over(const std::vector<Sequence>& sequences, Report& report,
                   const std::string& path) {
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) {
      if (report.unseen.count({sequence.name, file.frame}) == 0) continue;
      report.add(
          {sequence.name,
           file.frame,
           file.path,
           fmt::format("frame {} of texture {} is not in {}", file.frame, sequence.name, path),
           {},
           {},
           {}});
    }
  }
}

void print_text(const Finding& finding, const StoredTexture* texture) {
  const std::string where =
      finding.file.empty() ? fmt::format("frame {}, texture {}", finding.frame, finding.texture)
                           : fmt::format("{}: frame {}", finding.file, finding.frame);
  if (!finding.missing.empty()) print("{}: {}\n", where, finding.missing);
  for (const std::string& line : finding.headers) print("{}: {}\n", where, line);
  if (!finding.difference || finding.difference->same()) return;
  const Difference& difference = *finding.difference;
  print("{}: {} of {} probes and {} texels differ, first {} in the container", where,
        difference.probes, difference.total_probes, difference.texels,
        to_string(*difference.first, finding.texel_format));
  if (difference.psnr) print("; PSNR {:.2f} dB", *difference.psnr);
  if (texture != nullptr && !texture->lossy.empty()) {
    print("; coded LOSSY ({})", texture->lossy);
  }
  print("\n");
}

nlohmann::ordered_json finding_json(const Finding& finding) {
  nlohmann::ordered_json json = {{"texture", finding.texture},
                                 {"frame", finding.frame},
                                 {"file", finding.file},
                                 {"identical", finding.same()}};
  if (!finding.missing.empty()) json["missing"] = finding.missing;
  if (!finding.headers.empty()) json["headers"] = finding.headers;
  if (finding.difference) json["texels"] = to_json(*finding.difference, finding.texel_format);
  return json;
}

Exit verify(const VerifyOptions& options, const Cli& cli) {
  ContainerInput input(options.input);
  const auto sequences = group_sequences(options.files, true);
  TextureStates states(input, options.decoder);
  const auto texture_of = [&](const Finding& finding) -> const StoredTexture* {
    for (const StoredTexture& texture : input.textures()) {
      if (texture.name == finding.texture) return &texture;
    }
    return nullptr;
  };

  Report report{options.format == "json", {}, 0, 0, {}};
  for (const Sequence& sequence : sequences) {
    for (const FrameFile& file : sequence.frames) report.unseen.emplace(sequence.name, file.frame);
  }
  std::uint64_t frame = 0;
  std::size_t frames = 0;
  std::vector<ContainerPacket> packets;
  std::string damage;
  try {
    Progress progress("verifying frame", all_frames(sequences).size(), cli);
    while (input.next_frame(frame, packets)) {
      progress.step();
      ++frames;
      std::vector<Finding> of_frame(packets.size());
      std::vector<std::function<void()>> tasks;
      for (std::size_t i = 0; i < packets.size(); ++i) {
        tasks.emplace_back(
            [&, i] { of_frame[i] = check_packet(packets[i], input, states, sequences); });
      }
      run_all(options.decoder.threads, tasks);
      for (Finding& finding : of_frame) report.add(std::move(finding));
    }
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input || options.format != "json") throw;
    damage = error.what();
  }
  const Exit cut = report_cut_off(input, frames, false);
  add_left_over(sequences, report, input.path());

  const bool identical = report.same == report.files && report.files > 0;
  if (options.format == "json") {
    nlohmann::ordered_json json = {{"container", input.path()},
                                   {"identical", identical && cut == Exit::ok && damage.empty()},
                                   {"damage", damage.empty() ? nlohmann::ordered_json(nullptr)
                                                             : nlohmann::ordered_json(damage)},
                                   {"frames", frames},
                                   {"files", report.files},
                                   {"files_identical", report.same}};
    for (const StoredTexture& texture : input.textures()) {
      json["textures"].push_back({{"name", texture.name},
                                  {"lossy", !texture.lossy.empty()},
                                  {"not_kept", texture.dropped},
                                  {"inactive_probes_skipped", texture.inactive.size()}});
    }
    for (const Finding& finding : report.findings)
      json["findings"].push_back(finding_json(finding));
    print_json(json);
  } else {
    for (const Finding& finding : report.findings) {
      if (!finding.same()) print_text(finding, texture_of(finding));
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
    print("{}: {} of {} files in {} frames are bit-exact{}\n", input.path(), report.same,
          report.files, frames, identical ? "" : ": NOT VERIFIED");
  }
  if (!damage.empty()) {
    remark(damage);
    return Exit::bad_input;
  }
  if (!identical) return cut == Exit::ok ? Exit::different : cut;
  return cut;
}

}  // namespace

void add_verify(Cli& cli) {
  auto options = std::make_shared<VerifyOptions>();
  Command* command =
      cli.app.add_command("verify", "Proves that a container gives back its dumps bit by bit");
  command->footer(kFooter);
  command->add_option("container", options->input, "Container to check; - for standard input")
      ->required()
      ->type_name("FILE");
  command->add_option("files", options->files, "The dumps it was made from, or their directory")
      ->required()
      ->type_name("FILE");
  add_output_format(*command, options->format);
  add_decoder_flags(*command, options->decoder);
  command->callback(
      [&cli, options] { cli.run = [&cli, options] { return verify(*options, cli); }; });
}

}  // namespace gicodec::tools

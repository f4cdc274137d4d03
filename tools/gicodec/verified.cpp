#include "verified.h"

#include "common/error_flags.h"
#include "common/file_forms.h"
#include "common/file_names.h"
#include "common/volume_words.h"
#include "difference.h"
#include "dump/dump.h"
#include "dump/file.h"
#include "texture_roles.h"

#include <algorithm>
#include <functional>

namespace gicodec::tools {
namespace {

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

}  // namespace

Verified verify_dumps(const VerifyOptions& options, const Cli& cli) {
  Verified verified{std::make_unique<ContainerInput>(options.input, options.decoder)};
  ContainerInput& input = *verified.input;
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
  if (!sequences.empty()) require_distinct_files(input);
  Report& report = verified.report;
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
  try {
    Progress progress("verifying frame", all_frames(sequences).size(), cli);
    while (input.next_frame()) {
      progress.step();
      ++verified.frames;
      check_frame(input, options.decoder.threads, report);
    }
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    verified.cure = input.damaged() ? "; " + recovery(input) : "";
    if (options.format != "json") fail(error.code(), "{}{}", error.what(), verified.cure);
    verified.damage = error.what();
  }
  add_left_over(sequences, report, input.path());
  return verified;
}

}  // namespace gicodec::tools

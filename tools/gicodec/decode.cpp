// gicodec decode: writes the dumps of a container.
#include "common/backend_flags.h"

#include <gicodec/textures.h>
#include "common/cli.h"
#include "common/container_input.h"
#include "common/file_forms.h"
#include "common/file_names.h"
#include "common/frame_range.h"
#include "common/volume_words.h"
#include "dump/cure.h"
#include "dump/directory.h"
#include "dump/dump.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>

namespace gicodec::tools {
namespace {

constexpr const char* kDecodeFooter =
    "Writes the files that encode read: same names, channels, attributes and bits; EXR where the\n"
    "container does not say, as recordings and traces do not. In names of files %2F stands for a\n"
    "slash, and other bytes that they cannot have likewise. --files makes them of another kind,\n"
    "with the same texels; DDS files have no attributes, and only DXGI's formats. Files that are\n"
    "there already are kept and end the command unless --overwrite is given; even then a dump is\n"
    "not replaced by a texture that lacks something of what was encoded (--inactive, --lossy) and\n"
    "differs. A container whose end is missing gives every frame before the cut; the exit code is\n"
    "3 then, or 0 with --allow-incomplete. Of a container with several volumes\n"
    "--volume takes one by the name, or number, that info lists.\n"
    "\n"
    "Examples:\n"
    "  gicodec decode https://example.com/day.gic --frames 5000-5010 -o out/\n"
    "  gicodec decode https://example.com/live.gic --follow --frames 100- -o out/\n"
    "  gicodec decode villa.gic -o out/\n"
    "  gicodec decode villa.gic -o out/ --frames 10-19\n"
    "  gicodec decode recording.gic -o out/ --files ktx2\n"
    "  curl https://example.org/villa.gic | gicodec decode - -o out/\n";

struct DecodeOptions {
  std::string input;
  std::string output;
  std::string frames;
  std::string volume;
  std::string files;
  DecoderFlags decoder;
  bool allow_incomplete = false;
  bool overwrite = false;
  bool plain = false;
};

/// Throws for a second frame of a texture whose file names have no number.
void check_numbered(const StoredTexture& texture, std::optional<std::uint64_t>& written,
                    std::uint64_t frame, const std::string& path) {
  if (texture.names.digits == 0 && written) {
    fail(Exit::bad_input,
         "{}: the files of texture {} have no frame numbers, so that frame {} would take the place "
         "of frame {}; {}",
         path, texture.name, frame, *written, to_cure(Cure::one_frame, frame));
  }
  written = frame;
}

/// Throws if a file that lacks something would replace one that may be its only original.
void keep_original(const std::string& path, const StoredTexture& texture, const Dump& image) {
  const std::string lacks = texture.lacks();
  if (lacks.empty() || !std::filesystem::exists(native_path(path))) return;
  std::string unread;
  try {
    const Dump old = read_dump(path, hints_of(texture.info));
    if (image.texels == old.texels && old.info.attributes == image.info.attributes &&
        old.info.lost.empty()) {
      return;
    }
  } catch (const Error& error) {
    unread = fmt::format(" (it cannot be compared: {})", error.what());
  }
  fail(Exit::io, "{}: may be the original of texture {}, of which the container lacks {}{}; {}",
       path, texture.name, lacks, unread, to_cure(Cure::other_folder));
}

/// Writes the file of a frame's textures that are its images.
void write_file_of(const ContainerInput& input, std::span<const std::size_t> textures,
                   const std::string& path, const InputFiles& inputs, bool overwrite) {
  std::vector<Dump> images;
  for (const std::size_t id : textures) {
    images.push_back({input.textures()[id].decoded_info(input.frame()), input.texels(id)});
  }
  for (const std::string& file : files_of(path)) {
    check_output(file, inputs, file == path ? overwrite_if(overwrite) : Existing::replace);
  }
  for (std::size_t i = 0; overwrite && i < images.size(); ++i) {
    keep_original(path, input.textures()[textures[i]], images[i]);
  }
  write_dumps(path, images, overwrite_if(overwrite));
}

/// The textures that are images of one file, for each file of the frame. Throws if some did not
/// arrive.
std::vector<std::vector<std::size_t>> files_of_frame(const ContainerInput& input) {
  std::vector<std::vector<std::size_t>> files;
  const auto& textures = input.textures();
  for (const std::size_t id : input.arrived()) {
    const bool joins = !files.empty() && of_one_file(textures[files.back().back()], textures[id]);
    if (!joins) files.emplace_back();
    files.back().push_back(id);
  }
  for (const auto& file : files) {
    const auto all = std::ranges::count_if(
        textures, [&](const auto& one) { return of_one_file(one, textures[file[0]]); });
    if (static_cast<std::size_t>(all) == file.size() || !textures[file[0]].made_of_files) continue;
    fail(Exit::bad_input, "{}: frame {} has {} of the {} images of {}", input.path(), input.frame(),
         file.size(), all, textures[file[0]].file);
  }
  return files;
}

/// True if files that were compressed are written anew.
bool is_any_anew(const ContainerInput& input) {
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const StoredTexture& texture = input.textures()[i];
    const auto is_set = [&](const char* name, const char* plain) {
      const Attribute* found = find_attribute(texture.info.attributes, name);
      return found != nullptr && found->value != plain;
    };
    if (!input.is_selected(i) || !texture.made_of_files) continue;
    if (is_set("compression", "0x00") || is_set(kKtx2Scheme, "")) return true;
  }
  return false;
}

Exit decode(const DecodeOptions& options, const Cli& cli) {
  const FrameRange range = frame_range_from_string(options.frames);
  ContainerInput input(options.input, options.decoder);
  input.read_metadata(options.allow_incomplete);
  if (!options.files.empty()) input.set_files(*image_kind("x." + options.files));
  if (options.plain) input.drop_attribute(kKtx2Scheme);
  select_dumps(input, options.volume);
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    if (!input.is_selected(i)) continue;
    require_format(input.textures()[i], input.path());
    require_attributes(input.textures()[i], input.path());
  }
  InputFiles inputs;
  inputs.add(options.input == "-" ? "/dev/stdin" : options.input);
  const OutputDirectory directory(options.output);
  if (range.first > 0) input.seek(range.first);

  std::vector<std::optional<std::uint64_t>> written(input.textures().size());  ///< last frame
  std::size_t frames = 0;
  std::atomic<std::size_t> files = 0;
  try {
    Progress progress("decoding frame", 0, cli);
    while (input.next_frame() && input.frame() <= range.last) {
      progress.step();
      const std::uint64_t frame = input.frame();
      if (!range.contains(frame) || input.arrived().empty()) continue;
      const auto files_here = files_of_frame(input);
      std::vector<std::function<void()>> tasks;
      for (const auto& images : files_here) {
        const StoredTexture& texture = input.textures()[images.front()];
        check_numbered(texture, written[images.front()], frame, input.path());
        tasks.emplace_back([&] {
          const auto path = native_path(options.output) / native_path(texture.file_name(frame));
          write_file_of(input, images, path_text(path), inputs, options.overwrite);
          ++files;
        });
      }
      run_all(options.decoder.threads, tasks);
      ++frames;
    }
  } catch (const Error& error) {
    const std::size_t there = files;
    if (there > 0) {
      remark(fmt::format("{}: {} written, then:", options.output,
                         there == 1 ? "1 file was" : fmt::format("{} files were", there)));
    }
    if (!input.damaged()) throw;
    fail(error.code(), "{}; {}", error.what(), recovery(input));
  }
  const Exit exit =
      report_cut_off(input,
                     fmt::format("{} frame{} before the cut {} recovered", frames,
                                 frames == 1 ? "" : "s", frames == 1 ? "was" : "were"),
                     options.allow_incomplete);
  if (exit == Exit::ok && frames == 0 && !options.frames.empty()) {
    fail(Exit::bad_input, "{}: has no frame in {}; {}", input.path(), options.frames,
         input.frames_there());
  }
  if (cli.quiet) return exit;
  remark_cost(input);
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    if (!input.is_selected(i)) continue;
    const StoredTexture& texture = input.textures()[i];
    const std::string stem = file_stem(texture);
    if (stem != texture.file && texture.info.place == ImagePlace{}) {
      remark(fmt::format("texture {}: its files are named {}, since its name cannot be theirs",
                         texture.name, stem));
    }
    if (const std::string loss = texture.loss(); !loss.empty()) remark(loss);
    if (!texture.dropped.empty()) {
      remark(
          fmt::format("texture {}: {} of its files were not kept", texture.name, texture.dropped));
    }
    if (!texture.unsaid.empty()) {
      remark(fmt::format("texture {}: {} files do not have its attributes {}", texture.name,
                         texture.names.extension, texture.unsaid));
    }
    if (!texture.unlike.empty())
      remark(fmt::format("texture {}: {}", texture.name, texture.unlike));
    if (!texture.inactive.empty()) {
      remark(fmt::format("texture {}: {} inactive probes were not stored and are zero",
                         texture.name, texture.inactive.size()));
    }
  }
  if (is_any_anew(input)) {
    remark(
        "EXR files and packed KTX2 files are compressed anew: the same contents, maybe other "
        "bytes");
  }
  const ContainerDescription& description = input.description();
  for (std::size_t v = 0; v < description.volumes.size(); ++v) {
    const VolumeEntry& volume = description.volumes[v];
    const std::uint8_t kind = volume.kind;
    bool selected = false;
    for (std::uint32_t i = 0; i < volume.textures; ++i) {
      selected = selected || input.is_selected(volume.first_texture + i);
    }
    if (selected && kind != kKindProbes && kind != kKindTextures) {
      remark(
          fmt::format("volume {}: files do not say that it is of kind {}; encode packs them as "
                      "textures",
                      volume_name(description, v), kind_text(kind)));
    }
  }
  remark(fmt::format("{}: {} file{} written{}", options.output, files.load(), files == 1 ? "" : "s",
                     files > 0 ? ""
                     : options.volume.empty()
                         ? ": it has no frame"
                         : fmt::format(": it has no frame of volume {}", options.volume)));
  return exit;
}

}  // namespace

void add_decode(Cli& cli) {
  auto options = std::make_shared<DecodeOptions>();
  Command* command =
      cli.app.add_command("decode", "Unpacks a .gic container into the dumps it was made from");
  command->footer(kDecodeFooter);
  command
      ->add_option("container", options->input,
                   "Container to read, file or URL; - for standard input")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "Directory to write to; made if needed")
      ->required()
      ->type_name("DIR");
  command->add_option("--volume", options->volume, "Only this volume; default: all")
      ->type_name("NAME|NUMBER");
  command
      ->add_option("--files", options->files,
                   "Kind of files to write; default: as encode read, else exr")
      ->allow(one_of({"exr", "dds", "ktx2", "raw"}));
  command->add_flag("--plain", options->plain, "KTX2 files without supercompression");
  command->add_option("--frames", options->frames, "Only these frames")->type_name("A-B");
  add_overwrite(*command, options->overwrite, "Replace files that are there already");
  add_allow_incomplete(*command, options->allow_incomplete);
  command
      ->add_option(
          "--box",
          [options](const std::string& text) {
            options->decoder.box = box_from_flag("--box", text);
          },
          "Of volumes that are cut (encode --region) read only the regions with blocks of this "
          "box; texels of others are zero")
      ->type_name("X0-X1,Y0-Y1,Z0-Z1");
  command->add_flag(
      "--follow", options->decoder.follow,
      "Of a container that is still being written: wait for its further frames, until "
      "its end");
  add_decoder_flags(*command, options->decoder);
  add_http_flags(*command, options->decoder.http);
  command->callback(
      [&cli, options] { cli.run = [&cli, options] { return decode(*options, cli); }; });
}

}  // namespace gicodec::tools

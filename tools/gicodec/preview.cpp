// gicodec preview: writes a picture of a texture.
#include "common/backend_flags.h"
#include "common/cli.h"
#include "common/container_input.h"
#include "common/frame_range.h"
#include "common/preview_picture.h"
#include "common/volume_words.h"
#include "dump/dump.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/sequence.h"
#include "dump/text.h"
#include "geometry_flags.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

namespace gicodec::tools {
namespace {

constexpr const char* kPreviewFooter =
    "Colour is decoded (10-bit codes: to the power of 5, as irradiance is stored), exposed so "
    "that\n"
    "its logarithmic mean is middle grey, tone-mapped by x / (1 + x) and written as sRGB. Colour\n"
    "of 8 or 16 bits, pictures already, stays as it is unless --gamma or --exposure is given.\n"
    "Textures of one or two floating-point channels are distances: grey, the farthest finite one "
    "is white.\n"
    "Records that are no format of Vulkan show their first three components as shares of their\n"
    "range, their blocks side by side.\n"
    "A file that is there already is kept unless --overwrite is given.\n"
    "\n"
    "Examples:\n"
    "  gicodec preview villa.gic --frame 3 -o atlas.png\n"
    "  gicodec preview villa.gic --texture vis -o distance.png\n"
    "  gicodec preview dumps/color.0003.exr --exposure 1.5 -o atlas.png\n";

struct PreviewOptions {
  std::string input;
  std::string output;
  std::optional<std::uint64_t> frame;
  std::string volume, texture;
  bool overwrite = false;
  bool allow_incomplete = false;
  PreviewTuning tuning;
  GeometryFlags geometry;
  DecoderFlags decoder;
};

void note_missing(const ContainerInput& input, bool allowed) {
  const std::string missing = require_complete(input, allowed);
  if (!missing.empty()) remark(missing);
}

/// Throws for an extension other than .png.
void check_picture_name(const std::string& path) {
  const std::string extension = lower_case(path_text(native_path(path).extension()));
  if (extension.empty() || extension == ".png") return;
  fail(Exit::usage, "{}: pictures are written as PNG; name it {}", path,
       path_text(native_path(path).replace_extension(".png")));
}

/// How informative a picture of a texture is: first whether its kind has a preview, then the bytes
/// of its blocks.
std::pair<bool, std::uint64_t> preview_rank(const ContainerDescription& description,
                                            std::size_t texture) {
  const VolumeEntry& volume = description.volumes[description.textures[texture].volume];
  const std::size_t place = texture - volume.first_texture;
  const auto textures = textures_of(volume.desc);
  if (place >= textures.size()) return {};
  if (textures[place]->preview != Preview::none) return {true, 0};  // so the first of these wins
  return {false, block_bytes(textures[place]->desc)};
}

/// The texture to draw: of those that match the flags the most informative one, in the first volume
/// with a texture that can be drawn.
std::size_t chosen(const ContainerInput& input, const PreviewOptions& options) {
  const ContainerDescription& description = input.description();
  std::optional<std::size_t> volume, best, found;
  std::string known;
  if (!options.volume.empty()) volume = find_volume(description, options.volume, input.path());
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const StoredTexture& texture = input.textures()[i];
    if (volume && description.textures[i].volume != *volume) continue;
    known += (known.empty() ? "" : ", ") + texture.name;
    if (!options.texture.empty() && texture.name != options.texture) continue;
    if (!unknown_kind(description, description.textures[i].volume).empty()) {
      if (!found) found = i;
      continue;
    }
    if (best && description.textures[*best].volume != description.textures[i].volume) break;
    if (!best || preview_rank(description, i) > preview_rank(description, *best)) best = i;
  }
  if (best) return *best;
  if (!found) {
    fail(Exit::bad_input, "{}: has no texture {}, only {}", input.path(), options.texture, known);
  }
  fail(Exit::bad_input, "{}: {}", input.path(), input.textures()[*found].no_dump);
}

/// A dump, and what it is in words.
struct Loaded {
  Dump dump;
  std::string what;
};

Loaded load_from_container(const PreviewOptions& options, bool quiet) {
  ContainerInput input(options.input, options.decoder);
  note_missing(input, options.allow_incomplete);
  const std::size_t id = chosen(input, options);
  const StoredTexture* const texture = &input.textures()[id];
  input.select({id});
  if (options.frame) input.seek(*options.frame);
  while (input.next_frame()) {
    check_interrupt();
    if (options.frame && input.frame() != *options.frame) continue;
    if (input.arrived().empty()) break;  // only other textures have packets in this frame
    if (!input.bytes())
      note_missing(input, options.allow_incomplete);  // a pipe's end is known only now
    if (const std::string loss = texture->loss(); !loss.empty() && !quiet) remark(loss);
    if (!quiet) remark_cost(input);
    return {{texture->info_at(input.frame()), input.texels(id)},
            fmt::format("texture {}, frame {}", texture->name, input.frame())};
  }
  if (options.frame) {
    const std::string there = input.cut_off() ? input.missing() : input.frames_there();
    fail(Exit::bad_input, "{}: has no frame {} of texture {}; {}", input.path(), *options.frame,
         texture->name, there);
  }
  fail(Exit::bad_input, "{}: has no frame of texture {}", input.path(), texture->name);
}

Loaded load(const PreviewOptions& options, bool quiet) {
  if (options.input == "-" || is_url(options.input) || is_container_file(options.input)) {
    return load_from_container(options, quiet);
  }
  (void)require_image_kind(options.input);
  require_exists(options.input);
  if (options.frame || !options.texture.empty() || !options.volume.empty()) {
    fail(Exit::usage, "--frame, --volume and --texture are for containers");
  }
  const auto sequences = group_sequences({options.input});
  check_names(options.geometry, sequences);
  const Hints hints =
      settle_formats({&options.input, 1}, hints_for(options.geometry, sequences.front().name));
  const auto images = read_dump_infos(options.input, hints);
  const std::string what =
      images.size() == 1 ? options.input : options.input + ", " + image_words(images.front());
  return {read_dump(options.input, hints_of(images.front())), what};
}

Exit preview(const PreviewOptions& options, const Cli& cli) {
  check_picture_name(options.output);
  InputFiles inputs;
  inputs.add(options.input == "-" ? "/dev/stdin" : options.input);
  check_output(options.output, inputs, overwrite_if(options.overwrite));
  const Loaded loaded = load(options, cli.quiet);
  check_interrupt();
  write_preview(options.output, loaded.dump, options.tuning, overwrite_if(options.overwrite));
  if (!cli.quiet) remark(fmt::format("{}: shows {}", options.output, loaded.what));
  return Exit::ok;
}

}  // namespace

void add_preview(Cli& cli) {
  auto options = std::make_shared<PreviewOptions>();
  Command* command = cli.app.add_command("preview", "Writes a PNG of a texture to look at");
  command->footer(kPreviewFooter);
  command->add_option("input", options->input, "A container or a dump")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "PNG to write; - for standard output")
      ->required()
      ->type_name("FILE");
  add_overwrite(*command, options->overwrite, "Replace a file that is there already");
  add_allow_incomplete(*command, options->allow_incomplete);
  command
      ->add_option(
          "--frame",
          [options](const std::string& text) { options->frame = frame_from_string(text); },
          "Frame of a container; default: the first")
      ->type_name("N");
  command->add_option("--volume", options->volume, "Volume of a container; default: any")
      ->type_name("NAME|NUMBER");
  command
      ->add_option("--texture", options->texture,
                   "Texture of a container; default: the one that shows most")
      ->type_name("NAME");
  command->add_option("--exposure", options->tuning.exposure, "Colour: stops; default: automatic")
      ->type_name("EV");
  command
      ->add_option("--gamma", options->tuning.gamma,
                   "Colour: power that decodes it; default: 5 for 10-bit codes, else 1")
      ->allow(in_range(0.1, 10.0))
      ->type_name("G");
  command->add_option("--max-distance", options->tuning.max_distance, "Distance that is white")
      ->allow(in_range(0.001, 1e6))
      ->type_name("D");
  add_memory_flag(*command, options->decoder);
  add_http_flags(*command, options->decoder.http);
  add_geometry_flags(*command, options->geometry);
  command->callback(
      [&cli, options] { cli.run = [&cli, options] { return preview(*options, cli); }; });
}

}  // namespace gicodec::tools

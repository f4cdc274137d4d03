// gicodec preview: a picture of a texture for a person.
#include "cli.h"
#include "container_input.h"
#include "dump/dump.h"
#include "dump/image.h"
#include "dump/sequence.h"
#include "geometry_flags.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

namespace gicodec::tools {
namespace {

constexpr const char* kFooter =
    "Colour is decoded (integer codes: to the power of 5, as irradiance is stored), exposed so "
    "that\n"
    "its logarithmic mean is middle grey, tone-mapped by x / (1 + x) and written as sRGB. "
    "Textures\n"
    "of one or two floating-point channels are distances: grey, the farthest finite one is white.\n"
    "\n"
    "Examples:\n"
    "  gicodec preview villa.gic --frame 3 -o atlas.png\n"
    "  gicodec preview villa.gic --texture vis -o distance.png\n"
    "  gicodec preview dumps/color.0003.exr --exposure 1.5 -o atlas.png\n";

constexpr double kColourGamma = 5;
constexpr double kMiddleGrey = 0.18;

struct PreviewOptions {
  std::string input;
  std::string output;
  std::optional<std::uint64_t> frame;
  std::string texture;
  std::optional<double> exposure;
  std::optional<double> gamma;
  std::optional<double> max_distance;
  GeometryFlags geometry;
};

bool is_container(const std::string& path) {
  if (path == "-") return true;
  std::array<unsigned char, 4> magic{};
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  return file && std::fread(magic.data(), 1, magic.size(), file.get()) == magic.size() &&
         magic == std::array<unsigned char, 4>{0x89, 'G', 'I', 'C'};
}

Dump load_from_container(const PreviewOptions& options) {
  ContainerInput input(options.input);
  const auto& textures = input.textures();
  const auto texture = std::find_if(textures.begin(), textures.end(), [&](const auto& candidate) {
    return options.texture.empty() || candidate.name == options.texture;
  });
  if (texture == textures.end()) {
    fail(Exit::bad_input, "{}: has no texture {}", input.path(), options.texture);
  }
  const auto id = static_cast<std::size_t>(texture - textures.begin());
  TextureStates states(input);
  if (options.frame) input.seek(*options.frame);
  std::uint64_t frame = 0;
  std::vector<ContainerPacket> packets;
  while (input.next_frame(frame, packets)) {
    bool found = false;
    for (const ContainerPacket& packet : packets) {
      if (packet.texture_id != id) continue;
      states.apply(packet);
      found = true;
    }
    if (!found || (options.frame && frame != *options.frame)) continue;
    const auto texels = states.texels(id);
    return {texture->info_at(frame), {texels.begin(), texels.end()}};
  }
  if (options.frame) {
    fail(Exit::bad_input, "{}: has no frame {} of texture {}{}", input.path(), *options.frame,
         texture->name, input.cut_off() ? "; its end is missing" : "");
  }
  fail(Exit::bad_input, "{}: has no frame of texture {}", input.path(), texture->name);
}

Dump load(const PreviewOptions& options) {
  if (is_container(options.input)) return load_from_container(options);
  if (options.frame || !options.texture.empty()) {
    fail(Exit::usage, "--frame and --texture are for containers");
  }
  const std::string name = group_sequences({options.input}).front().name;
  return read_dump(options.input, hints_for(options.geometry, name));
}

/// The value of a component; not yet multiplied by a shared exponent.
float value_of(const Component& component, std::uint32_t code) {
  if (component.bits == 9) return static_cast<float>(code);
  return std::bit_cast<float>(to_sample(SampleType::float32, component, code));
}

/// Values of the first `channels` components of every texel.
std::vector<float> values_of(const Dump& dump, std::size_t channels) {
  const FormatInfo& format = *find_format(dump.info.desc.format);
  const std::size_t count = dump.texels.size() / format.texel_bytes;
  std::vector<float> values(count * channels);
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* texel = &dump.texels[i * format.texel_bytes];
    float scale = 1;
    for (const Component& component : format.used()) {
      if (component.kind != ComponentKind::exponent) continue;
      const auto exponent = load_component(texel, format.texel_bytes, component);
      scale = std::ldexp(1.0F, static_cast<int>(exponent) - 24);
    }
    for (std::size_t c = 0; c < channels; ++c) {
      const Component& component = format.components[c];
      const auto code = load_component(texel, format.texel_bytes, component);
      values[i * channels + c] = scale * value_of(component, code);
    }
  }
  return values;
}

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

double to_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// Brings the logarithmic mean of what is not black to middle grey.
double automatic_scale(const std::vector<float>& values, double gamma) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    const double luminance = 0.2126 * std::pow(values[i], gamma) +
                             0.7152 * std::pow(values[i + 1], gamma) +
                             0.0722 * std::pow(values[i + 2], gamma);
    if (!std::isfinite(luminance) || luminance <= 1e-9) continue;
    sum += std::log(luminance);
    ++count;
  }
  return count == 0 ? 1 : kMiddleGrey / std::exp(sum / static_cast<double>(count));
}

std::vector<std::uint8_t> colour_pixels(const Dump& dump, const PreviewOptions& options) {
  const std::vector<float> values = values_of(dump, 3);
  const bool codes = find_format(dump.info.desc.format)->components[0].kind == ComponentKind::unorm;
  const double gamma = options.gamma.value_or(codes ? kColourGamma : 1);
  const double scale =
      options.exposure ? std::exp2(*options.exposure) : automatic_scale(values, gamma);
  std::vector<std::uint8_t> pixels(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = scale * std::pow(std::max(0.0F, values[i]), gamma);
    const double mapped = std::isfinite(value) ? value / (1 + value) : 1;
    pixels[i] = to_byte(to_srgb(mapped));
  }
  return pixels;
}

std::vector<std::uint8_t> distance_pixels(const Dump& dump, const PreviewOptions& options) {
  const std::vector<float> values = values_of(dump, 1);
  float farthest = 0;
  for (const float value : values) {
    if (std::isfinite(value)) farthest = std::max(farthest, value);
  }
  const double white = options.max_distance.value_or(farthest > 0 ? farthest : 1);
  std::vector<std::uint8_t> pixels(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    pixels[i] = std::isnan(values[i]) ? 0 : to_byte(values[i] / white);
  }
  return pixels;
}

Exit preview(const PreviewOptions& options) {
  const Dump dump = load(options);
  const FormatInfo& format = *find_format(dump.info.desc.format);
  const bool colour = format.component_count >= 3;
  const Extent size = image_extent(dump.info.desc);
  write_png(options.output, size.width, size.height, colour ? 3 : 1,
            colour ? colour_pixels(dump, options) : distance_pixels(dump, options));
  return Exit::ok;
}

}  // namespace

void add_preview(Cli& cli) {
  auto options = std::make_shared<PreviewOptions>();
  CLI::App* command = cli.app.add_subcommand("preview", "Writes a PNG of a texture to look at");
  command->footer(kFooter);
  command->add_option("input", options->input, "A container or a dump")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "PNG to write; - for standard output")
      ->required()
      ->type_name("FILE");
  command->add_option("--frame", options->frame, "Frame of a container; default: the first")
      ->type_name("N");
  command->add_option("--texture", options->texture, "Texture of a container; default: the first")
      ->type_name("NAME");
  command->add_option("--exposure", options->exposure, "Colour: stops; default: automatic")
      ->type_name("EV");
  command
      ->add_option("--gamma", options->gamma,
                   "Colour: power that decodes it; default: 5 for integer codes, else 1")
      ->check(CLI::Range(0.1, 10.0))
      ->type_name("G");
  command->add_option("--max-distance", options->max_distance, "Distance that is white")
      ->check(CLI::PositiveNumber)
      ->type_name("D");
  add_geometry_flags(*command, options->geometry);
  command->callback([&cli, options] { cli.run = [options] { return preview(*options); }; });
}

}  // namespace gicodec::tools

// Determines the texture of an image: from attributes, hints, channels and size.
#include "dump/cure.h"
#include "dump/error.h"
#include "dump/geometry_attributes.h"
#include "dump/internal.h"
#include "dump/texture_file.h"

#include <gicodec/textures.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>

namespace gicodec::tools {
namespace {

/// Most records of a texture along an axis.
constexpr std::uint32_t kMaxRecordSide = kMaxGridSide * kMaxBlockSide;

class Resolver {
 public:
  Resolver(DumpInfo& info, const Hints& hints, const std::string& path)
      : info_(info), hints_(hints), path_(path) {}

  /// Returns the channels that are not the texture's.
  std::vector<FoundChannel> run(const FoundImage& found) {
    TextureDesc& desc = info_.desc;
    desc.record = hints_.desc ? hints_.desc->record : Record(format(found));
    std::vector<FoundChannel> others = set_channels(found);
    if (hints_.desc) {
      desc = *hints_.desc;
      require_agreement();
    } else if (is_map(found)) {
      desc = map(found);
    } else {
      set_probes(found.texels.x);
    }
    if (const Status status = validate(desc); status != Status::ok) {
      fail(Exit::bad_input, "{}: {}: grid {}, {}+{} texel blocks", path_,
           gicodec::to_string(status), to_string(desc.grid), desc.block.x, 2 * desc.guard_band);
    }
    check_size(found);
    return others;
  }

 private:
  const Attribute* attribute(std::string_view name, std::string_view type) {
    const Attribute* found = find_attribute(info_.attributes, name);
    if (found != nullptr && found->type != type) {
      fail(Exit::bad_input, "{}: attribute {} has type {}, expected {}", path_, name, found->type,
           type);
    }
    return found;
  }
  /// True if the texture is a map, false if it is of probes.
  bool is_map(const FoundImage& found) {
    if (hints_.grid) return false;
    if (hints_.block || hints_.extent) return true;
    if (find_attribute(info_.attributes, kGrid) != nullptr) return false;
    const bool probes = hints_.core || hints_.guard_band || hints_.tiling ||
                        find_attribute(info_.attributes, kCore) != nullptr ||
                        find_attribute(info_.attributes, kTiling) != nullptr;
    return found.channels.empty() || !probes;
  }

  void set_probes(std::uint32_t width) {
    TextureDesc& desc = info_.desc;
    desc.grid = grid();
    desc.layout = tiling();
    desc.guard_band = number(kBorder, hints_.guard_band, "--guard-band").value_or(1);
    const auto core = number(kCore, hints_.core, "--core");
    desc.block.x = core ? *core : core_from_size(width);
    desc.block.y = desc.block.x;
  }

  TextureDesc map(const FoundImage& found) {
    const Grid size =
        found.channels.empty() ? records_of(found.texels, info_.desc.record.format) : found.texels;
    const Grid records = sides(kExtent, hints_.extent, kMaxRecordSide, "--extent").value_or(size);
    const bool volume = found.channels.empty() ? found.volume : records.z > 1;
    const Grid block = sides(kBlock, hints_.block, kMaxBlockSide, "--block")
                           .value_or(volume ? Grid{4, 4, 4} : Grid{8, 8, 1});
    return map_texture(info_.desc.record, records,
                       {static_cast<std::uint8_t>(block.x), static_cast<std::uint8_t>(block.y),
                        static_cast<std::uint8_t>(block.z)});
  }

  void check_size(const FoundImage& found) {
    const TextureDesc& desc = info_.desc;
    const Extent size = extent(desc);
    if (found.channels.empty()) {
      const Grid records = records_of(found.texels, desc.record.format);
      if (size == Extent{records.x, records.y, records.z}) return;
      fail(Exit::bad_input, "{}: {} texels do not match {}", path_, to_string(found.texels),
           words());
    }
    const Grid& image = found.texels;
    if (size.width == image.x && size.height * size.slices == image.y) return;
    const std::uint32_t side = desc.block.x + 2U * desc.guard_band;
    if (is_probes(desc) && (image.x % side != 0 || image.y % side != 0)) {
      fail(Exit::bad_input, "{}: {}x{} texels is not a multiple of its {}x{} texel blocks", path_,
           image.x, image.y, side, side);
    }
    fail(Exit::bad_input, "{}: {}x{} texels does not match {}", path_, image.x, image.y, words());
  }
  /// "grid 4x2x3 with 10x10 texel blocks, tiling atlas_xy_z: that is 80x30 texels in 2 slices".
  [[nodiscard]] std::string words() const {
    const TextureDesc& desc = info_.desc;
    const Extent size = extent(desc);
    const unsigned band = 2U * desc.guard_band;
    return fmt::format("grid {} with {}x{}{} texel blocks, tiling {}: that is {}x{} texels{}",
                       to_string(desc.grid), desc.block.x + band, desc.block.y + band,
                       desc.block.z == 1 ? "" : fmt::format("x{}", desc.block.z),
                       gicodec::to_string(desc.layout.tiling), size.width, size.height,
                       size.slices == 1 ? "" : fmt::format(" in {} slices", size.slices));
  }

  /// Throws if attributes contradict the hints' texture, where that has an origin.
  void require_agreement() {
    if (hints_.agreed.empty()) return;
    Attributes own;
    describe(own, info_.desc);
    std::reverse(own.begin(), own.end());  // format, grid and extent matter more than blocks
    for (const Attribute& attribute : own) {
      const Attribute* stored = find_attribute(info_.attributes, attribute.name);
      if (stored == nullptr || same_meaning(*stored, attribute)) continue;
      fail(Exit::bad_input, "{}: says that {} is {}, but by {} it is {}; {}", path_, attribute.name,
           stored->value, hints_.agreed, attribute.value, to_cure(Cure::fix_layout));
    }
  }

  static bool fits_a_format(const FoundImage& found) {
    return std::ranges::any_of(formats(), [&](const FormatInfo& format) {
      const Grid size = records_of(found.texels, format.record.format);
      const std::uint64_t records = std::uint64_t{size.x} * size.y * size.z;
      return found.bytes == 0 || records * format.record.bytes == found.bytes;
    });
  }
  Format format(const FoundImage& found) {
    if (hints_.format) {
      return *hints_.format;
    }
    if (const Attribute* text = attribute(kFormat, "string")) {
      const FormatInfo* known = find_format(text->value);
      if (known == nullptr) {
        fail(Exit::bad_input, "{}: {} is \"{}\", which is no known format", path_, kFormat,
             text->value);
      }
      return known->record.format;
    }
    if (!found.channels.empty()) return format_from_channels(found.channels);
    if (found.format) return *found.format;
    fail(Exit::bad_input, "{}: its format, {}, is unknown; {}", path_, found.format_name,
         fits_a_format(found) ? to_cure(Cure::read_as_format)
                              : "write it in another, since no known format has as many bytes");
  }

  /// The format whose components the channels are, if they are R, G, B and A or some of them.
  Format format_from_channels(const std::vector<FoundChannel>& found) {
    std::string names;
    std::set<SampleType> types;
    for (const FoundChannel& channel : found) {
      std::string name = channel.name;
      if (!hints_.channels.empty()) {
        const auto mapped = std::ranges::find_if(
            hints_.channels, [&](const auto& item) { return item.second == channel.name; });
        if (mapped == hints_.channels.end()) continue;
        name = mapped->first;
      }
      names += name;
      types.insert(channel.type);
    }
    std::ranges::sort(names);
    const bool color = names == "BGR" || names == "ABGR";
    if (color && !hints_.plain) {
      info_.guessed = true;
      return Format::A2R10G10B10_UNORM_PACK32;
    }
    info_.fell_back = color;
    constexpr std::array<std::string_view, 4> kNames = {"R", "GR", "BGR", "ABGR"};
    const auto count = static_cast<std::size_t>(std::ranges::find(kNames, names) - kNames.begin());
    if (count < kNames.size() && types.size() == 1) {
      return floats_of(*types.begin())[count];
    }
    fail(Exit::bad_input,
         "{}: its channels {} do not determine a format; give --vk-format, and where the channels "
         "have other names than R, G, B, A, {}",
         path_, listed(found, &FoundChannel::name),
         to_cure(Cure::map_channels, mapping_for(found, "RGB")));
  }

  /// "--channels R=irr.R,G=irr.G", a suggestion from the file's channel names.
  static std::string mapping_for(const std::vector<FoundChannel>& found, std::string_view letters) {
    std::string text;
    for (const char wanted : letters) {
      const auto at = std::ranges::find_if(
          found, [&](const FoundChannel& channel) { return channel.name.ends_with(wanted); });
      text += fmt::format("{}{}={}", text.empty() ? "" : ",", wanted,
                          at == found.end() ? "NAME" : at->name);
    }
    return "--channels " + shell_word(text);
  }

  /// True if the file has a channel of exponents; else R, G and B are values.
  [[nodiscard]] bool has_exponent_channel(const std::vector<FoundChannel>& found) const {
    const auto mapped = hints_.channels.find('E');
    if (!hints_.channels.empty()) return mapped != hints_.channels.end();
    return std::ranges::find(found, "E", &FoundChannel::name) != found.end();
  }

  std::vector<FoundChannel> set_channels(const FoundImage& image) {
    if (image.channels.empty()) {
      info_.channels = default_channels(info_.desc.record.format);
      return {};
    }
    const std::vector<FoundChannel>& found = image.channels;
    const FormatInfo& format = *find_format(info_.desc.record.format);
    info_.channels.exponent = !has_exponent(format.record) || has_exponent_channel(found);
    std::vector<FoundChannel> others = found;
    for (std::size_t i = 0; i < format.record.count; ++i) {
      const Component& component = format.record.components[i];
      if (component.type == ComponentType::exponent && !info_.channels.exponent) continue;
      std::string wanted{letter(component)};
      if (!hints_.channels.empty()) {
        const auto mapped = hints_.channels.find(letter(component));
        wanted = mapped == hints_.channels.end() ? "" : mapped->second;
      }
      const auto at = std::ranges::find(others, wanted, &FoundChannel::name);
      if (at == others.end() && !hints_.channels.empty() && !wanted.empty()) {
        fail(Exit::bad_input, "{}: has no channel {} for {}; its channels are {}", path_, wanted,
             letter(component), listed(found, &FoundChannel::name));
      }
      if (at == others.end()) {
        if (letter(component) != 'A') {
          std::string letters;
          for (const Component& each : format.record.used()) {
            if (letter(each) != 'A' && has_channel(info_.channels, each)) letters += letter(each);
          }
          fail(Exit::bad_input, "{}: channel {} of {} is missing; its channels are {}; {}", path_,
               letter(component), format.name, listed(found, &FoundChannel::name),
               to_cure(Cure::map_channels, mapping_for(found, letters)));
        }
        info_.channels.alpha = false;
        continue;
      }
      if (!can_hold(info_.channels, at->type, component, format.record)) {
        fail(Exit::bad_input, "{}: channel {} is {}, which does not hold {}; {}", path_, at->name,
             to_string(at->type), format.name, to_cure(Cure::leave_format_out));
      }
      info_.channels.types[i] = at->type;
      info_.channels.names[i] = wanted == std::string{letter(component)} ? "" : wanted;
      others.erase(at);
    }
    for (const auto& [wanted, channel] : hints_.channels) {
      const auto is_wanted = [&, letter_wanted = wanted](const Component& each) {
        return letter(each) == letter_wanted;
      };
      if (std::ranges::none_of(format.record.used(), is_wanted)) {
        fail(Exit::usage, "{}: --channels names {}, which {} does not have", path_, wanted,
             format.name);
      }
    }
    return others;
  }

  Grid grid() {
    if (hints_.grid) {
      return *hints_.grid;
    }
    const Attribute* found = attribute(kGrid, "v3i");
    if (found == nullptr) {
      fail(Exit::bad_input, "{}: no attribute {}; {}", path_, kGrid, to_cure(Cure::grid_or_block));
    }
    std::string text = found->value;
    std::replace(text.begin(), text.end(), ' ', 'x');
    const auto grid = grid_from_string(text);
    if (!grid) fail(Exit::bad_input, "{}: {} is {}, which is no grid", path_, kGrid, found->value);
    return *grid;
  }

  /// Three numbers, 1..most each, from the hint or the attribute.
  std::optional<Grid> sides(std::string_view name, const std::optional<Grid>& hint,
                            std::uint32_t most, std::string_view flag) {
    if (hint) {
      return hint;
    }
    const Attribute* found = attribute(name, "v3i");
    if (found == nullptr) return std::nullopt;
    std::string text = found->value;
    std::replace(text.begin(), text.end(), ' ', 'x');
    const auto sides = grid_from_string(text);
    if (!sides || sides->x > most || sides->y > most || sides->z > most) {
      fail(Exit::bad_input, "{}: {} is {}, out of range; {}", path_, name, found->value,
           to_cure(Cure::give_flag, flag));
    }
    return sides;
  }

  Tiling tiling() {
    if (hints_.tiling) {
      return *hints_.tiling;
    }
    const Attribute* found = attribute(kTiling, "string");
    if (found == nullptr) return Tiling::atlas_xy_z;
    const auto tiling = tiling_from_string(found->value);
    if (!tiling) {
      fail(Exit::bad_input, "{}: {} is \"{}\", which is no known tiling", path_, kTiling,
           found->value);
    }
    return *tiling;
  }

  /// A number, clamped to 255, which no side of a block may be.
  std::optional<std::uint8_t> number(std::string_view name, std::optional<std::uint16_t> hint,
                                     std::string_view flag) {
    if (hint) {
      return static_cast<std::uint8_t>(std::min<std::uint16_t>(*hint, 255));
    }
    const Attribute* found = attribute(name, "int");
    if (found == nullptr) return std::nullopt;
    std::uint8_t value = 0;
    const char* const end = found->value.data() + found->value.size();
    const auto parsed = std::from_chars(found->value.data(), end, value);
    if (parsed.ec != std::errc{} || parsed.ptr != end || value > kMaxBlockSide) {
      fail(Exit::bad_input, "{}: {} is {}, out of range; {}", path_, name, found->value,
           to_cure(Cure::give_flag, flag));
    }
    return value;
  }

  /// "72 = 12·6 columns", by the axes that share them.
  [[nodiscard]] std::string columns_text(std::uint32_t columns) const {
    const Grid& grid = info_.desc.grid;
    const auto product = [&](std::uint32_t a, std::uint32_t b) {
      return fmt::format("{} = {}·{} columns", columns, a, b);
    };
    switch (info_.desc.layout.tiling) {
      case Tiling::atlas_xy_z:
        return product(grid.x, grid.y);
      case Tiling::atlas_xz_y:
        return product(grid.x, grid.z);
      case Tiling::atlas_yz_x:
        return product(grid.y, grid.z);
      default:
        return fmt::format("{} columns", columns);
    }
  }

  std::uint8_t core_from_size(std::uint32_t width) {
    TextureDesc unit = info_.desc;
    unit.block = {};
    unit.guard_band = 0;
    if (validate(unit) != Status::ok) return 0;
    const auto columns = static_cast<std::uint32_t>(extent(unit).width);
    const std::uint32_t side = width / columns;
    if (width % columns != 0 || side <= 2U * info_.desc.guard_band ||
        side - 2U * info_.desc.guard_band > kMaxBlockSide) {
      fail(Exit::bad_input, "{}: {} texels of width do not make the {} of tiling {}; {}", path_,
           width, columns_text(columns), to_string(unit.layout.tiling), to_cure(Cure::fix_columns));
    }
    return static_cast<std::uint8_t>(side - 2U * info_.desc.guard_band);
  }

  DumpInfo& info_;
  const Hints& hints_;
  const std::string& path_;
};

}  // namespace

std::array<Format, 4> floats_of(SampleType type) noexcept {
  switch (type) {
    case SampleType::half:
      return {Format::R16_SFLOAT, Format::R16G16_SFLOAT, Format::R16G16B16A16_SFLOAT,
              Format::R16G16B16A16_SFLOAT};
    case SampleType::float32:
      return {Format::R32_SFLOAT, Format::R32G32_SFLOAT, Format::R32G32B32_SFLOAT,
              Format::R32G32B32A32_SFLOAT};
    case SampleType::uint32:
      break;
  }
  return {Format::R32_UINT, Format::R32G32_UINT, Format::R32G32B32_UINT, Format::R32G32B32A32_UINT};
}

std::vector<FoundChannel> resolve(DumpInfo& info, const FoundImage& found, const Hints& hints,
                                  const std::string& path) {
  return Resolver(info, hints, path).run(found);
}

}  // namespace gicodec::tools

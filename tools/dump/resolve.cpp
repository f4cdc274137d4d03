// What texture an image holds: attributes, hints, and what follows from channels and size.
#include "dump/error.h"
#include "dump/internal.h"

#include <algorithm>
#include <charconv>

namespace gicodec::tools {
namespace {

constexpr std::string_view kGrid = "gicodec:grid";
constexpr std::string_view kCore = "gicodec:core";
constexpr std::string_view kBorder = "gicodec:border";
constexpr std::string_view kTiling = "gicodec:tiling";
constexpr std::string_view kFormat = "gicodec:vkFormat";

Attribute grid_attribute(const Grid& grid) {
  return {std::string(kGrid), "v3i", fmt::format("{} {} {}", grid.x, grid.y, grid.z)};
}
Attribute int_attribute(std::string_view name, std::uint16_t value) {
  return {std::string(name), "int", fmt::format("{}", value)};
}
Attribute tiling_attribute(Tiling tiling) {
  return {std::string(kTiling), "string", std::string(gicodec::to_string(tiling))};
}
Attribute format_attribute(Format format) {
  return {std::string(kFormat), "string", fmt::format("VK_FORMAT_{}", find_format(format)->name)};
}

class Resolver {
 public:
  Resolver(DumpInfo& info, const Hints& hints, const std::string& path)
      : info_(info), hints_(hints), path_(path) {}

  void run(const std::vector<FoundChannel>& found, std::uint32_t width, std::uint32_t height) {
    TextureDesc& desc = info_.desc;
    desc.record = format(found);
    set_channels(found);
    desc.grid = grid();
    desc.layout = tiling();
    desc.guard_band = number(kBorder, hints_.guard_band, "--guard-band").value_or(1);
    const auto core = number(kCore, hints_.core, "--core");
    desc.block.x = core ? *core : core_from_size(width);
    desc.block.y = desc.block.x;
    if (const Status status = validate(desc); status != Status::ok) {
      fail(Exit::bad_input, "{}: {}: grid {}, {}+{} texel blocks", path_,
           gicodec::to_string(status), to_string(desc.grid), desc.block.x, 2 * desc.guard_band);
    }
    const Extent size = extent(desc);
    const std::uint64_t full_height = std::uint64_t{size.height} * size.slices;
    if (size.width == width && full_height == height) return;
    const std::uint32_t side = desc.block.x + 2U * desc.guard_band;
    if (width % side != 0 || height % side != 0) {
      fail(Exit::bad_input, "{}: {}x{} texels is not a multiple of its {}x{} texel blocks", path_,
           width, height, side, side);
    }
    fail(Exit::bad_input,
         "{}: {}x{} texels does not match grid {} with {}x{} texel blocks, tiling "
         "{}: that is {}x{} texels",
         path_, width, height, to_string(desc.grid), side, side,
         gicodec::to_string(desc.layout.tiling), size.width, full_height);
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
  /// A hint corrects the attribute, so that what is written later agrees with its texels.
  void correct(Attribute attribute) {
    if (find_attribute(info_.attributes, attribute.name) != nullptr) {
      set_attribute(info_.attributes, std::move(attribute));
    }
  }

  Format format(const std::vector<FoundChannel>& found) {
    if (hints_.format) {
      const Attribute* text = find_attribute(info_.attributes, kFormat);
      const FormatInfo* known = text == nullptr ? nullptr : find_format(text->value);
      if (known == nullptr || known->record.format != *hints_.format) {
        correct(format_attribute(*hints_.format));
      }
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
    return format_from_channels(found);
  }

  Format format_from_channels(const std::vector<FoundChannel>& found) {
    std::string names;
    bool all_half = true, all_float = true;
    for (const FoundChannel& channel : found) {
      std::string name = channel.name;
      if (!hints_.channels.empty()) {
        const auto mapped = std::find_if(hints_.channels.begin(), hints_.channels.end(),
                                         [&](auto& item) { return item.second == channel.name; });
        if (mapped == hints_.channels.end()) continue;
        name = mapped->first;
      }
      names += name;
      all_half &= channel.type == SampleType::half;
      all_float &= channel.type == SampleType::float32;
    }
    std::sort(names.begin(), names.end());
    if (names == "R" && all_half) return Format::R16_SFLOAT;
    if (names == "R" && all_float) return Format::R32_SFLOAT;
    if (names == "GR" && all_half) return Format::R16G16_SFLOAT;
    if (names == "GR" && all_float) return Format::R32G32_SFLOAT;
    if (names == "BGR" || names == "ABGR") return Format::A2R10G10B10_UNORM_PACK32;
    fail(Exit::bad_input,
         "{}: no attribute {}, and its channels {} do not tell the format; use --vk-format, and "
         "where the channels have other names than R, G, B, A, {}",
         path_, kFormat, list(found), mapping_for(found, names == "GR" ? "RG" : "RGB"));
  }

  static std::string list(const std::vector<FoundChannel>& found) {
    std::string names;
    for (const FoundChannel& channel : found) {
      names += (names.empty() ? "" : ", ") + channel.name;
    }
    return names;
  }
  /// "--channels R=irr.R,G=irr.G", as far as the names tell.
  static std::string mapping_for(const std::vector<FoundChannel>& found, std::string_view letters) {
    std::string text;
    for (const char wanted : letters) {
      const auto at = std::find_if(found.begin(), found.end(), [&](const FoundChannel& channel) {
        return channel.name.ends_with(wanted);
      });
      text += fmt::format("{}{}={}", text.empty() ? "--channels " : ",", wanted,
                          at == found.end() ? "NAME" : at->name);
    }
    return text;
  }

  void set_channels(const std::vector<FoundChannel>& found) {
    const FormatInfo& format = *find_format(info_.desc.record.format);
    std::vector<FoundChannel> unused = found;
    for (std::size_t i = 0; i < format.record.count; ++i) {
      const Component& component = format.record.components[i];
      std::string wanted{letter(component)};
      if (!hints_.channels.empty()) {
        const auto mapped = hints_.channels.find(letter(component));
        wanted = mapped == hints_.channels.end() ? "" : mapped->second;
      }
      const auto at = std::find_if(unused.begin(), unused.end(), [&](const FoundChannel& channel) {
        return channel.name == wanted;
      });
      if (at == unused.end() && !hints_.channels.empty() && !wanted.empty()) {
        fail(Exit::bad_input, "{}: has no channel {} for {}; its channels are {}", path_, wanted,
             letter(component), list(found));
      }
      if (at == unused.end()) {
        if (letter(component) != 'A') {
          std::string letters;
          for (const Component& each : format.record.used()) {
            if (letter(each) != 'A') letters += letter(each);
          }
          fail(Exit::bad_input, "{}: channel {} of {} is missing; its channels are {}: use {}",
               path_, letter(component), format.name, list(found), mapping_for(found, letters));
        }
        info_.channels.alpha = false;
        continue;
      }
      if (!can_hold(at->type, component, format.record)) {
        fail(Exit::bad_input, "{}: channel {} is {}, which does not hold {}", path_, at->name,
             to_string(at->type), format.name);
      }
      info_.channels.types[i] = at->type;
      info_.channels.names[i] = wanted == std::string{letter(component)} ? "" : wanted;
      unused.erase(at);
    }
    if (!hints_.channels.empty()) {
      for (const auto& mapping : hints_.channels) {
        const char wanted = mapping.first;
        if (std::none_of(format.record.used().begin(), format.record.used().end(),
                         [&](const Component& each) { return letter(each) == wanted; })) {
          fail(Exit::usage, "{}: --channels names {}, which {} does not have", path_, wanted,
               format.name);
        }
      }
      for (const FoundChannel& channel : unused) info_.unused.push_back(channel.name);
      return;
    }
    if (!unused.empty()) {
      fail(Exit::bad_input,
           "{}: channel {} does not belong to {}; --channels R=NAME,... picks those to keep", path_,
           unused.front().name, format.name);
    }
  }

  Grid grid() {
    if (hints_.grid) {
      correct(grid_attribute(*hints_.grid));
      return *hints_.grid;
    }
    const Attribute* found = attribute(kGrid, "v3i");
    if (found == nullptr) {
      fail(Exit::bad_input, "{}: no attribute {}; use --grid", path_, kGrid);
    }
    std::string text = found->value;
    std::replace(text.begin(), text.end(), ' ', 'x');
    const auto grid = grid_from_string(text);
    if (!grid) fail(Exit::bad_input, "{}: {} is {}, which is no grid", path_, kGrid, found->value);
    return *grid;
  }

  Tiling tiling() {
    if (hints_.tiling) {
      correct(tiling_attribute(*hints_.tiling));
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

  /// At most 255, which no side of a block may be.
  std::optional<std::uint8_t> number(std::string_view name, std::optional<std::uint16_t> hint,
                                     std::string_view flag) {
    if (hint) {
      correct(int_attribute(name, *hint));
      return static_cast<std::uint8_t>(std::min<std::uint16_t>(*hint, 255));
    }
    const Attribute* found = attribute(name, "int");
    if (found == nullptr) return std::nullopt;
    std::uint8_t value = 0;
    const char* const end = found->value.data() + found->value.size();
    if (std::from_chars(found->value.data(), end, value).ptr != end || value > kMaxBlockSide) {
      fail(Exit::bad_input, "{}: {} is {}, out of range; use {}", path_, name, found->value, flag);
    }
    return value;
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
      fail(Exit::bad_input,
           "{}: {} texels of width do not make {} blocks; check --grid, --tiling "
           "and --core",
           path_, width, columns);
    }
    return static_cast<std::uint8_t>(side - 2U * info_.desc.guard_band);
  }

  DumpInfo& info_;
  const Hints& hints_;
  const std::string& path_;
};

}  // namespace

void describe(Attributes& attributes, const TextureDesc& desc) {
  set_attribute(attributes, grid_attribute(desc.grid));
  set_attribute(attributes, int_attribute(kCore, desc.block.x));
  set_attribute(attributes, int_attribute(kBorder, desc.guard_band));
  set_attribute(attributes, tiling_attribute(desc.layout.tiling));
  set_attribute(attributes, format_attribute(desc.record.format));
}

void resolve(DumpInfo& info, const std::vector<FoundChannel>& found, std::uint32_t width,
             std::uint32_t height, const Hints& hints, const std::string& path) {
  Resolver(info, hints, path).run(found, width, height);
}

}  // namespace gicodec::tools

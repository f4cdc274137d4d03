#include "dump/exr_images.h"

#include "dump/error.h"
#include "dump/geometry_attributes.h"
#include "dump/text.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>
#include <utility>

namespace gicodec::tools {
namespace {

/// Channels that make an image, each with its component's letter.
struct Group {
  std::string layer;   ///< "diffuse" of "diffuse.R"
  std::string single;  ///< the channel's own name, unless it is R, G, B and A
  std::map<char, ExrChannel> channels;
  [[nodiscard]] const ExrChannel& first() const { return channels.begin()->second; }
};

std::string layer_of(const std::string& name) {
  const std::size_t point = name.rfind('.');
  return point == std::string::npos ? "" : name.substr(0, point);
}

std::string own_name(const std::string& name) { return name.substr(name.rfind('.') + 1); }

bool alike_size(const ExrChannel& a, const ExrChannel& b) {
  return a.x_sampling == b.x_sampling && a.y_sampling == b.y_sampling;
}

bool alike(const ExrChannel& a, const ExrChannel& b) {
  return a.type == b.type && alike_size(a, b);
}

/// Takes the channels of these names, of one type and sampling, out of a layer.
Group take(std::map<std::string, ExrChannel>& layer, std::string_view names, std::size_t least) {
  constexpr std::string_view kLetters = "RGBA";
  Group group;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = layer.find(std::string(1, names[i]));
    if (at == layer.end() || (i > 0 && !alike(at->second, group.first()))) {
      if (i < 3) break;  // A follows three colours.
      continue;
    }
    group.channels.emplace(kLetters[i], at->second);
    // std::map orders by letter, and A comes before B: first() is of any of them.
  }
  if (group.channels.size() < least) return {};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (group.channels.contains(kLetters[i])) layer.erase(std::string(1, names[i]));
  }
  return group;
}

/// The images that a part's channels make, those without a layer first.
std::vector<Group> groups_of(const std::vector<ExrChannel>& channels) {
  std::map<std::string, std::map<std::string, ExrChannel>> layers;
  for (const ExrChannel& channel : channels) {
    layers[layer_of(channel.name)].emplace(own_name(channel.name), channel);
  }
  std::vector<Group> groups;
  for (auto& [layer, members] : layers) {
    const auto add = [&, name = layer](Group group, std::string single) {
      group.layer = name;
      group.single = std::move(single);
      if (!group.channels.empty()) groups.push_back(std::move(group));
    };
    for (const char* const colors : {"RGBA", "rgba"}) add(take(members, colors, 1), "");
    add(take(members, "XYZ", 3), "XYZ");
    for (const auto& [name, channel] : members) {
      Group group;
      group.channels.emplace('R', channel);
      add(std::move(group), name);
    }
  }
  return groups;
}

/// Width and height of a channel's samples at a level.
Grid samples_of(const ExrPart& part, const ExrChannel& channel, std::uint32_t level) {
  const Grid size = part.level_size(level);
  const auto side = [](std::int64_t first, std::uint32_t count, std::uint32_t step) {
    return static_cast<std::uint32_t>(exr_samples(first, first + count - 1, step));
  };
  return {side(part.x, size.x, channel.x_sampling), side(part.y, size.y, channel.y_sampling), 1};
}

class Images {
 public:
  Images(const std::vector<ExrPart>& parts, const Hints& hints, const std::string& path)
      : parts_(parts), hints_(hints), path_(path) {}

  std::vector<ExrImage> all() {
    for (std::uint32_t part = 0; part < parts_.size(); ++part) add_part(part);
    name_all();
    return std::move(images_);
  }

  /// The image of the hints.
  ExrImage one() {
    const ImagePlace& place = *hints_.place;
    if (place.part >= parts_.size() || place.level >= parts_[place.part].levels) {
      fail(Exit::bad_input, "{}: has no image {}: another file took its place?", path_,
           hints_.image.empty() ? "0" : hints_.image);
    }
    std::vector<FoundChannel> wanted;
    const ExrChannel* first = nullptr;
    for (const ExrChannel& channel : parts_[place.part].channels) {
      const std::string name = text_of_name(channel.name);
      const bool own = std::ranges::any_of(
          hints_.channels, [&](const auto& mapping) { return mapping.second == name; });
      if (!own) continue;
      wanted.push_back({name, channel.type});
      if (first == nullptr) first = &channel;
    }
    if (first == nullptr) {
      fail(Exit::bad_input, "{}: has no channels of image {}: another file took its place?", path_,
           hints_.image);
    }
    head_ = hints_.head;
    ExrImage image = start(place.part, place.level, *first);
    (void)resolve(image.info, found(place.part, place.level, *first, wanted), hints_, path_);
    image.info.image = hints_.image;
    // Whether others are kept beside it only their own images say.
    for (const ExrChannel& channel : parts_[place.part].channels) {
      const std::string name = text_of_name(channel.name);
      if (!image.info.head || std::ranges::find(wanted, name, &FoundChannel::name) != wanted.end())
        continue;
      image.info.lost.push_back(fmt::format("channel {}", name));
    }
    return image;
  }

 private:
  ExrImage start(std::uint32_t part, std::uint32_t level, const ExrChannel& channel) {
    ExrImage image;
    image.info.place = {part, level, 0};
    image.info.head = std::exchange(head_, false);
    if (image.info.head) read_attributes(parts_[part], parts_.size() > 1, image.info);
    image.x_sampling = channel.x_sampling;
    image.y_sampling = channel.y_sampling;
    if (channel.x_sampling != 1 || channel.y_sampling != 1) {
      set_attribute(
          image.info.attributes,
          {kExrSampling, "v2i", fmt::format("{} {}", channel.x_sampling, channel.y_sampling)});
    }
    return image;
  }

  FoundImage found(std::uint32_t part, std::uint32_t level, const ExrChannel& channel,
                   std::vector<FoundChannel> channels) const {
    FoundImage found;
    found.texels = samples_of(parts_[part], channel, level);
    found.channels = std::move(channels);
    return found;
  }

  void add_part(std::uint32_t part) {
    head_ = true;
    std::vector<ExrChannel> left = parts_[part].channels;
    if (part == 0) left = add_chosen(std::move(left));
    for (std::uint32_t level = 0; level < parts_[part].levels; ++level) {
      for (const Group& group : groups_of(left)) add_group(part, level, group);
    }
  }

  /// Adds the image that attributes or hints describe, if any; returns the other channels.
  std::vector<ExrChannel> add_chosen(std::vector<ExrChannel> channels) {
    const bool described = std::ranges::any_of(
        parts_[0].attributes, [](const auto& attribute) { return attribute.name == kFormat; });
    if (!described && !hints_.desc && !hints_.format && hints_.channels.empty()) return channels;
    // Of one size; those of another are images of their own.
    const auto first = std::ranges::find_if(channels, [&](const ExrChannel& channel) {
      return channel.x_sampling == 1 && channel.y_sampling == 1;
    });
    if (first == channels.end()) return channels;
    std::vector<FoundChannel> all;
    for (const ExrChannel& channel : channels) {
      if (alike_size(channel, *first)) all.push_back({text_of_name(channel.name), channel.type});
    }
    std::vector<FoundChannel> left;
    for (std::uint32_t level = 0; level < parts_[0].levels; ++level) {
      ExrImage image = start(0, level, *first);
      left =
          resolve(image.info, found(0, level, *first, all), level == 0 ? hints_ : smaller(), path_);
      chosen_ = image.info.desc.record.format;
      images_.push_back(std::move(image));
      labels_.emplace_back();
    }
    const auto is_taken = [&](const ExrChannel& channel) {
      const std::string name = text_of_name(channel.name);
      return alike_size(channel, *first) &&
             std::ranges::find(left, name, &FoundChannel::name) == left.end();
    };
    std::erase_if(channels, is_taken);
    if (hints_.channels.empty()) return channels;
    for (const ExrChannel& channel : channels) {
      images_.front().info.lost.push_back(fmt::format("channel {}", text_of_name(channel.name)));
    }
    return {};
  }
  /// Hints for a level below the first.
  [[nodiscard]] Hints smaller() const {
    Hints own;
    own.format = chosen_;
    own.channels = hints_.channels;
    own.block = hints_.block;
    return own;
  }

  void add_group(std::uint32_t part, std::uint32_t level, const Group& group) {
    const ExrChannel& first = group.first();
    ExrImage image = start(part, level, first);
    Hints own;
    own.plain = hints_.plain;
    own.block = hints_.block;
    std::vector<FoundChannel> channels;
    for (const auto& [letter, channel] : group.channels) {
      const std::string name = text_of_name(channel.name);
      channels.push_back({name, channel.type});
      own.channels[letter] = name;
    }
    // Images of the first one's size are laid out as that is.
    const bool main = part == 0 && level == 0 && alike_size(first, ExrChannel{});
    if (main) {
      own.grid = hints_.grid;
      own.core = hints_.core;
      own.guard_band = hints_.guard_band;
      own.tiling = hints_.tiling;
      own.extent = hints_.extent;
    }
    const Attributes kept = image.info.attributes;
    if (main && !images_.empty()) image.info.attributes = images_.front().info.attributes;
    std::erase_if(image.info.attributes,
                  [](const Attribute& attribute) { return attribute.name == kFormat; });
    if (!main) image.info.attributes.clear();
    (void)resolve(image.info, found(part, level, first, channels), own, path_);
    image.info.attributes = kept;
    images_.push_back(std::move(image));
    labels_.push_back({group.layer, group.single});
  }

  /// Names images by part, layer and channel, as far as there are several.
  void name_all() {
    std::set<std::string> taken;
    for (std::size_t i = 0; i < images_.size(); ++i) {
      DumpInfo& info = images_[i].info;
      const ExrPart& part = parts_[info.place.part];
      std::vector<std::string> words;
      if (parts_.size() > 1) {
        words.push_back(part.name.empty() ? fmt::format("part{}", info.place.part) : part.name);
      }
      const auto& [layer, single] = labels_[i];
      if (!layer.empty()) words.push_back(layer);
      if (!single.empty() && images_.size() > part.levels) words.push_back(single);
      if (info.place.level > 0) words.push_back(fmt::format("mip{}", info.place.level));
      std::string name;
      for (const std::string& word : words) {
        if (!name.empty()) name += '.';
        name += text_of_name(word);
      }
      const std::string first = name;
      for (int again = 2; !taken.insert(name).second; ++again) {
        name = fmt::format("{}#{}", first, again);
      }
      info.image = std::move(name);
    }
  }

  struct Label {
    std::string layer, single;
  };
  const std::vector<ExrPart>& parts_;
  const Hints& hints_;
  const std::string& path_;
  bool head_ = true;
  Format chosen_ = Format::UNDEFINED;
  std::vector<ExrImage> images_;
  std::vector<Label> labels_;  ///< by image
};

}  // namespace

std::vector<ExrImage> images_of(const std::vector<ExrPart>& parts, const Hints& hints,
                                const std::string& path) {
  Images images(parts, hints, path);
  if (!hints.place) return images.all();
  std::vector<ExrImage> one;
  one.push_back(images.one());
  return one;
}

}  // namespace gicodec::tools

#include "difference.h"

#include "dump/block_place.h"

#include <gicodec/error_bound.h>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gicodec::tools {
namespace {

/// Maps float patterns to integers in the order of values; −0 is just before +0.
std::int64_t ordered(const Component& component, std::uint32_t code) {
  const std::uint32_t sign = 1U << (component.bits - 1);
  if (component.type == ComponentType::snorm) return std::int64_t{code ^ sign};
  if (component.type != ComponentType::sfloat) return code;
  return (code & sign) == 0 ? std::int64_t{code} : -1 - std::int64_t{code ^ sign};
}

class Comparison {
 public:
  Comparison(const TextureDesc& desc, std::span<const std::byte> left,
             std::span<const std::byte> right, float max_error)
      : desc_(desc),
        record_(desc.record),
        size_(extent(desc)),
        left_(left),
        right_(right),
        max_error_(max_error) {
    for (const Component& component : record_.used()) {
      result_.channels.push_back({std::string(component.name())});
    }
  }

  Difference run(const ProbeSet& skip) {
    for (std::uint32_t block = 0; block < block_count(desc_); ++block) {
      if (skip.contains(block)) continue;
      const BlockPlace place = block_place(desc_, size_, block);
      ++result_.total_probes;
      result_.total_texels += std::uint64_t{place.width} * place.rows * place.slices;
      compare_block(place);
    }
    if (result_.first) result_.first->place = locate(desc_, first_x_, first_y_);
    set_psnr();
    return std::move(result_);
  }

 private:
  void compare_block(const BlockPlace& place) {
    const std::uint64_t before = result_.texels;
    for (std::uint32_t slice = 0; slice < place.slices; ++slice) {
      for (std::uint32_t y = 0; y < place.rows; ++y) {
        const std::size_t row = place.row(y, slice);
        if (std::memcmp(&left_[row], &right_[row], place.row_bytes) == 0) continue;
        for (std::uint32_t x = 0; x < place.width; ++x) {
          compare_texel(row + std::size_t{x} * record_.bytes,
                        static_cast<std::uint32_t>(place.x + x),
                        static_cast<std::uint32_t>(place.y + slice * size_.height + y));
        }
      }
    }
    result_.probes += result_.texels != before;
  }

  void compare_texel(std::size_t at, std::uint32_t x, std::uint32_t y) {
    if (std::memcmp(&left_[at], &right_[at], record_.bytes) == 0) return;
    ++result_.texels;
    const std::size_t size = record_.bytes;
    const bool beyond = max_error_ == 0 || !within_error(record_, left_.subspan(at, size),
                                                         right_.subspan(at, size), max_error_);
    const bool earlier = !result_.first || y < first_y_ || (y == first_y_ && x < first_x_);
    const bool noted = beyond == (result_.beyond > 0) ? !earlier : !beyond;
    bool found = false, found_beyond = false;
    if (beyond) ++result_.beyond;
    for (std::size_t i = 0; i < record_.count; ++i) {
      const Component& component = record_.components[i];
      const std::uint32_t left = load_component(&left_[at], record_.bytes, component);
      const std::uint32_t right = load_component(&right_[at], record_.bytes, component);
      if (left == right) continue;
      const auto distance = static_cast<std::uint64_t>(
          std::abs(ordered(component, left) - ordered(component, right)));
      ChannelDifference& channel = result_.channels[i];
      ++channel.texels;
      channel.max_distance = std::max(channel.max_distance, distance);
      if (component.type == ComponentType::unorm) {
        channel.squared += static_cast<double>(distance) * static_cast<double>(distance);
      }
      // Notes the first channel beyond the bound, rather than one before it that only differs.
      if (noted || found_beyond) continue;
      found_beyond = distance > error_units(component, max_error_);
      if (found && !found_beyond) continue;
      found = true;
      first_x_ = x;
      first_y_ = y;
      result_.first = FirstDifference{{}, component, left, right};
    }
  }

  void set_psnr() {
    if (result_.same()) return;
    double squared = 0;
    std::uint64_t samples = 0;
    for (std::size_t i = 0; i < record_.count; ++i) {
      const Component& component = record_.components[i];
      if (component.type != ComponentType::unorm) return;
      if (letter(component) == 'A') continue;
      const double peak = max_code(component);
      squared += result_.channels[i].squared / (peak * peak);
      samples += result_.total_texels;
    }
    if (squared > 0) result_.psnr = -10 * std::log10(squared / static_cast<double>(samples));
  }

  const TextureDesc& desc_;
  const Record& record_;
  Extent size_;
  std::span<const std::byte> left_, right_;
  float max_error_;
  Difference result_;
  std::uint32_t first_x_ = 0, first_y_ = 0;
};

bool says_how_it_is_stored(const std::string& name) {
  return name == "compression" || name == "lineOrder" || name == "dwaCompressionLevel";
}

std::string value_text(const Record& record, const Component& component, std::uint32_t code) {
  if (component.type != ComponentType::sfloat && component.type != ComponentType::unorm) {
    return fmt::format("{}", code);
  }
  const auto type = component.bits == 32 ? SampleType::float32 : SampleType::half;
  if (component.type == ComponentType::sfloat) {
    return fmt::format("{} (0x{:0{}X})", sample_text(type, code), code, component.bits / 4);
  }
  return can_hold(SampleType::half, component, record)
             ? fmt::format("{} of {}", code, max_code(component))
             : fmt::format("{}", code);
}

}  // namespace

Difference compare_texels(const TextureDesc& desc, std::span<const std::byte> left,
                          std::span<const std::byte> right, const ProbeSet& skip, float max_error) {
  return Comparison(desc, left, right, max_error).run(skip);
}

std::vector<std::string> compare_headers(const DumpInfo& left, const DumpInfo& right) {
  std::vector<std::string> lines;
  const auto text = [](const DumpInfo& info) {
    return to_string(info.channels, info.desc.record.format);
  };
  if (text(left) != text(right)) {
    lines.push_back(fmt::format("channels: {} against {}", text(left), text(right)));
  }
  const auto describe = [](const Attribute* attribute) {
    return attribute == nullptr ? std::string("none")
                                : fmt::format("{} {}", attribute->type, attribute->value);
  };
  Attributes names = left.attributes;
  for (const Attribute& attribute : right.attributes) set_attribute(names, attribute);
  for (const Attribute& attribute : names) {
    if (says_how_it_is_stored(attribute.name)) continue;
    const std::string in_left = describe(find_attribute(left.attributes, attribute.name));
    const std::string in_right = describe(find_attribute(right.attributes, attribute.name));
    if (in_left == in_right) continue;
    lines.push_back(fmt::format("attribute {}: {} against {}", attribute.name, in_left, in_right));
  }
  return lines;
}

std::string to_string(const FirstDifference& first, const Record& record) {
  return fmt::format("{}, channel {}: {} against {}", to_string(first.place),
                     first.component.name(), value_text(record, first.component, first.left),
                     value_text(record, first.component, first.right));
}

nlohmann::ordered_json to_json(const Difference& difference, const Record& record) {
  nlohmann::ordered_json json = {
      {"identical", difference.same()},
      {"probes", {{"compared", difference.total_probes}, {"different", difference.probes}}},
      {"texels", {{"compared", difference.total_texels}, {"different", difference.texels}}},
  };
  for (const ChannelDifference& channel : difference.channels) {
    json["channels"].push_back({{"name", channel.name},
                                {"different", channel.texels},
                                {"max_distance", channel.max_distance}});
  }
  if (difference.first) {
    const FirstDifference& first = *difference.first;
    json["first"] = {
        {"x", first.place.x},
        {"y", first.place.y},
        {"probe", first.place.probe},
        {"position", {first.place.position.x, first.place.position.y, first.place.position.z}},
        {"block_x", first.place.block_x},
        {"block_y", first.place.block_y},
        {"channel", std::string(first.component.name())},
        {"left", first.left},
        {"right", first.right}};
    json["text"] = to_string(first, record);
  }
  if (difference.psnr) json["psnr_db"] = *difference.psnr;
  return json;
}

}  // namespace gicodec::tools

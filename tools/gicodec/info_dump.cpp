#include "info_dump.h"

#include "common/cli.h"
#include "common/volume_words.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace gicodec::tools {
namespace {

std::string command_for(const std::string& path, const GeometryFlags& flags) {
  const auto named = [](const std::string& name) {
    return shell_word(name.starts_with('-') ? "./" + name : name);
  };
  const std::string stem = path_text(native_path(path).stem());
  return fmt::format("gicodec encode -o {} {}{}", named(stem + ".gic"), named(path),
                     flags_text(flags));
}

/// Bytes of a value, also where it is told in hexadecimal digits.
std::size_t bytes_of(const std::string& value) {
  return value.starts_with("0x") ? value.size() / 2 - 1 : value.size();
}

/// A number of a compression as its name.
std::string value_text(const Attribute& attribute) {
  for (std::size_t i = 0; i < kExrCompressions.size(); ++i) {
    const bool is = attribute.type == "compression" && attribute.value == fmt::format("0x0{}", i);
    if (is) return kExrCompressions[i];
  }
  return attribute.value;
}

}  // namespace

bool is_dump(const std::string& path) {
  return path != "-" && !is_container_file(path) && native_path(path).has_extension() &&
         image_kind(path).has_value();
}

void print_dump(const std::string& path, const GeometryFlags& flags, bool json) {
  const auto sequences = group_sequences({path});
  check_names(flags, sequences);
  const Hints hints = settle_formats({&path, 1}, hints_for(flags, sequences.front().name));
  const std::vector<DumpInfo> images = read_dump_infos(path, hints);
  if (json) {
    nlohmann::ordered_json all = {{"dump", path}, {"images", nlohmann::ordered_json::array()}};
    for (const DumpInfo& image : images) {
      const Extent size = extent(image.desc);
      nlohmann::ordered_json one = {{"name", image.image},
                                    {"format", record_text(image.desc.record)},
                                    {"records", {size.width, size.height, size.slices}},
                                    {"blocks", blocks_text(image.desc)}};
      for (const Attribute& attribute : image.attributes) {
        one["attributes"][attribute.name] = attribute.value;
      }
      one["not_kept"] = image.lost;
      all["images"].push_back(std::move(one));
    }
    all["command"] = command_for(path, flags);
    print_json(all);
    return;
  }
  print("{}: {} image{}\n", path, images.size(), images.size() == 1 ? "" : "s");
  for (const DumpInfo& image : images) {
    const Extent size = extent(image.desc);
    print("  {}: {}, {}x{}{}, {}\n", image_words(image), record_text(image.desc.record), size.width,
          size.height, size.slices == 1 ? "" : fmt::format(" in {} slices", size.slices),
          blocks_text(image.desc));
    for (const std::string& what : image.lost) print("    not kept: {}\n", what);
    for (const Attribute& attribute : image.attributes) {
      constexpr std::size_t kShown = 60;
      const std::string value = value_text(attribute);
      print("    {}: {}{}\n", attribute.name, value.substr(0, kShown),
            value.size() > kShown ? fmt::format("... ({} bytes)", bytes_of(value)) : "");
    }
  }
  print("to pack it: {}\n", command_for(path, flags));
}

}  // namespace gicodec::tools

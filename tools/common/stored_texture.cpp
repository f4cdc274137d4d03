#include "stored_texture.h"

#include "dump/error.h"
#include "dump/text.h"
#include "file_names.h"
#include "volume_words.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <system_error>

namespace gicodec::tools {
namespace {

constexpr unsigned kMaxDigits = 18;
/// Behind "base": digits count the sign.
constexpr std::string_view kSign = " sign";

std::string attribute_text(const Attribute& attribute) {
  return attribute.type.empty() ? "" : attribute.type + " " + attribute.value;
}

Attribute attribute_from(std::string name, const std::string& text) {
  const std::size_t blank = text.find(' ');
  if (blank == std::string::npos) return {std::move(name), text, ""};
  return {std::move(name), text.substr(0, blank), text.substr(blank + 1)};
}

/// Reads the metadata "channel:R".
void read_channel_name(StoredTexture& texture, const std::string& key, const std::string& name,
                       const std::string& path) {
  constexpr std::size_t kMaxName = 255;
  ChannelLayout& channels = texture.info.channels;
  const Record& record = texture.info.desc.record;
  bool known = false;
  for (std::size_t i = 0; i < record.count; ++i) {
    if (key != fmt::format("channel:{}", record.components[i].name())) continue;
    channels.names[i] = name;
    known = true;
  }
  if (!known || name.empty() || name.size() > kMaxName || name.find('\0') != std::string::npos) {
    fail(Exit::bad_input, "{}: metadata {} is damaged", path, key);
  }
}

void require_unique_channels(const StoredTexture& texture, const std::string& path) {
  const Record& record = texture.info.desc.record;
  std::set<std::string> names;
  for (std::size_t i = 0; i < record.count; ++i) {
    if (!has_channel(texture.info.channels, record.components[i])) continue;
    if (!names.insert(channel_name(texture.info.channels, record.format, i)).second) {
      fail(Exit::bad_input, "{}: two channels have the same name", path);
    }
  }
}

template <typename T>
void read_number(std::string_view text, T& number, const std::string& key,
                 const std::string& path) {
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  if (parsed.ec != std::errc{} || parsed.ptr != end) {
    fail(Exit::bad_input, "{}: metadata {} is damaged", path, key);
  }
}

/// Reads "attribute:NAME", and "attribute@FRAME:NAME" into texture.changes.
void read_attribute(StoredTexture& texture, Attributes& attributes, const std::string& key,
                    const std::string& value, const std::string& path) {
  const std::size_t colon = key.find(':');
  const std::string name = colon == std::string::npos ? "" : key.substr(colon + 1);
  if (name.empty()) fail(Exit::bad_input, "{}: metadata {} is damaged", path, key);
  if (key.starts_with("attribute:")) {
    attributes.push_back(attribute_from(name, value));
    return;
  }
  std::uint64_t frame = 0;
  constexpr std::size_t kFrame = std::string_view("attribute@").size();
  read_number(std::string_view(key).substr(kFrame, colon - kFrame), frame, key, path);
  texture.changes.push_back({frame, attribute_from(name, value)});
}

/// Reads "slots" and "padding", the parts of the file's layout besides its tiling.
void read_layout(TextureDesc& desc, const std::string& key, const std::string& value,
                 const std::string& path) {
  if (key == "slots") {
    desc.layout.slots = grid_from_string(value).value_or(Grid{});
  } else {
    const std::size_t blank = std::min(value.find(' '), value.size());
    read_number(std::string_view(value).substr(0, blank), desc.layout.pad_before, key, path);
    read_number(std::string_view(value).substr(std::min(blank + 1, value.size())),
                desc.layout.pad_after, key, path);
  }
  if (desc.layout == Layout(desc.layout.tiling) || validate(desc) != Status::ok) {
    fail(Exit::bad_input, "{}: metadata {} is damaged", path, key);
  }
}

/// Reads "image": part, level and face, and "-" if another image has the file's attributes.
void read_place(DumpInfo& info, std::string_view value, const std::string& path) {
  info.head = !value.ends_with(" -");
  if (!info.head) value.remove_suffix(2);
  for (std::uint32_t* number : {&info.place.part, &info.place.level, &info.place.face}) {
    const std::size_t blank = std::min(value.find(' '), value.size());
    read_number(value.substr(0, blank), *number, "image", path);
    value.remove_prefix(std::min(blank + 1, value.size()));
  }
  if (!value.empty()) fail(Exit::bad_input, "{}: metadata image is damaged", path);
}

/// Replaces attributes that follow from the texture by those read, which have unique names. Sorts
/// them at once: inserting one by one takes quadratic time.
void settle_attributes(StoredTexture& texture, Attributes read, const std::string& path) {
  std::ranges::sort(read, {}, &Attribute::name);
  for (Attribute& implied : texture.info.attributes) {
    if (find_attribute(read, implied.name) == nullptr) set_attribute(read, std::move(implied));
  }
  texture.info.attributes = std::move(read);
  std::ranges::stable_sort(texture.changes, {}, &FrameAttribute::frame);
  std::size_t most = texture.info.attributes.size(), of_frame = 0;
  for (std::size_t i = 0; i < texture.changes.size(); ++i) {
    const bool same = i > 0 && texture.changes[i].frame == texture.changes[i - 1].frame;
    of_frame = same ? of_frame + 1 : 1;
    most = std::max(most, of_frame);
  }
  if (most > kMaxAttributes) {
    fail(Exit::bad_input, "{}: metadata has more than {} attributes of one file", path,
         kMaxAttributes);
  }
}

bool is_known(std::string_view key) {
  constexpr std::array<std::string_view, 14> kKeys = {
      "digits", "base",    "file",       "image",   "extension", "separator", "channels",
      "slots",  "padding", "file bytes", "encoder", "dropped",   "lossy",     "inactive"};
  return key.starts_with("attribute:") || key.starts_with("attribute@") ||
         key.starts_with("channel:") || std::ranges::find(kKeys, key) != kKeys.end();
}

}  // namespace

DumpInfo StoredTexture::info_at(std::uint64_t frame) const {
  DumpInfo at = info;
  if (times) set_attribute(at.attributes, time_attribute(times->at(frame)));
  for (auto it = std::ranges::lower_bound(changes, frame, {}, &FrameAttribute::frame);
       it != changes.end() && it->frame == frame; ++it) {
    const FrameAttribute& change = *it;
    if (!change.attribute.type.empty()) {
      set_attribute(at.attributes, change.attribute);
    } else {
      std::erase_if(at.attributes, [&](const Attribute& attribute) {
        return attribute.name == change.attribute.name;
      });
    }
  }
  return at;
}

DumpInfo StoredTexture::decoded_info(std::uint64_t frame) const {
  DumpInfo at = info_at(frame);
  if (!lossy.empty()) set_attribute(at.attributes, {kLossyAttribute, "string", lossy});
  return at;
}

std::string StoredTexture::file_name(std::uint64_t frame) const {
  return names.of(file_stem(*this), frame);
}

std::string StoredTexture::lacks() const {
  if (!lossy.empty()) return fmt::format("bits that were lost ({})", lossy);
  if (!inactive.empty()) return fmt::format("{} inactive probes", inactive.size());
  return dropped;
}

std::string StoredTexture::loss() const {
  if (lossy.empty()) return "";
  return fmt::format("texture {} was coded LOSSY ({})", name, lossy);
}

bool of_one_file(const StoredTexture& a, const StoredTexture& b) {
  return a.made_of_files && b.made_of_files && a.file == b.file && a.names == b.names;
}

TextureEntry to_entry(const StoredTexture& texture) {
  TextureEntry entry{texture.name, texture.info.desc, 0, texture.largest_error, {}};
  Metadata& metadata = entry.metadata;
  metadata.emplace_back("digits", fmt::format("{}", texture.names.digits));
  if (texture.file != texture.name) metadata.emplace_back("file", texture.file);
  const ImagePlace& place = texture.info.place;
  if (place != ImagePlace{} || !texture.info.head) {
    metadata.emplace_back("image", fmt::format("{} {} {}{}", place.part, place.level, place.face,
                                               texture.info.head ? "" : " -"));
  }
  metadata.emplace_back("extension", texture.names.extension);
  if (texture.names.separator != ".") metadata.emplace_back("separator", texture.names.separator);
  if (texture.names.base != 0) {
    metadata.emplace_back(
        "base", fmt::format("{}{}", texture.names.base, texture.names.counts_sign ? kSign : ""));
  }
  const Record& record = texture.info.desc.record;
  const Layout& layout = texture.info.desc.layout;
  metadata.emplace_back("channels", to_string(texture.info.channels, record.format));
  if (layout.slots != Grid{}) metadata.emplace_back("slots", to_string(layout.slots));
  if (layout.pad_before != 0 || layout.pad_after != 0) {
    metadata.emplace_back("padding", fmt::format("{} {}", layout.pad_before, layout.pad_after));
  }
  for (std::size_t i = 0; i < record.count; ++i) {
    if (texture.info.channels.names[i].empty()) continue;
    metadata.emplace_back(fmt::format("channel:{}", record.components[i].name()),
                          texture.info.channels.names[i]);
  }
  if (texture.file_bytes > 0) {
    metadata.emplace_back("file bytes", fmt::format("{}", texture.file_bytes));
  }
  if (!texture.encoder.empty()) metadata.emplace_back("encoder", texture.encoder);
  if (!texture.dropped.empty()) metadata.emplace_back("dropped", texture.dropped);
  if (!texture.lossy.empty()) metadata.emplace_back("lossy", texture.lossy);
  if (!texture.inactive.empty()) {
    metadata.emplace_back("inactive", texture.inactive.text());
  }
  for (const Attribute& attribute : texture.info.attributes) {
    metadata.emplace_back("attribute:" + attribute.name, attribute_text(attribute));
  }
  for (const FrameAttribute& change : texture.changes) {
    metadata.emplace_back(fmt::format("attribute@{}:{}", change.frame, change.attribute.name),
                          attribute_text(change.attribute));
  }
  return entry;
}

Metadata take_beside(Metadata& metadata, std::size_t most) {
  const auto stays = [&](const auto& pair) {
    const auto& [key, value] = pair;
    if (key.starts_with("attribute@")) return false;
    const bool may_go = key.starts_with("attribute:") || key == "inactive" || key == "dropped";
    return !may_go || value.size() <= most;
  };
  const auto first = std::stable_partition(metadata.begin(), metadata.end(), stays);
  Metadata beside(std::make_move_iterator(first), std::make_move_iterator(metadata.end()));
  metadata.erase(first, metadata.end());
  return beside;
}

bool is_file_name(const std::string& name) {
  return !name.empty() && name.front() != '.' && name.find('/') == std::string::npos &&
         printable(name) == name;
}

StoredTexture from_entry(const TextureEntry& entry, const std::string& path) {
  StoredTexture texture;
  texture.name = texture.file = entry.name;
  const std::string where = fmt::format("{}: texture {}", path, entry.name);
  TextureDesc desc = entry.desc;
  desc.layout = entry.desc.layout.tiling;
  texture.info = make_info(desc);
  texture.largest_error = entry.largest_error;
  if (const std::string* channels = find_metadata(entry.metadata, "channels")) {
    const auto parsed = channels_from_string(*channels, desc.record.format);
    if (!parsed) fail(Exit::bad_input, "{}: metadata channels is damaged", where);
    texture.info.channels = *parsed;
    texture.info.attributes.clear();
    texture.made_of_files = true;
  }
  Attributes attributes;
  std::set<std::string_view> seen;
  for (const auto& [key, value] : entry.metadata) {
    if (!is_known(key)) continue;
    if (!seen.insert(key).second) {
      fail(Exit::bad_input, "{}: metadata {} stands twice", where, key);
    }
    if (key.starts_with("attribute:") || key.starts_with("attribute@")) {
      read_attribute(texture, attributes, key, value, where);
    } else if (key == "digits") {
      read_number(value, texture.names.digits, key, where);
      if (texture.names.digits > kMaxDigits) {
        fail(Exit::bad_input, "{}: metadata digits is damaged", where);
      }
    } else if (key == "base") {
      texture.names.counts_sign = value.ends_with(kSign);
      const std::string_view text(value);
      read_number(text.substr(0, text.size() - (texture.names.counts_sign ? kSign.size() : 0)),
                  texture.names.base, key, where);
      constexpr std::int64_t kLeast = -1'000'000'000'000'000'000;
      if (texture.names.base > 0 || texture.names.base < kLeast) {
        fail(Exit::bad_input, "{}: metadata base is damaged", where);
      }
    } else if (key == "file") {
      texture.file = value;
    } else if (key == "image") {
      read_place(texture.info, value, where);
    } else if (key == "extension") {
      const bool is_kind = is_file_name(value) && value.find('.') == std::string::npos &&
                           image_kind("x." + value).has_value();
      if (!value.empty() && !is_kind) {
        fail(Exit::bad_input, "{}: metadata extension is damaged", where);
      }
      texture.names.extension = value;
    } else if (key == "separator") {
      if (!is_separator(value)) fail(Exit::bad_input, "{}: metadata separator is damaged", where);
      texture.names.separator = value;
    } else if (key == "slots" || key == "padding") {
      read_layout(texture.info.desc, key, value, where);
    } else if (key.starts_with("channel:")) {
      read_channel_name(texture, key, value, where);
    } else if (key == "file bytes") {
      read_number(value, texture.file_bytes, key, where);
    } else if (key == "encoder") {
      texture.encoder = value;
    } else if (key == "dropped") {
      texture.dropped = value;
    } else if (key == "lossy") {
      texture.lossy = value;
    } else if (key == "inactive") {
      texture.inactive = ProbeSet(value, where);
      if (!texture.inactive.empty() && texture.inactive.last() >= block_count(desc)) {
        fail(Exit::bad_input, "{}: metadata inactive names probe {}, out of range", where,
             texture.inactive.last());
      }
    }
  }
  const std::string error = error_text(entry.largest_error);
  if (texture.lossy.empty()) {
    texture.lossy = error;
  } else if (!std::isinf(entry.largest_error) && texture.lossy.find(error) == std::string::npos) {
    texture.lossy += ", " + error;
  }
  if (texture.name.starts_with(texture.file + ".")) {
    texture.info.image = texture.name.substr(texture.file.size() + 1);
  } else if (texture.name != texture.file) {
    fail(Exit::bad_input, "{}: metadata file is of another texture", where);
  }
  settle_attributes(texture, std::move(attributes), where);
  require_unique_channels(texture, where);
  return texture;
}

}  // namespace gicodec::tools

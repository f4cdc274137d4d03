#include "dump/error.h"
#include "dump/exr_memory.h"
#include "dump/internal.h"
#include "dump/texture_file.h"

#include <OpenEXR/ImfAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOpaqueAttribute.h>
#include <OpenEXR/ImfVersion.h>
#include <gicodec/container.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <memory>
#include <set>
#include <stdexcept>

namespace gicodec::tools {
namespace {

// Attributes that size and channels imply; OpenEXR writes them itself.
constexpr std::array<std::string_view, 2> kImplied = {"channels", "dataWindow"};
// Those of files with several parts, and "name", which must be a text there.
constexpr std::array<std::string_view, 2> kImpliedOfParts = {"type", "chunkCount"};
// Those that OpenEXR reads as being of a type of its own; of another type the file is damaged.
struct Typed {
  std::string_view name, type;
};
constexpr std::array<Typed, 11> kTyped{{{"compression", "compression"},
                                        {"lineOrder", "lineOrder"},
                                        {"displayWindow", "box2i"},
                                        {"pixelAspectRatio", "float"},
                                        {"screenWindowCenter", "v2f"},
                                        {"screenWindowWidth", "float"},
                                        {"tiles", "tiledesc"},
                                        {"name", "string"},
                                        {"type", "string"},
                                        {"chunkCount", "int"},
                                        {"dwaCompressionLevel", "float"}}};

// OpenEXR writes "type" as one of these.
constexpr std::array<std::string_view, 2> kPartTypes = {"scanlineimage", "tiledimage"};

constexpr std::size_t kMaxName = 255;

template <typename Range>
bool contains(const Range& range, std::string_view text) {
  return std::find(range.begin(), range.end(), text) != range.end();
}

/// The text form of a type's bytes.
struct Shape {
  char kind = 'x';  ///< s: string, i: int32, f: float32, x: hexadecimal
  std::size_t count = 0;
};

Shape shape_of(std::string_view type) {
  if (type == "string") return {'s', 0};
  if (type == "int") return {'i', 1};
  if (type == "v2i") return {'i', 2};
  if (type == "v3i") return {'i', 3};
  if (type == "float") return {'f', 1};
  if (type == "v2f") return {'f', 2};
  if (type == "v3f") return {'f', 3};
  return {};
}

class MemoryOut final : public Imf::OStream {
 public:
  MemoryOut() : OStream("attribute") {}
  void write(const char bytes[], int size) override { bytes_.append(bytes, size); }
  std::uint64_t tellp() override { return bytes_.size(); }
  void seekp(std::uint64_t) override {}
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string bytes_of(const Imf::Attribute& value) {
  MemoryOut out;
  value.writeValueTo(out, Imf::EXR_VERSION);
  return out.bytes();
}

std::uint32_t word_at(std::string_view bytes, std::size_t index) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + 4 * index, 4);
  return word;
}

// Values with NaNs stay hexadecimal, since decimal text would lose the payload.
std::string to_text(std::string_view type, std::string_view bytes) {
  const Shape shape = shape_of(type);
  // Containers hold only UTF-8.
  if (shape.kind == 's') {
    return is_utf8(bytes) && !bytes.starts_with("0x") ? std::string(bytes) : "0x" + to_hex(bytes);
  }
  if (shape.kind == 'x' || bytes.size() != 4 * shape.count) return "0x" + to_hex(bytes);
  std::string text;
  for (std::size_t i = 0; i < shape.count; ++i) {
    const std::uint32_t word = word_at(bytes, i);
    if (i > 0) text += ' ';
    if (shape.kind == 'i') {
      text += fmt::format("{}", static_cast<std::int32_t>(word));
    } else if (std::isfinite(std::bit_cast<float>(word))) {
      text += fmt::format("{}", std::bit_cast<float>(word));
    } else {
      return "0x" + to_hex(bytes);
    }
  }
  return text;
}

std::string from_text(std::string_view type, std::string_view text) {
  const Shape shape = shape_of(type);
  std::string bytes;
  if (text.starts_with("0x")) {
    if (!from_hex(text.substr(2), bytes)) throw std::invalid_argument("no hexadecimal digits");
    return bytes;
  }
  if (shape.kind == 's') return std::string(text);
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < shape.count; ++i) {
    if (i > 0 && (at == end || *at++ != ' ')) throw std::invalid_argument("a number is missing");
    std::uint32_t word = 0;
    std::from_chars_result parsed{};
    if (shape.kind == 'i') {
      std::int32_t value = 0;
      parsed = std::from_chars(at, end, value);
      word = static_cast<std::uint32_t>(value);
    } else {
      float value = 0;
      parsed = std::from_chars(at, end, value);
      word = std::bit_cast<std::uint32_t>(value);
    }
    if (parsed.ec != std::errc{}) throw std::invalid_argument("not a number");
    at = parsed.ptr;
    bytes.append(reinterpret_cast<const char*>(&word), 4);
  }
  if (at != end || shape.count == 0) throw std::invalid_argument("not a value of this type");
  return bytes;
}

}  // namespace

std::string to_hex(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const char byte : bytes) {
    text += kDigits[static_cast<unsigned char>(byte) >> 4];
    text += kDigits[static_cast<unsigned char>(byte) & 15];
  }
  return text;
}

bool from_hex(std::string_view text, std::string& bytes) {
  bytes.clear();
  for (std::size_t i = 0; i < text.size(); i += 2) {
    unsigned byte = 0;
    const auto pair = text.substr(i, 2);
    const auto* const end = pair.data() + pair.size();
    if (pair.size() != 2 || std::from_chars(pair.data(), end, byte, 16).ptr != end) return false;
    bytes += static_cast<char>(byte);
  }
  return true;
}

const Attribute* find_attribute(const Attributes& attributes, std::string_view name) noexcept {
  const auto found =
      std::find_if(attributes.begin(), attributes.end(),
                   [&](const Attribute& attribute) { return attribute.name == name; });
  return found == attributes.end() ? nullptr : &*found;
}

std::optional<std::vector<float>> find_floats(const Attributes& attributes, std::string_view name,
                                              std::size_t count) {
  const Attribute* attribute = find_attribute(attributes, name);
  if (attribute == nullptr) return std::nullopt;
  std::vector<float> values;
  const char* at = attribute->value.data();
  const char* const end = at + attribute->value.size();
  while (values.size() < count) {
    if (!values.empty() && (at == end || *at++ != ' ')) return std::nullopt;
    float value = 0;
    const auto parsed = std::from_chars(at, end, value);
    if (parsed.ec != std::errc{} || !std::isfinite(value)) return std::nullopt;
    values.push_back(value);
    at = parsed.ptr;
  }
  if (at != end) return std::nullopt;
  return values;
}

void set_attribute(Attributes& attributes, Attribute attribute) {
  const auto at = std::lower_bound(
      attributes.begin(), attributes.end(), attribute.name,
      [](const Attribute& left, const std::string& name) { return left.name < name; });
  if (at != attributes.end() && at->name == attribute.name) {
    *at = std::move(attribute);
  } else {
    attributes.insert(at, std::move(attribute));
  }
}

std::string text_of_name(std::string_view name) {
  if (is_utf8(name) && !name.starts_with("0x")) return std::string(name);
  return fmt::format("0x{}", to_hex(name));
}

std::string name_of_text(const std::string& text) {
  std::string bytes;
  return text.starts_with("0x") && from_hex(text.substr(2), bytes) ? bytes : text;
}

bool exr_has_attribute(const Attribute& attribute) {
  // OpenEXR would cut a longer name, or one that contains NUL.
  const std::string name = name_of_text(attribute.name), type = name_of_text(attribute.type);
  const auto* const typed = std::ranges::find(kTyped, name, &Typed::name);
  return !contains(kImplied, name) && (typed == kTyped.end() || typed->type == type) &&
         !name.empty() && name.size() <= kMaxName && name.find('\0') == std::string::npos &&
         !type.empty() && type.size() <= kMaxName && type.find('\0') == std::string::npos;
}

/// An attribute's object: what OpenEXR asks for is of its type, all else only carries bytes, which
/// it would otherwise read and write as others.
static std::unique_ptr<Imf::Attribute> object_of(const std::string& name, const std::string& type) {
  if (std::ranges::find(kTyped, name, &Typed::name) != kTyped.end()) {
    return std::unique_ptr<Imf::Attribute>(Imf::Attribute::newAttribute(type.c_str()));
  }
  return std::make_unique<Imf::OpaqueAttribute>(type.c_str());
}

void set_attributes(Imf::Header& header, const Attributes& attributes, const std::string& path) {
  for (const Attribute& attribute : attributes) {
    if (is_head_field(attribute.name)) continue;
    try {
      if (!exr_has_attribute(attribute)) throw std::invalid_argument("unknown name or type");
      const std::string type = name_of_text(attribute.type);
      const std::string bytes = from_text(type, attribute.value);
      if (!is_sound_exr_value(type, bytes)) {
        throw std::invalid_argument("not a value of this type");
      }
      const std::string name = name_of_text(attribute.name);
      const std::unique_ptr<Imf::Attribute> value = object_of(name, type);
      MemoryIn in(bytes);
      value->readValueFrom(in, static_cast<int>(bytes.size()), Imf::EXR_VERSION);
      if (!in.at_end()) throw std::invalid_argument("more bytes than the type has");
      header.insert(name, *value);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      fail(Exit::bad_input, "{}: attribute {} of type {} cannot be written: {}", path,
           attribute.name, attribute.type, error.what());
    }
  }
}

/// False for what OpenEXR does not write: a name that it knows with a value of another type.
static bool is_writable(const Attribute& attribute) {
  try {
    require_exr_attributes({attribute}, "");
    return attribute.name != "type" || contains(kPartTypes, attribute.value);
  } catch (const Error&) {
    return false;
  }
}

void require_exr_attributes(const Attributes& attributes, const std::string& path) {
  Imf::Header header;
  set_attributes(header, attributes, path);
}

void read_attributes(const ExrPart& part, bool several, DumpInfo& info) {
  const Imf::Header usual(static_cast<int>(part.width), static_cast<int>(part.height));
  std::set<std::string_view> seen;
  for (const ExrAttribute& attribute : part.attributes) {
    const std::string& name = attribute.name;
    if (contains(kImplied, name) || (several && contains(kImpliedOfParts, name))) continue;
    if (!seen.insert(name).second || is_head_field(name)) {
      info.lost.push_back(fmt::format("{}attribute {}", is_head_field(name) ? "" : "a second ",
                                      text_of_name(name)));
      continue;
    }
    if (name == "compression" && attribute.bytes.size() == 1 && attribute.bytes[0] > 4) {
      info.lost.emplace_back("its compression, which loses bits (ZIP comes back)");
    }
    // Attributes with the value of a default header follow.
    const auto same = usual.find(name);
    if (same != usual.end() && same.attribute().typeName() == attribute.type &&
        bytes_of(same.attribute()) == attribute.bytes) {
      continue;
    }
    const std::string& type = attribute.type;
    Attribute kept{text_of_name(name),
                   type.find(' ') == std::string::npos ? text_of_name(type) : "0x" + to_hex(type),
                   to_text(attribute.type, attribute.bytes)};
    if (is_writable(kept)) {
      set_attribute(info.attributes, std::move(kept));
    } else {
      info.lost.push_back("attribute " + kept.name);
    }
  }
  if (part.x != 0 || part.y != 0) {
    set_attribute(info.attributes, {kExrOrigin, "v2i", fmt::format("{} {}", part.x, part.y)});
  }
  std::string linear;
  for (const ExrChannel& channel : part.channels) {
    if (!channel.linear) continue;
    if (!linear.empty()) linear += '\n';
    linear += text_of_name(channel.name);
  }
  if (!linear.empty()) set_attribute(info.attributes, {kExrLinear, "string", linear});
}

}  // namespace gicodec::tools

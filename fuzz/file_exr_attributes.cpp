// Attributes of EXR headers as text and back: what OpenEXR takes comes back as the same text.
#include "foreign_file.h"

#include "dump/internal.h"

#include <OpenEXR/ImfHeader.h>

#include <array>

namespace {

using namespace gicodec;
using namespace gicodec::tools;

constexpr std::array<const char*, 26> kTypes = {
    "box2f",  "box2i",        "chromaticities", "compression", "double",    "envmap", "float",
    "int",    "keycode",      "lineOrder",      "m33d",        "m33f",      "m44d",   "m44f",
    "string", "stringvector", "timecode",       "v2d",         "v2f",       "v2i",    "v3d",
    "v3f",    "v3i",          "rational",       "preview",     "idmanifest"};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  Attributes attributes;
  while (!input.empty()) {
    const char* type = kTypes[input.below(kTypes.size())];
    const auto text = [&] {
      const auto bytes = input.bytes(input.u16() % 1024);
      return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    const bool hexadecimal = input.below(2) == 0;
    std::string name = text(), value = text();
    if (hexadecimal) {
      std::string digits = "0x";
      for (const char byte : value) {
        digits += fmt::format("{:02x}", static_cast<unsigned char>(byte));
      }
      value = digits;
    }
    set_attribute(attributes, {std::move(name), type, std::move(value)});
  }
  fuzz::check_cost("attributes cost what they are worth", [&]() -> fuzz::Allowance {
    fuzz::accepted([&] {
      Imf::Header header(16, 16);
      set_attributes(header, attributes, "x");
      DumpInfo first, second;
      read_attributes(header, first);
      Imf::Header again(16, 16);
      set_attributes(again, first.attributes, "x");
      read_attributes(again, second);
      fuzz::check(first.attributes == second.attributes && first.dropped.empty(),
                  "attributes come back as the same text");
      for (const Attribute& attribute : attributes) {
        fuzz::check(find_attribute(first.attributes, attribute.name) != nullptr,
                    "every attribute is kept");
      }
    });
    return {(std::size_t{128} << 10) + 256 * size, (std::size_t{512} << 10) + 1024 * size};
  });
  return 0;
}

// Attributes of EXR headers as text and back: what OpenEXR takes comes back as the same bytes, and
// all else is named.
#include "foreign_file.h"

#include "dump/internal.h"

#include "dump/texture_file.h"

#include <OpenEXR/ImfAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>

namespace {

using namespace gicodec;
using namespace gicodec::tools;

constexpr std::array<const char*, 29> kTypes = {
    "box2f",  "box2i",        "chromaticities", "compression", "double",      "envmap",   "float",
    "int",    "keycode",      "lineOrder",      "m33d",        "m33f",        "m44d",     "m44f",
    "string", "stringvector", "timecode",       "v2d",         "v2f",         "v2i",      "v3d",
    "v3f",    "v3i",          "rational",       "preview",     "floatvector", "tiledesc", "chlist",
    "\xF6wn"};

/// Collects what an attribute is written as.
class Bytes final : public Imf::OStream {
 public:
  Bytes() : OStream("x") {}
  void write(const char bytes[], int size) override { all.append(bytes, size); }
  std::uint64_t tellp() override { return all.size(); }
  void seekp(std::uint64_t) override {}
  std::string all;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  ExrPart part;
  part.width = part.height = 16;
  while (!input.empty()) {
    const char* type = kTypes[input.below(kTypes.size())];
    const auto text = [&] {
      const auto bytes = input.bytes(input.u16() % 1024);
      return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    std::string name = text();
    part.attributes.push_back({std::move(name), type, text()});
  }
  fuzz::check_cost("attributes cost what they are worth", [&]() -> fuzz::Allowance {
    fuzz::accepted([&] {
      DumpInfo info;
      read_attributes(part, false, info);
      Imf::Header header(16, 16);
      set_attributes(header, info.attributes, "x");
      std::set<std::string> seen;
      for (const ExrAttribute& attribute : part.attributes) {
        const bool implied = attribute.name == "channels" || attribute.name == "dataWindow";
        const std::string lost = "attribute " + text_of_name(attribute.name);
        const bool named = std::ranges::find(info.lost, lost) != info.lost.end();
        if (implied || named || is_head_field(attribute.name) ||
            !seen.insert(attribute.name).second) {
          continue;
        }
        const auto at = header.find(attribute.name);
        fuzz::check(at != header.end() && at.attribute().typeName() == attribute.type,
                    "every attribute is kept");
        Bytes bytes;
        at.attribute().writeValueTo(bytes, Imf::EXR_VERSION);
        fuzz::check(bytes.all == attribute.bytes, "attributes come back as the same bytes");
      }
    });
    return {(std::size_t{128} << 10) + 256 * size, (std::size_t{512} << 10) + 1024 * size};
  });
  return 0;
}

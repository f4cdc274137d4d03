// EXR files, from their first byte on: refused, or a dump that is written and read as the same,
// but for a compression that loses bits.
#include "foreign_file.h"

#include "dump/dump.h"

namespace {

using namespace gicodec;
using namespace gicodec::tools;

/// What a file may claim whatever its size (internal.h), with room for samples, texels and lines.
constexpr std::size_t kClaim = std::size_t{64} << 20;

/// Of a file written from that one: 0 to 4 (none, RLE, ZIPS, ZIP, PIZ) stay; ZIP, which replaces
/// the rest, is what a file has that says nothing.
Attributes attributes_written(Attributes attributes) {
  std::erase_if(attributes, [](const Attribute& attribute) {
    return attribute.name == "compression" && attribute.value > "0x04";
  });
  return attributes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  const fuzz::MemoryFile file(bytes);
  fuzz::check_cost("an EXR file costs what it is worth", [&]() -> fuzz::Allowance {
    bool whole = false;
    std::size_t texels = 0;
    fuzz::accepted([&] {
      const std::vector<Dump> images = read_dumps(file.path());
      for (const Dump& image : images) {
        texels += image.texels.size();
        fuzz::check(image.texels.size() == texture_bytes(image.info.desc), "every texel is there");
      }
      if (texels > std::size_t{1} << 20) return;  // Writing it takes too long.
      const auto written = to_exr(images, "x");
      const fuzz::MemoryFile copy(written);
      const std::vector<Dump> again = read_dumps(copy.path());
      fuzz::check(again.size() == images.size(), "every image is written");
      for (std::size_t i = 0; i < images.size(); ++i) {
        const DumpInfo& info = images[i].info;
        fuzz::check(again[i].texels == images[i].texels &&
                        again[i].info.channels == info.channels &&
                        again[i].info.image == info.image && again[i].info.place == info.place &&
                        again[i].info.attributes == attributes_written(info.attributes),
                    "what was read is written and read as the same");
      }
      whole = true;
    });
    const std::size_t result = whole ? 16 * texels + (std::size_t{16} << 20) : 6 * kClaim;
    return {result + 256 * size, 4 * result + 4096 * size};
  });
  return 0;
}

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
      const Dump dump = read_dump(file.path());
      texels = dump.texels.size();
      fuzz::check(texels == texture_bytes(dump.info.desc), "every texel is there");
      if (texels > std::size_t{1} << 20) return;  // Writing it takes too long.
      const auto written = to_exr(dump.info, dump.texels, "x");
      const fuzz::MemoryFile copy(written);
      const Dump again = read_dump(copy.path());
      fuzz::check(again.texels == dump.texels && again.info.channels == dump.info.channels &&
                      again.info.attributes == attributes_written(dump.info.attributes),
                  "what was read is written and read as the same");
      whole = true;
    });
    const std::size_t result = whole ? 16 * texels + (std::size_t{16} << 20) : 6 * kClaim;
    return {result + 256 * size, 4 * result + 4096 * size};
  });
  return 0;
}

// DDS and KTX2 files and sidecars of raw ones, from their first byte on: refused, or taken, written
// and read as the same.
#include "foreign_file.h"

#include "tools/texture_file_inverse.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  using namespace gicodec::tools;
  fuzz::Input input(data, size);
  const auto choice = input.below(3);
  const auto rest = input.rest();
  fuzz::check_cost("a texture file costs what it is worth", [&]() -> fuzz::Allowance {
    fuzz::accepted([&] {
      const std::string text(reinterpret_cast<const char*>(rest.data()), rest.size());
      const std::string fault = choice == 2
                                    ? sidecar_fault(text)
                                    : texture_file_fault<fuzz::MemoryFile>(
                                          rest, choice == 0 ? ImageKind::dds : ImageKind::ktx2);
      fuzz::check(fault.empty(), fault.c_str());
    });
    return {(std::size_t{256} << 10) + 256 * size, (std::size_t{1} << 20) + 4096 * size};
  });
  return 0;
}

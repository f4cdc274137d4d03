// glTF files: refused, or a scene of finite triangles that costs what its bytes are worth.
#include "foreign_file.h"

#include "ddgi/gltf.h"

#include <cmath>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  const fuzz::MemoryFile file(std::span(reinterpret_cast<const std::byte*>(data), size));
  fuzz::check_cost("a glTF file costs what it is worth", [&]() -> fuzz::Allowance {
    std::size_t triangles = 0;
    fuzz::accepted([&] {
      const ddgi::Scene scene = ddgi::load_gltf(file.path());
      triangles = scene.triangle_count();
      fuzz::check(triangles > 0, "there is something to draw");
      fuzz::check(std::isfinite(length(scene.bounds().size())), "it has a size");
      for (const double time : {0.0, 0.5, 1e9}) {
        const ddgi::FrameState state = scene.state_at(time);
        fuzz::check(state.transforms.size() == scene.objects.size(), "every object has a place");
        (void)scene.camera_at(time);
      }
    });
    // Images take up to 16 bytes per texel, of which 2^22 are free; rays look for volume and
    // camera.
    constexpr std::size_t kFree = std::size_t{160} << 20;
    return {kFree + 20000 * size + 1024 * triangles, 2 * kFree + 100000 * size + 8192 * triangles};
  });
  return 0;
}

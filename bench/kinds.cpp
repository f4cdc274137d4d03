// Kinds beside their peers, a command for each: the tables of their pages.
#include "kind_bench.h"

#include "common/program.h"

#include <array>

int main(int argc, char** argv) {
  using namespace gicodec;
  constexpr std::array kKinds{
      bench::KindBench{"ao_points", "Beside the paper's coding, and AO in screen space",
                       bench::add_ao_points},
      bench::KindBench{"irradiance_maps", "Beside zstd, HEVC and H.264",
                       bench::add_irradiance_maps},
      bench::KindBench{"irradiance_vectors", "Beside zstd, in bundles and whole",
                       bench::add_irradiance_vectors},
      bench::KindBench{"photons", "Beside zstd and meshoptimizer", bench::add_photons},
      bench::KindBench{"voxels", "Beside zstd and OpenVDB", bench::add_voxels}};
  tools::Command app{"Measures kinds: bytes beside their peers, and pictures.", "kinds"};
  bench::Measurement chosen;
  app.require_command();
  for (const bench::KindBench& kind : kKinds) {
    kind.add(*app.add_command(kind.name, kind.summary), chosen);
  }
  return tools::run_program(app, argc, argv, [&] { return chosen(); });
}

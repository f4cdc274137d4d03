#include "common/cli.h"

#include <gicodec/version.h>

namespace {

constexpr const char* kFooter =
    "See gicodec COMMAND --help.\n\n"
    "Exit codes:\n"
    "  0  success\n"
    "  1  verify or compare found a difference\n"
    "  2  the command line makes no sense\n"
    "  3  a file is damaged, truncated or not what the command needs\n"
    "  4  a file cannot be opened, read or written\n"
    "  5  a backend failed or memory ran out\n"
    "Interrupted, it removes what is not finished and ends by the signal: 130, 143.\n"
    "\n"
    "Examples:\n"
    "  gicodec encode -o villa.gic dumps/villa/*.exr\n"
    "  gicodec info villa.gic\n"
    "  gicodec verify villa.gic dumps/villa/*.exr\n"
    "  gicodec decode villa.gic -o out/ && gicodec compare dumps/villa out\n"
    "  gicodec preview villa.gic --frame 3 -o atlas.png\n"
    "  gicodec view villa.gic";

}  // namespace

int main(int argc, char** argv) {
  using namespace gicodec::tools;
  Cli cli;
  cli.app.require_command();
  cli.app.add_flag("-q,--quiet", cli.quiet, "No progress and no summary");
  cli.app.footer(kFooter);
  add_encode(cli);
  add_decode(cli);
  add_verify(cli);
  add_info(cli);
  add_compare(cli);
  add_preview(cli);
  add_crop(cli);
  add_view(cli);
  add_backends(cli);
  return run_program(
      cli.app, argc, argv, [&] { return cli.run(); }, Interrupts::once,
      fmt::format(" (container {}.{}, packet {})", gicodec::kContainerMajor,
                  gicodec::kContainerMinor, gicodec::kPacketVersion));
}

#include "common/cli.h"

#include <gicodec/version.h>

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 success, 1 verify or compare found a difference, 2 wrong usage, 3 damaged or\n"
    "unsuitable input, 4 a file cannot be opened, read or written, 5 a backend failed or memory\n"
    "ran out.\n"
    "\n"
    "Examples:\n"
    "  gicodec encode -o villa.gic dumps/villa/*.exr\n"
    "  gicodec info villa.gic\n"
    "  gicodec verify villa.gic dumps/villa/*.exr\n"
    "  gicodec decode villa.gic -o out/\n"
    "\n"
    "gicodec COMMAND --help tells more; so does the manual page gicodec(1).";

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
  add_backends(cli);
  return run_program(
      cli.app, argc, argv, [&] { return cli.run(); }, Interrupts::once,
      fmt::format(" (container {}.{}, packet {})", gicodec::kContainerMajor,
                  gicodec::kContainerMinor, gicodec::kPacketVersion));
}

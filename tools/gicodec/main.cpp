#include "common/cli.h"
#include "dump/file.h"

#include <gicodec/version.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

using gicodec::tools::Exit;

constexpr const char* kFooter =
    "gicodec COMMAND --help tells more.\n\n"
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
    "  gicodec preview villa.gic --frame 3 -o atlas.png";

int code(Exit exit) { return static_cast<int>(exit); }

int end_by(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);
  return EXIT_FAILURE;
}

int report(Exit exit, const char* message) {
  gicodec::tools::remark(message);
  return code(exit);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace gicodec::tools;
  keep_standard_numbers();
  catch_signals();
  try {
    Cli cli;
    cli.app.require_command();
    cli.app.version(fmt::format("gicodec {} (container {}.{}, packet {})", gicodec::kVersionString,
                                gicodec::kContainerMajor, gicodec::kContainerMinor,
                                gicodec::kPacketVersion));
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
    if (const auto exit = cli.app.parse(argc, argv)) return code(*exit);
    const Exit exit = cli.run();
    finish_standard_output();
    return code(exit);
  } catch (const Interrupted& interrupted) {
    return end_by(interrupted.signal);
  } catch (const Error& error) {
    if (caught() != 0) return end_by(caught());  // a signal caused the failed read or write
    return report(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    std::fputs("gicodec: not enough memory\n", stderr);  // allocates nothing
    return code(Exit::internal);
  } catch (const std::exception& error) {
    return report(Exit::internal, error.what());
  }
}

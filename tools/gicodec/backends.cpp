// gicodec backends: what this build can code with.
#include "backend_flags.h"
#include "cli.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace gicodec::tools {
namespace {

const char* describe(std::uint8_t id) {
  switch (id) {
    case kBackendRaw:
      return "texels as they are";
    case kBackendLz4:
      return "byte planes through LZ4; fastest";
    case kBackendZstd:
      return "byte planes through Zstandard";
    case kBackendHevc:
      return "H.265 by x265 or FFmpeg, as in the paper (GPL, LGPL)";
    case kBackendNative:
      return "made for probe textures: smallest, no other library; the default";
    default:
      return "";
  }
}

}  // namespace

void add_backends(Cli& cli) {
  auto format = std::make_shared<std::string>("text");
  Command* command = cli.app.add_command("backends", "Lists the backends of this build");
  add_output_format(*command, *format);
  command->callback([&cli, format] {
    cli.run = [format] {
      nlohmann::ordered_json json = nlohmann::ordered_json::array();
      for (const Backend* backend : all_backends()) {
        if (*format == "text") {
          fmt::print("{:<8} {}\n", backend->name(), describe(backend->id()));
        }
        json.push_back({{"name", backend->name()},
                        {"id", backend->id()},
                        {"description", describe(backend->id())}});
      }
      if (*format == "json") {
        print_json(json);
      } else {
        fmt::print("\nkernels for");
        for (const Isa isa : supported_isas()) fmt::print(" {}", to_string(isa));
        fmt::print(" run on this machine\n");
      }
      return Exit::ok;
    };
  });
}

}  // namespace gicodec::tools

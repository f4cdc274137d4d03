// gicodec backends: lists the backends of this build.
#include "common/backend_flags.h"
#include "common/cli.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace gicodec::tools {
namespace {

const char* describe(std::uint8_t id) {
  switch (id) {
    case kBackendRaw:
      return "records as they are";
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

/// Why a backend of this build cannot be used; empty if it can.
std::string missing(std::uint8_t id) {
  try {
    load_backend(id);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
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
        const std::string why_not = missing(backend->id());
        if (*format == "text") {
          print("{:<8} {}\n", backend->name(),
                why_not.empty() ? describe(backend->id()) : "cannot be used: " + why_not);
        }
        json.push_back({{"name", backend->name()},
                        {"id", backend->id()},
                        {"description", describe(backend->id())},
                        {"usable", why_not.empty()}});
      }
      if (*format == "json") {
        nlohmann::ordered_json sets = nlohmann::ordered_json::array();
        for (const Isa isa : supported_isas()) sets.push_back(to_string(isa));
        print_json({{"backends", json}, {"instruction_sets", sets}});
      } else {
        print("\nkernels for");
        for (const Isa isa : supported_isas()) print(" {}", to_string(isa));
        print(" run on this machine\n");
      }
      return Exit::ok;
    };
  });
}

}  // namespace gicodec::tools

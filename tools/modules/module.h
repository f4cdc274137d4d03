// Modules: shared objects that a tool loads when it first needs them, because the libraries behind
// them take longer to start than most commands to run. Each exports one table, gicodec_module, that
// begins with a ModuleHead.
#pragma once

#include <gicodec/version.h>

#include <string_view>

#define GICODEC_MODULE_EXPORT __attribute__((visibility("default")))

namespace gicodec::tools {

/// Whose table it is: a module is used by the programs of its own version alone.
struct ModuleHead {
  std::string_view name;                      ///< "gicodec-hevc"
  std::string_view version = kVersionString;  ///< with which the module was built
};

}  // namespace gicodec::tools

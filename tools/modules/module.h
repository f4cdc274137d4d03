// Modules: shared objects that a tool loads when it first needs them, because the libraries behind
// them take longer to start than most commands to run. Each exports one table, gicodec_module.
#pragma once

#define GICODEC_MODULE_EXPORT __attribute__((visibility("default")))

namespace gicodec::tools {

/// The table of the module `name`, from the folders where the program finds its libraries; it stays
/// loaded. Throws Error of Exit::internal, saying what the module is for. Any thread.
[[nodiscard]] const void* load_module(const char* name, const char* purpose);

}  // namespace gicodec::tools

// What is installed beside the program, and the user's browser.
#pragma once

#include <string>

namespace gicodec::tools {

/// The folder share/gicodec/NAME beside the installed program; empty if there is none.
[[nodiscard]] std::string installed_folder(const std::string& name);
/// Opens a file in the user's browser. False if that cannot be had.
[[nodiscard]] bool open_in_browser(const std::string& path);

}  // namespace gicodec::tools

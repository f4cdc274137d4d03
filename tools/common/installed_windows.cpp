#include "installed.h"

#include "dump/file_system.h"

#include <windows.h>
// After windows.h, whose types it needs.
#include <shellapi.h>

#include <cstdint>
#include <filesystem>

namespace gicodec::tools {

std::string installed_folder(const std::string& name) {
  std::wstring program(32768, L'\0');
  const DWORD size =
      GetModuleFileNameW(nullptr, program.data(), static_cast<DWORD>(program.size()));
  program.resize(size);
  std::error_code failed;
  const auto folder = std::filesystem::path(program).parent_path().parent_path() / "share" /
                      "gicodec" / native_path(name);
  return std::filesystem::is_directory(folder, failed) ? path_text(folder) : "";
}

bool open_in_browser(const std::string& path) {
  const auto answer = reinterpret_cast<std::intptr_t>(
      ShellExecuteW(nullptr, L"open", native_path(path).c_str(), nullptr, nullptr, SW_SHOWNORMAL));
  return answer > 32;  // as its page says
}

}  // namespace gicodec::tools

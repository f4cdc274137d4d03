#include "installed.h"

#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <filesystem>

#if defined(__APPLE__)
#include <mach-o/dyld.h>

#include <cstdint>
#endif

extern char** environ;  // NOLINT(readability-redundant-declaration): not every system declares it

namespace gicodec::tools {
namespace {

#if defined(__APPLE__)
constexpr const char* kOpener = "open";

std::filesystem::path program() {
  std::array<char, 4096> path{};
  auto size = static_cast<std::uint32_t>(path.size());
  return _NSGetExecutablePath(path.data(), &size) == 0 ? path.data() : "";
}
#else
constexpr const char* kOpener = "xdg-open";

std::filesystem::path program() {
  std::error_code failed;
  return std::filesystem::read_symlink("/proc/self/exe", failed);
}
#endif

}  // namespace

std::string installed_folder(const std::string& name) {
  std::error_code failed;
  const auto path = program();
  if (path.empty()) return "";
  const auto folder = path.parent_path().parent_path() / "share/gicodec" / name;
  return std::filesystem::is_directory(folder, failed) ? folder.string() : "";
}

bool open_in_browser(const std::string& path) {
  std::string opener = kOpener, file = path;
  std::array<char*, 3> arguments{opener.data(), file.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, kOpener, nullptr, nullptr, arguments.data(), environ) != 0) return false;
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace gicodec::tools

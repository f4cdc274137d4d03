// Program::run_in() by CreateProcess().
#include "dump/file_system.h"
#include "tools/cli_support.h"

#include <windows.h>

#include <cstdlib>
#include <string_view>

namespace gicodec::tools {
namespace {

/// A word as programs take it from a command line.
std::string quoted(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\"") == std::string::npos) return word;
  std::string text = "\"";
  std::size_t slashes = 0;
  for (const char c : word) {
    if (c == '"') text.append(slashes + 1, '\\');
    slashes = c == '\\' ? slashes + 1 : 0;
    text += c;
  }
  return text.append(slashes, '\\') + "\"";
}

HANDLE open_stream(const std::string& path, DWORD access, DWORD creation) {
  SECURITY_ATTRIBUTES inherited{sizeof inherited, nullptr, TRUE};
  const HANDLE file =
      CreateFileW(native_path(path).c_str(), access, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited,
                  creation, 0, nullptr);
  if (file == INVALID_HANDLE_VALUE) std::abort();
  return file;
}

}  // namespace

Outcome Program::run_in(const Circumstances& circumstances,
                        const std::vector<std::string>& arguments) const {
  const TemporaryDirectory streams;
  const std::string out = streams.path("out"), err = streams.path("err");
  std::string line = quoted(GICODEC_CLI);
  for (const std::string& argument : arguments) line += " " + quoted(argument);
  std::wstring wide = std::filesystem::path(std::u8string(line.begin(), line.end())).native();
  STARTUPINFOW start{};
  start.cb = sizeof start;
  start.dwFlags = STARTF_USESTDHANDLES;
  const bool nothing = circumstances.input == "/dev/null";
  start.hStdInput = open_stream(nothing ? "NUL" : circumstances.input, GENERIC_READ, OPEN_EXISTING);
  start.hStdOutput = open_stream(out, GENERIC_WRITE, CREATE_ALWAYS);
  start.hStdError = open_stream(err, GENERIC_WRITE, CREATE_ALWAYS);
  PROCESS_INFORMATION process{};
  // A group of its own gets Ctrl-Break alone.
  const bool started =
      CreateProcessW(nullptr, wide.data(), nullptr, nullptr, TRUE, CREATE_NEW_PROCESS_GROUP,
                     nullptr, native_path(directory_.path("")).c_str(), &start, &process) != 0;
  for (const HANDLE stream : {start.hStdInput, start.hStdOutput, start.hStdError}) {
    CloseHandle(stream);
  }
  if (!started) std::abort();
  while (circumstances.kill_when && WaitForSingleObject(process.hProcess, 0) == WAIT_TIMEOUT) {
    if (circumstances.kill_when()) {
      if (!GenerateConsoleCtrlEvent(CTRL_BREAK_EVENT, process.dwProcessId)) std::abort();
      break;
    }
    Sleep(1);
  }
  WaitForSingleObject(process.hProcess, INFINITE);
  DWORD code = 0;
  GetExitCodeProcess(process.hProcess, &code);
  CloseHandle(process.hThread);
  CloseHandle(process.hProcess);
  return {static_cast<int>(code), file_text(out), file_text(err)};
}

}  // namespace gicodec::tools

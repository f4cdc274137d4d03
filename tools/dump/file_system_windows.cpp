#include "dump/file_system.h"

#include <windows.h>

#include <fcntl.h>
#include <io.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace gicodec::tools {
namespace {

/// A path as the system reads it, without allocation. Empty if it is not UTF-8 or too long.
class WidePath {
 public:
  explicit WidePath(const char* path) noexcept {
    const auto most = static_cast<int>(text_.size());
    const int size =
        MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, text_.data(), most);
    if (size == 0) text_[0] = 0;
  }
  [[nodiscard]] const wchar_t* c_str() const noexcept { return text_.data(); }

 private:
  std::array<wchar_t, 32768> text_;
};

/// The last error of the system as errno.
int error_number() noexcept {
  switch (GetLastError()) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_NETPATH:
    case ERROR_BAD_NET_NAME:
      return ENOENT;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      return EEXIST;
    case ERROR_SHARING_VIOLATION:
    case ERROR_LOCK_VIOLATION:
      return ETXTBSY;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
      return ENOSPC;
    case ERROR_FILENAME_EXCED_RANGE:
      return ENAMETOOLONG;
    case ERROR_WRITE_PROTECT:
      return EROFS;
    case ERROR_NOT_ENOUGH_MEMORY:
      return ENOMEM;
    case ERROR_TOO_MANY_OPEN_FILES:
      return EMFILE;
    default:
      return EACCES;
  }
}

constexpr DWORD kShareAll = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

HANDLE open_handle(const char* path, DWORD access, DWORD share, DWORD creation, DWORD flags = 0) {
  const HANDLE file =
      CreateFileW(WidePath(path).c_str(), access, share, nullptr, creation, flags, nullptr);
  if (file == INVALID_HANDLE_VALUE) errno = error_number();
  return file;
}

std::FILE* stream_of(HANDLE file, int flags, const char* mode) {
  if (file == INVALID_HANDLE_VALUE) return nullptr;
  const int descriptor =
      _open_osfhandle(reinterpret_cast<std::intptr_t>(file), flags | _O_BINARY | _O_NOINHERIT);
  if (descriptor < 0) {
    CloseHandle(file);
    errno = EMFILE;
    return nullptr;
  }
  std::FILE* const stream = _fdopen(descriptor, mode);
  if (stream == nullptr) _close(descriptor);
  return stream;
}

HANDLE handle_of(std::FILE* file) {
  return reinterpret_cast<HANDLE>(_get_osfhandle(_fileno(file)));
}

std::optional<FileState> state_of_handle(HANDLE file) {
  FileState state;
  switch (GetFileType(file)) {
    case FILE_TYPE_DISK:
      break;
    case FILE_TYPE_CHAR:
      state.kind = FileState::Kind::character;
      return state;
    case FILE_TYPE_PIPE:
      return state;
    default:
      errno = EBADF;
      return std::nullopt;
  }
  BY_HANDLE_FILE_INFORMATION found;
  if (!GetFileInformationByHandle(file, &found)) {
    errno = error_number();
    return std::nullopt;
  }
  state.size = std::uint64_t{found.nFileSizeHigh} << 32 | found.nFileSizeLow;
  state.identity = {found.dwVolumeSerialNumber,
                    std::uint64_t{found.nFileIndexHigh} << 32 | found.nFileIndexLow};
  using enum FileState::Kind;
  // Files that are packed or elsewhere have reparse points too.
  FILE_ATTRIBUTE_TAG_INFO tag{};
  const bool is_link = (found.dwFileAttributes & FILE_ATTRIBUTE_REPARSE_POINT) != 0 &&
                       GetFileInformationByHandleEx(file, FileAttributeTagInfo, &tag, sizeof tag) &&
                       IsReparseTagNameSurrogate(tag.ReparseTag);
  state.kind = is_link                                                    ? link
               : (found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0 ? directory
                                                                          : regular;
  return state;
}

/// The consoles' settings, which end with the program.
struct Console {
  UINT code_page = GetConsoleOutputCP();
  DWORD modes[2] = {};
} console;
constexpr DWORD kOutputs[] = {STD_OUTPUT_HANDLE, STD_ERROR_HANDLE};

void restore_console() {
  if (console.code_page != 0) SetConsoleOutputCP(console.code_page);
  for (int i = 0; i < 2; ++i) {
    if (console.modes[i] != 0) SetConsoleMode(GetStdHandle(kOutputs[i]), console.modes[i]);
  }
}

}  // namespace

std::filesystem::path native_path(std::string_view path) {
  return std::u8string(path.begin(), path.end());
}

// By slashes, as everywhere; the system takes both.
std::string path_text(const std::filesystem::path& path) {
  const std::u8string wide = path.u8string();
  std::string text(wide.begin(), wide.end());
  std::replace(text.begin(), text.end(), '\\', '/');
  return text;
}

std::string folded(const std::string& name) {
  const std::wstring wide = native_path(name).native();
  std::wstring upper(wide.size(), L'\0');
  const int size = LCMapStringEx(LOCALE_NAME_INVARIANT, LCMAP_UPPERCASE, wide.data(),
                                 static_cast<int>(wide.size()), upper.data(),
                                 static_cast<int>(upper.size()), nullptr, nullptr, 0);
  return size == 0 ? name : path_text(upper);
}

std::string reason(int error) {
  if (error == ETXTBSY) return "another program has it open; close it there first";
  if (error == EROFS) return "it is read-only; remove that attribute or name another file";
  return std::strerror(error);
}

// The C library knows ERROR_BROKEN_PIPE; ERROR_NO_DATA becomes EINVAL.
bool reader_ended(int error) {
  return error == EPIPE || (error == EINVAL && GetFileType(handle_of(stdout)) == FILE_TYPE_PIPE);
}

// The standard library of mingw knows no links.
std::string resolved(const std::string& link) {
  const HANDLE file =
      open_handle(link.c_str(), 0, kShareAll, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS);
  if (file == INVALID_HANDLE_VALUE) return link;
  std::vector<wchar_t> name(32768);
  const DWORD size = GetFinalPathNameByHandleW(file, name.data(), static_cast<DWORD>(name.size()),
                                               FILE_NAME_NORMALIZED);
  CloseHandle(file);
  if (size == 0 || size >= name.size()) return link;
  const std::string text = path_text(name.data());
  if (text.starts_with("//?/UNC/")) return "//" + text.substr(8);
  return text.starts_with("//?/") ? text.substr(4) : text;
}

std::optional<FileState> state_of(const char* path, Links links) {
  const DWORD link = links == Links::show ? FILE_FLAG_OPEN_REPARSE_POINT : 0;
  const HANDLE file = open_handle(path, FILE_READ_ATTRIBUTES, kShareAll, OPEN_EXISTING,
                                  FILE_FLAG_BACKUP_SEMANTICS | link);
  if (file == INVALID_HANDLE_VALUE) return std::nullopt;
  auto state = state_of_handle(file);
  const int code = errno;
  CloseHandle(file);
  errno = code;
  return state;
}

std::optional<FileState> state_of(std::FILE* file) { return state_of_handle(handle_of(file)); }

// mingw's library lists no folder beyond 260 characters.
std::optional<std::vector<std::string>> names_in(const std::string& folder) {
  WIN32_FIND_DATAW found;
  const HANDLE search = FindFirstFileW(WidePath((folder + "\\*").c_str()).c_str(), &found);
  if (search == INVALID_HANDLE_VALUE) {
    errno = error_number();
    return std::nullopt;
  }
  std::vector<std::string> names;
  do {
    // What is no UTF-16 gets other names, which nothing has.
    char name[4 * MAX_PATH];
    const int size =
        WideCharToMultiByte(CP_UTF8, 0, found.cFileName, -1, name, sizeof name, nullptr, nullptr);
    const std::string_view text(name, size > 0 ? static_cast<std::size_t>(size - 1) : 0);
    if (!text.empty() && text != "." && text != "..") names.emplace_back(text);
  } while (FindNextFileW(search, &found));
  const DWORD end = GetLastError();
  FindClose(search);
  if (end == ERROR_NO_MORE_FILES) return names;
  SetLastError(end);
  errno = error_number();
  return std::nullopt;
}

bool is_readable(const std::string& path) {
  std::FILE* const file = open_input(path);
  if (file == nullptr) return false;
  std::fclose(file);
  return true;
}

bool is_terminal(const std::string& path) {
  const auto state = state_of(path.c_str());
  if (!state || state->kind != FileState::Kind::character) return false;
  const HANDLE file =
      open_handle(path.c_str(), GENERIC_WRITE | GENERIC_READ, kShareAll, OPEN_EXISTING);
  DWORD mode = 0;
  const bool terminal = file != INVALID_HANDLE_VALUE && GetConsoleMode(file, &mode);
  if (file != INVALID_HANDLE_VALUE) CloseHandle(file);
  return terminal;
}

bool is_terminal(std::FILE* stream) {
  DWORD mode = 0;  // NUL is a character device too, but has none
  return GetConsoleMode(handle_of(stream), &mode) != 0;
}

std::FILE* open_input(const std::string& path) {
  return stream_of(open_handle(path.c_str(), GENERIC_READ, kShareAll, OPEN_EXISTING), _O_RDONLY,
                   "rb");
}

std::optional<std::size_t> read_head(std::FILE* file, std::span<char> into) {
  OVERLAPPED from{};
  DWORD size = 0;
  const HANDLE handle = handle_of(file);
  LARGE_INTEGER before{};
  SetFilePointerEx(handle, {}, &before, FILE_CURRENT);
  const bool read =
      ReadFile(handle, into.data(), static_cast<DWORD>(into.size()), &size, &from) != 0;
  const bool end = !read && GetLastError() == ERROR_HANDLE_EOF;
  if (!read && !end) errno = error_number();
  SetFilePointerEx(handle, before, nullptr, FILE_BEGIN);
  if (!read && !end) return std::nullopt;
  return size;
}

std::FILE* open_device(const std::string& path) {
  return stream_of(open_handle(path.c_str(), GENERIC_WRITE, kShareAll, OPEN_EXISTING), _O_WRONLY,
                   "wb");
}

// Access comes from the folder, as of every new file.
std::FILE* create_file(const std::string& path, const std::string&) {
  return stream_of(open_handle(path.c_str(), GENERIC_READ | GENERIC_WRITE,
                               FILE_SHARE_READ | FILE_SHARE_DELETE, CREATE_NEW),
                   _O_RDWR, "wb");
}

std::FILE* open_locked(const std::string& path, const std::string&) {
  const HANDLE file =
      open_handle(path.c_str(), GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_DELETE,
                  OPEN_ALWAYS, FILE_FLAG_OPEN_REPARSE_POINT);
  if (file == INVALID_HANDLE_VALUE && errno == ETXTBSY) errno = EWOULDBLOCK;
  return stream_of(file, _O_RDWR, "r+b");
}

bool seek_file(std::FILE* file, std::uint64_t offset) {
  return _fseeki64(file, static_cast<std::int64_t>(offset), SEEK_SET) == 0;
}

bool sync_file(std::FILE* file) { return std::fflush(file) == 0 && _commit(_fileno(file)) == 0; }

bool rename_file(const std::string& from, const std::string& to, bool replace) {
  const WidePath target(to.c_str());
  const DWORD old = GetFileAttributesW(target.c_str());
  const bool exists = old != INVALID_FILE_ATTRIBUTES;
  if (replace && exists && (old & FILE_ATTRIBUTE_READONLY) != 0) {
    errno = EROFS;
    return false;
  }
  const DWORD flags = MOVEFILE_WRITE_THROUGH | (replace ? MOVEFILE_REPLACE_EXISTING : 0U);
  // Scanners look at new files for a moment.
  for (int attempt = 0; attempt < 10; ++attempt) {
    if (MoveFileExW(WidePath(from.c_str()).c_str(), target.c_str(), flags)) return true;
    const DWORD cause = GetLastError();
    errno = error_number();
    if (cause != ERROR_SHARING_VIOLATION && cause != ERROR_ACCESS_DENIED) break;
    Sleep(50);
  }
  if (errno != EACCES || !exists) return false;
  // What a program holds open is refused so too.
  const HANDLE deletable = open_handle(to.c_str(), DELETE, kShareAll, OPEN_EXISTING);
  if (deletable != INVALID_HANDLE_VALUE) {
    CloseHandle(deletable);
    errno = ETXTBSY;
  }
  return false;
}

void remove_file(const char* path) noexcept { DeleteFileW(WidePath(path).c_str()); }

void prepare_standard_streams() noexcept {
  for (std::FILE* const stream : {stdin, stdout, stderr}) {
    if (_fileno(stream) >= 0) static_cast<void>(_setmode(_fileno(stream), _O_BINARY));
  }
  for (int i = 0; i < 2; ++i) {
    const HANDLE output = GetStdHandle(kOutputs[i]);
    if (GetConsoleMode(output, &console.modes[i])) {
      SetConsoleMode(output, console.modes[i] | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
    }
  }
  if (console.code_page != 0 && SetConsoleOutputCP(CP_UTF8)) std::atexit(restore_console);
}

}  // namespace gicodec::tools

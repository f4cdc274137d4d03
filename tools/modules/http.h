// What the module gicodec-http offers: parts of files on servers, by libcurl.
#pragma once

#include "modules/module.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

struct HttpOptions {
  std::string url;      ///< http:// or https://
  std::string token;    ///< goes to the server of the URL alone, not where it redirects to
  std::string agent;    ///< name and version of the program
  std::string ca;       ///< file of authorities to trust; empty: the system's
  bool direct = false;  ///< past any proxy
  bool (*is_stopped)() noexcept = nullptr;  ///< asked several times a second; true ends requests
};

/// A request for a part of the file.
struct HttpRequest {
  std::uint64_t first = 0;  ///< its offset, or of the file's last bytes: `from_end`
  std::uint64_t size = 0;   ///< bytes, at least 1
  bool from_end = false;
  std::string mark;  ///< HttpAnswer::mark that the file must still have; empty: any
};

/// What the server says; nothing of it has been checked, and texts are not escaped.
struct HttpAnswer {
  long status = 0;      ///< of HTTP; 0: none came
  std::string failure;  ///< why not, or why the body is not whole; empty: it is
  std::string url;      ///< after redirects
  std::string type;     ///< Content-Type
  std::string packing;  ///< Content-Encoding
  std::string mark;     ///< strong ETag, else Last-Modified, else empty
  std::optional<std::uint64_t> first, total;  ///< of Content-Range
  std::vector<std::byte> body;                ///< at most as many bytes as were asked for
  bool more = false;                          ///< the body went on behind these
};

/// A file from its beginning on.
class HttpStream {
 public:
  virtual ~HttpStream() = default;
  /// Fills `into`; fewer bytes: the end, or failure() says why not.
  virtual std::size_t read(std::span<std::byte> into) = 0;
  [[nodiscard]] virtual const std::string& failure() const noexcept = 0;
};

/// Connections to the server of a file.
class HttpFile {
 public:
  virtual ~HttpFile() = default;
  /// Sends all requests at once, and returns when all have been answered, or have failed.
  virtual std::vector<HttpAnswer> get(std::span<const HttpRequest> requests) = 0;
  virtual std::unique_ptr<HttpStream> stream() = 0;
};

struct HttpModule {
  ModuleHead head;
  /// Null if memory ran out. Connects when it is asked for something.
  std::unique_ptr<HttpFile> (*open)(const HttpOptions& options);
};

/// Loaded at the first call; throws Error of Exit::internal if that fails.
[[nodiscard]] const HttpModule& http_module();

}  // namespace gicodec::tools

// Answers of the WebSockets port to plain HTTP: the server's health, its metrics, and the files of
// a page.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::streaming {

struct WebRequest {
  bool get = false;  ///< its method is GET or HEAD
  std::string path, authorization;
  bool loopback = false;       ///< it comes from this machine
  std::string host = {};       ///< by which name it was asked for
  std::string encodings = {};  ///< that the browser takes
};

/// The metrics that the server has shown last, and when.
struct Shown {
  std::string metrics;
  double at = 0;
};

/// The files of a folder by their path in it, which begins with a slash; "/" is index.html. Beside
/// a file NAME may stand NAME.br, the same by Brotli. Read once: no request reaches the folder.
class WebFiles {
 public:
  WebFiles() = default;
  /// Throws tools::Error of Exit::io if the folder cannot be read, has no index.html, or more than
  /// 64 MiB.
  explicit WebFiles(const std::string& folder);

  struct File {
    std::string type, bytes, brotli = {};
  };
  void add(std::string path, std::string bytes);
  /// nullptr if there is none of that path.
  [[nodiscard]] const File* find(std::string_view path) const;

 private:
  std::map<std::string, File, std::less<>> files_;
};

struct WebAnswer {
  std::string head;       ///< the header and what was made for this request
  std::string_view rest;  ///< bytes of a file behind it
};
/// Metrics are for this machine or, if there is a token, for requests with it; others get the
/// answer for an unknown path.
[[nodiscard]] WebAnswer web_answer(const WebRequest& request, const Shown& shown,
                                   const std::string& metrics_token, double now,
                                   const WebFiles& files = {});

/// Whether a page of `origin` may connect to a server that it calls `host`: the server's own pages,
/// and those of `allowed`, "*" for all. Programs that are no browsers send no origin. `secure`: the
/// server has a certificate. Without one, own pages are those of an address or of localhost: any
/// other name may be a stranger's that he let stand for this machine.
[[nodiscard]] bool may_connect(std::string_view origin, std::string_view host,
                               const std::vector<std::string>& allowed, bool secure) noexcept;

}  // namespace gicodec::streaming

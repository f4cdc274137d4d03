#include "web_page.h"

#include "dump/error.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "secrets.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace gicodec::streaming {
namespace {

constexpr double kStale = 15;  ///< seconds after which a server that shows nothing is unhealthy
constexpr const char* kBearer = "Bearer ";

/// What a browser may load and run there; a page says the same of itself.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; style-src "
    "'self'; img-src 'self' blob: data:; connect-src 'self' blob: data: http: https: ws: wss:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr std::array<std::pair<std::string_view, const char*>, 8> kTypes{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".wasm", "application/wasm"},
    {".glb", "model/gltf-binary"},
    {".gic", "application/octet-stream"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
}};

const char* type_of(std::string_view path) {
  const auto found =
      std::ranges::find_if(kTypes, [&](const auto& row) { return path.ends_with(row.first); });
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

std::string head_of(const char* status, std::string_view type, std::size_t bytes,
                    bool brotli = false) {
  return fmt::format(
      "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "Content-Security-Policy: {}\r\nX-Content-Type-Options: nosniff\r\n"
      "Referrer-Policy: no-referrer\r\nVary: Accept-Encoding\r\n{}Connection: close\r\n\r\n",
      status, type, bytes, kPolicy, brotli ? "Content-Encoding: br\r\n" : "");
}

/// Whether a list such as "gzip, deflate, br;q=0.5" has Brotli.
bool takes_brotli(std::string_view list) noexcept {
  while (!list.empty()) {
    std::string_view one = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), one.size() + 1));
    one.remove_prefix(std::min(one.size(), one.find_first_not_of(' ')));
    if (!one.starts_with("br")) continue;
    one.remove_prefix(2);
    if (one.empty()) return true;
    // ";q=0", ";q=0.0" and so on refuse it.
    const std::size_t weight = one.find("q=");
    if (one.starts_with(';') &&
        (weight == one.npos || one.find_first_of("123456789", weight) != one.npos)) {
      return true;
    }
  }
  return false;
}

WebAnswer page(const char* status, const char* type, const std::string& body) {
  return {head_of(status, type, body.size()) + body, {}};
}

/// "localhost" or an address, with a port or without.
bool is_plain_host(std::string_view host) noexcept {
  if (host.starts_with('[')) return host.find(']') != host.npos;
  const std::string_view name = host.substr(0, host.find(':'));
  return name == "localhost" ||
         (!name.empty() && name.find_first_not_of("0123456789.") == name.npos);
}

bool may_measure(const WebRequest& request, const std::string& token) {
  return token.empty() ? request.loopback && (request.host.empty() || is_plain_host(request.host))
                       : same_secret(request.authorization, kBearer + token);
}

}  // namespace

WebFiles::WebFiles(const std::string& folder) {
  namespace fs = std::filesystem;
  constexpr std::uint64_t kMost = std::uint64_t{64} << 20;
  std::uint64_t bytes = 0;
  const fs::path top = tools::native_path(folder);
  try {
    for (const auto& entry : fs::recursive_directory_iterator(top)) {
      if (!entry.is_regular_file()) continue;
      bytes += entry.file_size();
      if (bytes > kMost) {
        tools::fail(tools::Exit::io, "{}: more than {} bytes are no page; give the folder of one",
                    folder, kMost);
      }
      const std::string path = tools::path_text(entry.path());
      std::string name = "/" + tools::path_text(entry.path().lexically_relative(top));
      std::string contents = tools::file_contents(path);
      if (contents.empty()) tools::fail(tools::Exit::io, "{}: is empty", path);
      add(std::move(name), std::move(contents));
    }
  } catch (const fs::filesystem_error& error) {
    tools::fail(tools::Exit::io, "{}: cannot be read: {}", folder, error.code().message());
  }
  const auto index = files_.find("/index.html");
  if (index == files_.end()) {
    tools::fail(tools::Exit::io, "{}: has no index.html; give the folder of a page", folder);
  }
  // What has no original stays a file of its own.
  for (auto& [name, file] : files_) {
    const auto packed = files_.find(name + ".br");
    if (packed != files_.end()) file.brotli = packed->second.bytes;
  }
  files_["/"] = index->second;
}

void WebFiles::add(std::string path, std::string bytes) {
  const char* const type = type_of(path);
  files_[std::move(path)] = {type, std::move(bytes)};
}

const WebFiles::File* WebFiles::find(std::string_view path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

WebAnswer web_answer(const WebRequest& request, const Shown& shown,
                     const std::string& metrics_token, double now, const WebFiles& files) {
  if (request.get && request.path == "/health") {
    return now - shown.at <= kStale
               ? page("200 OK", "text/plain", "ok\n")
               : page("503 Service Unavailable", "text/plain", "the server does not answer\n");
  }
  if (request.get && request.path == "/metrics" && may_measure(request, metrics_token))
    return page("200 OK", "text/plain; version=0.0.4", shown.metrics);
  const WebFiles::File* const file = request.get ? files.find(request.path) : nullptr;
  if (file == nullptr) return page("404 Not Found", "text/plain", "not found\n");
  const bool brotli = !file->brotli.empty() && takes_brotli(request.encodings);
  const std::string& bytes = brotli ? file->brotli : file->bytes;
  return {head_of("200 OK", file->type, bytes.size(), brotli), bytes};
}

bool may_connect(std::string_view origin, std::string_view host,
                 const std::vector<std::string>& allowed, bool secure) noexcept {
  if (origin.empty()) return true;
  for (const std::string_view scheme : {"https://", "http://"}) {
    const bool own = origin.starts_with(scheme) && origin.substr(scheme.size()) == host;
    if (own && (secure || is_plain_host(host))) return true;
  }
  return std::ranges::any_of(allowed,
                             [&](const std::string& one) { return one == "*" || one == origin; });
}

}  // namespace gicodec::streaming

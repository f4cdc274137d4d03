// Reads files on servers, of each the parts that are needed.
#pragma once

#include "common/token.h"
#include "dump/url.h"
#include "modules/http.h"

#include <gicodec/io.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

struct HttpFlags {
  TokenFlags token;
  std::string ca;
};
/// Adds "--ca", "--token-file" and "--token".
void add_http_flags(Command& command, HttpFlags& flags);

/// A file on a server. Asks for its head and its end at once, which are small files whole; later
/// for what prefetch() says, or for what read() needs and more and more behind it. A file that
/// changes meanwhile is an error, unless it grows. Of a server that sends files whole it reads in
/// order, and size() has no value.
class HttpSource final : public Source {
 public:
  /// Throws Error if the server has no such file, or does not answer. `follow`: waits a minute for
  /// a server that is away.
  HttpSource(const std::string& url, const HttpFlags& flags, bool follow = false);

  Result<std::size_t> read(std::span<std::byte> into) override;
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return size_; }
  Status seek(std::uint64_t offset) override;
  bool prefetch(std::span<const ByteRange> ranges) override;

  /// Asks how large the file is now. False if it was replaced by another, or the server does not
  /// answer: see failure().
  [[nodiscard]] bool refresh();

  /// Why read() or refresh() failed.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  /// What it took so far. Requests that were sent together are one round trip.
  struct Cost {
    std::uint64_t bytes = 0, requests = 0, round_trips = 0;
  };
  [[nodiscard]] const Cost& cost() const noexcept { return cost_; }

 private:
  void begin();
  [[nodiscard]] std::vector<HttpAnswer> ask(std::span<const HttpRequest> requests);
  [[nodiscard]] std::vector<HttpAnswer> ask_again(std::span<const HttpRequest> requests);
  [[nodiscard]] std::vector<ByteRange> missing(std::span<const ByteRange> ranges) const;
  [[nodiscard]] std::vector<ByteRange> joined(std::span<const ByteRange> ranges) const;
  [[nodiscard]] bool bring(std::span<const ByteRange> ranges);
  [[nodiscard]] bool bring(std::vector<HttpRequest> requests);
  [[nodiscard]] bool is_changed(const HttpAnswer& answer) const;
  [[nodiscard]] bool has_grown(std::uint64_t known);
  [[nodiscard]] static bool is_part(const HttpAnswer& answer, const HttpRequest& request);
  [[nodiscard]] std::string fault(const HttpAnswer& answer, const HttpRequest& request) const;
  [[nodiscard]] const std::vector<std::byte>* piece_at(std::uint64_t offset,
                                                       std::size_t& skipped) const;
  void make_room(std::uint64_t bytes);
  void keep(std::uint64_t offset, std::vector<std::byte> bytes);

  std::unique_ptr<HttpFile> file_;
  std::unique_ptr<HttpStream> stream_;  ///< instead of parts
  std::string name_;                    ///< for messages
  int tries_;                           ///< after the first
  std::optional<std::uint64_t> size_;
  std::string mark_;                                      ///< what changes with the file
  std::map<std::uint64_t, std::vector<std::byte>> held_;  ///< by offset, apart from each other
  std::uint64_t held_bytes_ = 0;
  std::uint64_t at_ = 0;
  bool grows_ = false;
  std::uint64_t window_;  ///< bytes to ask for where nothing was planned
  std::string failure_;
  Cost cost_;
};

}  // namespace gicodec::tools

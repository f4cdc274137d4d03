#include "http_source.h"

#include "cli.h"
#include "dump/error.h"
#include "dump/text.h"
#include "interrupts.h"

#include <gicodec/version.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

namespace gicodec::tools {
namespace {

/// Bytes of the first requests, and of what is read in order: at first, and at most.
constexpr std::uint64_t kFirst = std::uint64_t{64} << 10;
constexpr std::uint64_t kMaxWindow = std::uint64_t{4} << 20;
/// Bytes of a request at most, and those between two ranges that are not worth two requests.
constexpr std::uint64_t kMaxPart = std::uint64_t{4} << 20;
constexpr std::uint64_t kGap = std::uint64_t{16} << 10;
/// Bytes that are held at most, beside the file's head and end.
constexpr std::uint64_t kMaxHeld = std::uint64_t{64} << 20;
/// Requests that are sent together.
constexpr std::size_t kTogether = 64;
/// A request that fails on the way is sent again so often, and of a file that is followed; after so
/// many milliseconds, later twice as many, at most.
constexpr int kTries = 2, kFollowedTries = 40;
constexpr int kPause = 200, kMaxPause = 2000;

void pause(int tries) {
  const int time = tries < 4 ? kPause << tries : kMaxPause;
  std::this_thread::sleep_for(std::chrono::milliseconds(std::min(time, kMaxPause)));
}

bool is_transient(const HttpAnswer& answer) {
  return answer.status == 0 || !answer.failure.empty() || answer.status == 429 ||
         answer.status >= 500;
}

bool is_stopped() noexcept { return caught_signal() != 0; }

/// What an answer other than a file says, and the cure.
std::string status_text(const HttpAnswer& answer) {
  switch (answer.status) {
    case 401:
    case 403:
      return fmt::format(
          "the server refuses it (HTTP {}): is it a folder? --token-file takes a token",
          answer.status);
    case 404:
    case 410:
      return fmt::format("is not there (HTTP {}); check the address", answer.status);
    case 416:
      return "is empty, or shorter than it was (HTTP 416); get it again";
    default:
      return fmt::format("the server answers HTTP {}; try later", answer.status);
  }
}

}  // namespace

void add_http_flags(Command& command, HttpFlags& flags) {
  command
      .add_option("--ca", flags.ca,
                  "Of a URL: PEM file of authorities that may vouch for the server; default: "
                  "the system's")
      ->type_name("FILE");
  add_token_flags(command, flags.token,
                  "Of a URL: file whose first line is the token that the server asks for; it goes "
                  "to that server alone");
}

HttpSource::HttpSource(const std::string& url, const HttpFlags& flags, bool follow)
    : name_(shown_url(url)), tries_(follow ? kFollowedTries : kTries), window_(kFirst) {
  HttpOptions options;
  options.url = url;
  options.agent = fmt::format("gicodec/{}", kVersionString);
  options.ca = flags.ca;
  const Token token = read_token(flags.token);
  if (!token.remark.empty()) remark(token.remark);
  options.token = token.text;
  options.direct = is_loopback(host_of(name_));
  options.is_stopped = is_stopped;
  if (!token.text.empty() && lower_case(name_).starts_with("http:") && !options.direct) {
    fail(Exit::usage, "{}: a token would go there in clear; use https://", name_);
  }
  file_ = http_module().open(options);
  if (!file_) fail(Exit::internal, "{}: memory ran out", name_);
  begin();
  if (stream_ && follow) {
    fail(Exit::io, "{}: the server sends files whole, and --follow needs parts of them", name_);
  }
}

/// Brings the file's head and end, or begins to read it in order.
void HttpSource::begin() {
  const HttpRequest requests[] = {{0, kFirst, false, ""}, {0, kFirst, true, ""}};
  std::vector<HttpAnswer> answers = ask_again(requests);
  HttpAnswer &head = answers[0], &end = answers[1];
  if (head.status == 0 || !head.failure.empty()) {
    const bool tls = head.failure.find("SSL") != std::string::npos;
    const bool malformed = head.failure.find("illegal format") != std::string::npos;
    fail(Exit::io, "{}: {}; {}", name_, head.failure,
         malformed ? "write a space as %20, and a port below 65536"
         : tls     ? "is it http, or are its authorities a matter of --ca?"
                   : "check address and connection, and http_proxy if it is set");
  }
  if (head.status != 200 && head.status != 206) {
    fail(Exit::io, "{}: {}", name_, status_text(head));
  }
  if (!head.packing.empty() && head.packing != "identity") {
    fail(Exit::io, "{}: the server packs it ({}); have it send .gic files as they are", name_,
         head.packing);
  }
  if (head.status == 200) {
    if (head.more) {
      stream_ = file_->stream();
      return;
    }
    if (head.body.empty()) fail(Exit::bad_input, "{}: is empty; get it again", name_);
    size_ = head.body.size();
    keep(0, std::move(head.body));
    return;
  }
  if (head.first != 0 || !head.total || *head.total == 0 || head.more ||
      head.body.size() != std::min(kFirst, *head.total)) {
    fail(Exit::io, "{}: the server sends other bytes than those it was asked for", name_);
  }
  size_ = head.total;
  mark_ = head.mark;
  keep(0, std::move(head.body));
  const bool sound = end.status == 206 && end.failure.empty() && end.total == size_ &&
                     end.mark == mark_ && end.first == *size_ - std::min(kFirst, *size_) &&
                     end.body.size() == std::min(kFirst, *size_);
  if (!sound || *size_ <= kFirst) return;
  // Where the head ends within it, the rest.
  const std::uint64_t twice = 2 * kFirst > *size_ ? 2 * kFirst - *size_ : 0;
  end.body.erase(end.body.begin(), end.body.begin() + static_cast<std::ptrdiff_t>(twice));
  const std::uint64_t offset = *size_ - end.body.size();
  keep(offset, std::move(end.body));
}

std::vector<HttpAnswer> HttpSource::ask(std::span<const HttpRequest> requests) {
  std::vector<HttpAnswer> answers = file_->get(requests);
  check_interrupt();
  cost_.requests += requests.size();
  ++cost_.round_trips;
  for (const HttpAnswer& answer : answers) cost_.bytes += answer.body.size();
  return answers;
}

/// The same, again where one fails on the way.
std::vector<HttpAnswer> HttpSource::ask_again(std::span<const HttpRequest> requests) {
  for (int tries = 0;; ++tries) {
    std::vector<HttpAnswer> answers = ask(requests);
    if (tries == tries_ || !is_transient(answers[0])) return answers;
    pause(tries);
  }
}

void HttpSource::keep(std::uint64_t offset, std::vector<std::byte> bytes) {
  if (bytes.empty()) return;
  held_bytes_ += bytes.size();
  held_.emplace(offset, std::move(bytes));
}

/// Drops pieces where these bytes more would be too many; not the first and the last.
void HttpSource::make_room(std::uint64_t bytes) {
  if (held_bytes_ + bytes <= kMaxHeld + 2 * kFirst) return;
  const std::uint64_t last = held_.rbegin()->first;
  std::erase_if(held_, [&](const auto& piece) {
    const bool edge = piece.first == 0 || piece.first == last;
    if (!edge) held_bytes_ -= piece.second.size();
    return !edge;
  });
}

const std::vector<std::byte>* HttpSource::piece_at(std::uint64_t offset,
                                                   std::size_t& skipped) const {
  auto after = held_.upper_bound(offset);
  if (after == held_.begin()) return nullptr;
  const auto& [begin, bytes] = *--after;
  if (offset - begin >= bytes.size()) return nullptr;
  skipped = static_cast<std::size_t>(offset - begin);
  return &bytes;
}

Result<std::size_t> HttpSource::read(std::span<std::byte> into) {
  failure_.clear();
  if (stream_) {
    const std::size_t got = stream_->read(into);
    failure_ = stream_->failure();
    cost_.bytes += got;
    return failure_.empty() ? Result<std::size_t>(got) : Status::io_failed;
  }
  const auto wanted = static_cast<std::size_t>(
      std::min<std::uint64_t>(into.size(), *size_ - std::min(at_, *size_)));
  for (std::size_t got = 0; got < wanted;) {
    std::size_t skipped = 0;
    const auto* const piece = piece_at(at_ + got, skipped);
    if (piece == nullptr) {
      const std::uint64_t rest = wanted - got;
      if (!bring(missing(std::vector<ByteRange>{{at_ + got, std::max(rest, window_)}}))) {
        return Status::io_failed;
      }
      window_ = std::min(2 * window_, kMaxWindow);
      continue;
    }
    const std::size_t some = std::min(wanted - got, piece->size() - skipped);
    std::memcpy(into.data() + got, piece->data() + skipped, some);
    got += some;
  }
  at_ += wanted;
  return wanted;
}

Status HttpSource::seek(std::uint64_t offset) {
  if (!size_ || offset > *size_) return Status::io_failed;
  at_ = offset;
  return Status::ok;
}

bool HttpSource::prefetch(std::span<const ByteRange> ranges) {
  if (stream_) return false;
  // What fails here fails again when it is read.
  (void)bring(missing(ranges));
  failure_.clear();
  return true;
}

/// The parts of ranges that are not held, in order.
std::vector<ByteRange> HttpSource::missing(std::span<const ByteRange> ranges) const {
  std::vector<ByteRange> parts;
  for (const ByteRange& range : ranges) {
    std::uint64_t at = range.offset;
    if (at >= *size_) continue;
    const std::uint64_t end = at + std::min(range.size, *size_ - at);
    while (at < end) {
      std::size_t skipped = 0;
      if (const auto* const piece = piece_at(at, skipped)) {
        at += piece->size() - skipped;
        continue;
      }
      const auto next = held_.upper_bound(at);
      const std::uint64_t until = next == held_.end() ? end : std::min(end, next->first);
      parts.push_back({at, until - at});
      at = until;
    }
  }
  std::sort(parts.begin(), parts.end(),
            [](const ByteRange& a, const ByteRange& b) { return a.offset < b.offset; });
  return parts;
}

/// Ranges in order, with what lies between near ones unless it is held.
std::vector<ByteRange> HttpSource::joined(std::span<const ByteRange> ranges) const {
  std::vector<ByteRange> all;
  for (const ByteRange& range : ranges) {
    if (!all.empty()) {
      ByteRange& last = all.back();
      const std::uint64_t end = last.offset + last.size;
      const auto next = held_.lower_bound(end);
      const bool apart = next != held_.end() && next->first < range.offset;
      if (range.offset <= end || (range.offset - end <= kGap && !apart)) {
        last.size = std::max(end, range.offset + range.size) - last.offset;
        continue;
      }
    }
    all.push_back(range);
  }
  return all;
}

/// Asks for ranges that are missing and in order. False: see failure_.
bool HttpSource::bring(std::span<const ByteRange> ranges) {
  std::vector<HttpRequest> requests;
  std::uint64_t bytes = 0;
  for (const ByteRange& range : joined(ranges)) {
    for (std::uint64_t done = 0; done < range.size && bytes < kMaxHeld;) {
      const std::uint64_t size = std::min(range.size - done, kMaxPart);
      // Of a file that grows the server would say that it has changed, rather than the part.
      requests.push_back({range.offset + done, size, false, grows_ ? "" : mark_});
      done += size;
      bytes += size;
    }
  }
  if (requests.empty()) return true;
  make_room(bytes);
  for (std::size_t at = 0; at < requests.size(); at += kTogether) {
    const std::size_t some = std::min(kTogether, requests.size() - at);
    const auto first = requests.begin() + static_cast<std::ptrdiff_t>(at);
    if (!bring({first, first + static_cast<std::ptrdiff_t>(some)})) return false;
  }
  return true;
}

/// Sends requests, again those that fail on the way.
bool HttpSource::bring(std::vector<HttpRequest> requests) {
  for (int tries = 0;; ++tries) {
    const std::uint64_t known = *size_;
    std::vector<HttpAnswer> answers = ask(requests);
    std::vector<HttpRequest> again;
    bool away = false;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      failure_ = fault(answers[i], requests[i]);
      const bool grown = !failure_.empty() && is_changed(answers[i]) && has_grown(known);
      // What has grown since is the same up to there, however fast it grows.
      if (failure_.empty() ||
          (grown && is_part(answers[i], requests[i]) && answers[i].total >= known)) {
        keep(requests[i].first, std::move(answers[i].body));
        continue;
      }
      away = away || !grown;
      if (tries == tries_ || (!grown && !is_transient(answers[i]))) return false;
      again.push_back(std::move(requests[i]));
      again.back().mark.clear();
    }
    failure_.clear();
    if (again.empty()) return true;
    if (away) pause(tries);
    requests = std::move(again);
  }
}

bool HttpSource::refresh() {
  failure_.clear();
  if (!size_) return true;
  // The last bytes that are held again: a file that has others is another.
  constexpr std::uint64_t kOverlap = 64;
  const auto& [offset, last] = *held_.rbegin();
  const std::uint64_t end = offset + last.size();
  const auto known = std::min<std::uint64_t>(kOverlap, last.size());
  const HttpRequest request{end - known, known + kFirst, false, ""};
  HttpAnswer answer = std::move(ask_again({&request, 1})[0]);
  if (answer.status != 206 || !answer.failure.empty()) {
    failure_ = answer.status == 0 ? answer.failure : status_text(answer);
    return false;
  }
  const bool grown = answer.total > size_;
  const bool same =
      (grown || (answer.total == size_ && answer.mark == mark_)) && answer.first == request.first &&
      answer.body.size() == std::min(request.size, *answer.total - request.first) &&
      std::equal(last.end() - static_cast<std::ptrdiff_t>(known), last.end(), answer.body.begin());
  if (!same) {
    failure_ = "was replaced by another file; run the command again";
    return false;
  }
  if (const std::uint64_t old = known + *size_ - end; old < answer.body.size()) {
    answer.body.erase(answer.body.begin(), answer.body.begin() + static_cast<std::ptrdiff_t>(old));
    make_room(answer.body.size());
    keep(*size_, std::move(answer.body));
  }
  size_ = answer.total;
  mark_ = answer.mark;
  grows_ = grows_ || grown;
  return true;
}

/// True if an answer is of another state of the file.
bool HttpSource::is_changed(const HttpAnswer& answer) const {
  return answer.status == 200 || answer.status == 416 ||
         (answer.status == 206 && (answer.total != size_ || answer.mark != mark_));
}

/// True if the file is the same with more at its end than what was known. Keeps failure_.
bool HttpSource::has_grown(std::uint64_t known) {
  const std::string failure = failure_;
  const bool grown = *size_ > known || (refresh() && *size_ > known);
  failure_ = failure;
  return grown;
}

/// True for the bytes that were asked for, of any state of the file.
bool HttpSource::is_part(const HttpAnswer& answer, const HttpRequest& request) {
  return answer.status == 206 && answer.failure.empty() && answer.first == request.first &&
         !answer.more && answer.body.size() == request.size;
}

/// What is wrong with an answer; empty: nothing.
std::string HttpSource::fault(const HttpAnswer& answer, const HttpRequest& request) const {
  if (answer.status == 0 || (!answer.failure.empty() && answer.status < 400)) {
    return fmt::format("{}; check the connection and try again", answer.failure);
  }
  if (is_changed(answer)) return "changed while it was read; run the command again";
  if (answer.status != 206) return status_text(answer);
  if (!is_part(answer, request)) {
    return "the server sends other bytes than those it was asked for";
  }
  return {};
}

}  // namespace gicodec::tools

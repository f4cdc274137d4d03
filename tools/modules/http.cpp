#include "modules/http.h"

#include "modules/module.h"

#include <curl/curl.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <string_view>
#include <utility>

namespace gicodec::tools {
namespace {

constexpr long kConnections = 8, kRedirects = 5;
constexpr long kConnectSeconds = 10;
/// A server that sends fewer bytes a second for so many seconds is given up.
constexpr long kSlowest = 100, kSlowSeconds = 30;
/// Milliseconds between questions whether to stop.
constexpr int kTurn = 200;
constexpr const char* kStopped = "interrupted";
/// Bytes that a stream holds at most.
constexpr std::size_t kAhead = std::size_t{1} << 20;

/// libcurl itself, once for all that use it.
struct Library {
  bool there = curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
};
bool is_there() {
  static const Library library;
  return library.there;
}

template <auto function>
struct Close {
  template <typename T>
  void operator()(T* what) const noexcept {
    (void)function(what);
  }
};
using Easy = std::unique_ptr<CURL, Close<curl_easy_cleanup>>;
using Multi = std::unique_ptr<CURLM, Close<curl_multi_cleanup>>;
using List = std::unique_ptr<curl_slist, Close<curl_slist_free_all>>;

bool equal_names(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::optional<std::uint64_t> number_of(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "bytes 0-99/1000"; the total may be "*".
void take_content_range(std::string_view text, HttpAnswer& answer) {
  constexpr std::string_view kUnit = "bytes ";
  const auto dash = text.find('-'), slash = text.find('/');
  if (!text.starts_with(kUnit) || dash == std::string_view::npos ||
      slash == std::string_view::npos || slash < dash) {
    return;
  }
  answer.first = number_of(text.substr(kUnit.size(), dash - kUnit.size()));
  answer.total = number_of(text.substr(slash + 1));
}

/// A request under way.
struct Transfer {
  Easy easy;
  List headers;
  HttpAnswer answer;
  std::uint64_t size = 0;
};

void take_header(std::string_view line, HttpAnswer& answer) {
  if (line.starts_with("HTTP/")) {  // of the answer behind a redirect
    answer = {};
    return;
  }
  const auto colon = line.find(':');
  if (colon == std::string_view::npos) return;
  const std::string_view name = line.substr(0, colon), value = trimmed(line.substr(colon + 1));
  if (equal_names(name, "content-range")) take_content_range(value, answer);
  if (equal_names(name, "content-encoding")) answer.packing = value;
  if (equal_names(name, "content-type")) answer.type = value;
  // A weak tag is no promise about bytes.
  if (equal_names(name, "etag") && value.starts_with('"')) answer.mark = value;
  if (equal_names(name, "last-modified") && answer.mark.empty()) answer.mark = value;
}

std::size_t on_header(char* data, std::size_t, std::size_t size, void* transfer) noexcept {
  try {
    take_header({data, size}, static_cast<Transfer*>(transfer)->answer);
  } catch (const std::bad_alloc&) {
    return 0;
  }
  return size;
}

/// Takes as many bytes as were asked for, and ends the transfer where there are more.
std::size_t on_body(char* data, std::size_t, std::size_t size, void* given) noexcept {
  auto& transfer = *static_cast<Transfer*>(given);
  auto& body = transfer.answer.body;
  const auto room = static_cast<std::size_t>(transfer.size) - body.size();
  const auto* const bytes = reinterpret_cast<const std::byte*>(data);
  try {
    body.insert(body.end(), bytes, bytes + std::min(room, size));
  } catch (const std::bad_alloc&) {
    return 0;
  }
  if (size <= room) return size;
  transfer.answer.more = true;
  return 0;
}

class CurlFile final : public HttpFile {
 public:
  explicit CurlFile(const HttpOptions& options) : options_(options), multi_(curl_multi_init()) {
    curl_multi_setopt(multi_.get(), CURLMOPT_MAX_TOTAL_CONNECTIONS, kConnections);
    curl_multi_setopt(multi_.get(), CURLMOPT_PIPELINING, CURLPIPE_MULTIPLEX);
  }
  [[nodiscard]] bool is_open() const noexcept { return multi_ != nullptr; }

  std::vector<HttpAnswer> get(std::span<const HttpRequest> requests) override {
    std::vector<Transfer> transfers(requests.size());
    for (std::size_t i = 0; i < requests.size(); ++i) begin(requests[i], transfers[i]);
    finish(transfers);
    std::vector<HttpAnswer> answers;
    for (Transfer& transfer : transfers) {
      if (transfer.easy) curl_multi_remove_handle(multi_.get(), transfer.easy.get());
      answers.push_back(std::move(transfer.answer));
    }
    return answers;
  }

  std::unique_ptr<HttpStream> stream() override;

 private:
  friend class CurlStream;
  /// A request without its part; null if memory ran out.
  [[nodiscard]] Easy make(Transfer& transfer, const std::string& mark) const;
  void begin(const HttpRequest& request, Transfer& transfer);
  void finish(std::vector<Transfer>& transfers);

  HttpOptions options_;
  Multi multi_;
};

Easy CurlFile::make(Transfer& transfer, const std::string& mark) const {
  Easy easy(curl_easy_init());
  if (!easy) return easy;
  const auto set = [&](CURLoption option, auto value) {
    curl_easy_setopt(easy.get(), option, value);
  };
  const bool safe = equal_names(std::string_view(options_.url).substr(0, 6), "https:");
  set(CURLOPT_URL, options_.url.c_str());
  set(CURLOPT_PROTOCOLS_STR, "http,https");
  set(CURLOPT_FOLLOWLOCATION, 1L);
  set(CURLOPT_MAXREDIRS, kRedirects);
  set(CURLOPT_REDIR_PROTOCOLS_STR, safe ? "https" : "http,https");
  set(CURLOPT_NOSIGNAL, 1L);
  set(CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
  set(CURLOPT_LOW_SPEED_LIMIT, kSlowest);
  set(CURLOPT_LOW_SPEED_TIME, kSlowSeconds);
  set(CURLOPT_PIPEWAIT, safe ? 1L : 0L);
  set(CURLOPT_USERAGENT, options_.agent.c_str());
  if (!options_.token.empty()) {
    set(CURLOPT_HTTPAUTH, CURLAUTH_BEARER);
    set(CURLOPT_XOAUTH2_BEARER, options_.token.c_str());
  }
  if (options_.direct) set(CURLOPT_NOPROXY, "*");
  if (!options_.ca.empty()) set(CURLOPT_CAINFO, options_.ca.c_str());
  if (!mark.empty()) {
    transfer.headers.reset(curl_slist_append(nullptr, ("If-Range: " + mark).c_str()));
    if (!transfer.headers) return nullptr;
    set(CURLOPT_HTTPHEADER, transfer.headers.get());
  }
  return easy;
}

void CurlFile::begin(const HttpRequest& request, Transfer& transfer) {
  transfer.size = request.size;
  transfer.easy = make(transfer, request.mark);
  if (!transfer.easy) {
    transfer.answer.failure = "memory ran out";
    return;
  }
  CURL* const easy = transfer.easy.get();
  std::string range;
  if (!request.from_end) range = std::to_string(request.first);
  range += '-';
  range += std::to_string(request.from_end ? request.size : request.first + request.size - 1);
  curl_easy_setopt(easy, CURLOPT_RANGE, range.c_str());
  curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, on_header);
  curl_easy_setopt(easy, CURLOPT_HEADERDATA, &transfer);
  curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_body);
  curl_easy_setopt(easy, CURLOPT_WRITEDATA, &transfer);
  curl_easy_setopt(easy, CURLOPT_PRIVATE, &transfer);
  if (curl_multi_add_handle(multi_.get(), easy) != CURLM_OK) {
    transfer.answer.failure = "memory ran out";
    transfer.easy.reset();
  }
}

/// Status and address of an answer, and why it is not whole.
void end(CURLcode result, CURL* easy, HttpAnswer& answer) {
  curl_easy_getinfo(easy, CURLINFO_RESPONSE_CODE, &answer.status);
  const char* url = nullptr;
  curl_easy_getinfo(easy, CURLINFO_EFFECTIVE_URL, &url);
  if (url != nullptr) answer.url = url;
  if (result != CURLE_OK && !answer.more) answer.failure = curl_easy_strerror(result);
}

void CurlFile::finish(std::vector<Transfer>& transfers) {
  for (int running = 1; running > 0;) {
    CURLMcode code = curl_multi_perform(multi_.get(), &running);
    if (code == CURLM_OK && running > 0) {
      code = curl_multi_poll(multi_.get(), nullptr, 0, kTurn, nullptr);
    }
    const bool stopped = options_.is_stopped != nullptr && options_.is_stopped();
    if (code == CURLM_OK && !stopped) continue;
    for (Transfer& transfer : transfers) {
      transfer.answer.failure = stopped ? kStopped : curl_multi_strerror(code);
    }
    return;
  }
  int left = 0;
  while (const CURLMsg* const message = curl_multi_info_read(multi_.get(), &left)) {
    Transfer* transfer = nullptr;
    curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &transfer);
    if (message->msg == CURLMSG_DONE && transfer != nullptr) {
      end(message->data.result, message->easy_handle, transfer->answer);
    }
  }
}

class CurlStream final : public HttpStream {
 public:
  explicit CurlStream(const CurlFile& file)
      : multi_(curl_multi_init()), is_stopped_(file.options_.is_stopped) {
    transfer_.easy = file.make(transfer_, {});
    CURL* const easy = transfer_.easy.get();
    if (multi_ == nullptr || easy == nullptr) {
      failure_ = "memory ran out";
      return;
    }
    curl_easy_setopt(easy, CURLOPT_FAILONERROR, 1L);
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_stream);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, this);
    if (curl_multi_add_handle(multi_.get(), easy) != CURLM_OK) failure_ = "memory ran out";
  }
  ~CurlStream() override {
    if (multi_ && transfer_.easy) curl_multi_remove_handle(multi_.get(), transfer_.easy.get());
  }
  CurlStream(const CurlStream&) = delete;
  CurlStream& operator=(const CurlStream&) = delete;

  std::size_t read(std::span<std::byte> into) override {
    std::size_t got = 0;
    while (got < into.size() && (at_ < held_.size() || go_on())) {
      const std::size_t some = std::min(into.size() - got, held_.size() - at_);
      std::memcpy(into.data() + got, held_.data() + at_, some);
      got += some;
      at_ += some;
    }
    return got;
  }
  const std::string& failure() const noexcept override { return failure_; }

 private:
  /// Holds bytes until there are enough, and takes the rest again later.
  static std::size_t on_stream(char* data, std::size_t, std::size_t size, void* given) noexcept {
    auto& self = *static_cast<CurlStream*>(given);
    if (self.held_.size() + size > kAhead && !self.held_.empty()) {
      self.paused_ = true;
      return CURL_WRITEFUNC_PAUSE;
    }
    const auto* const bytes = reinterpret_cast<const std::byte*>(data);
    try {
      self.held_.insert(self.held_.end(), bytes, bytes + size);
    } catch (const std::bad_alloc&) {
      return 0;
    }
    return size;
  }

  /// Brings more bytes; false at the end.
  bool go_on() {
    held_.clear();
    at_ = 0;
    while (held_.empty() && !ended_ && failure_.empty()) {
      if (std::exchange(paused_, false)) curl_easy_pause(transfer_.easy.get(), CURLPAUSE_CONT);
      int running = 0;
      CURLMcode code = curl_multi_perform(multi_.get(), &running);
      if (code == CURLM_OK && running > 0 && held_.empty()) {
        code = curl_multi_poll(multi_.get(), nullptr, 0, kTurn, nullptr);
      }
      if (code != CURLM_OK) failure_ = curl_multi_strerror(code);
      if (is_stopped_ != nullptr && is_stopped_()) failure_ = kStopped;
      int left = 0;
      while (const CURLMsg* const message = curl_multi_info_read(multi_.get(), &left)) {
        ended_ = true;
        if (message->data.result != CURLE_OK) failure_ = curl_easy_strerror(message->data.result);
      }
    }
    return !held_.empty();
  }

  Multi multi_;
  bool (*is_stopped_)() noexcept;
  Transfer transfer_;
  std::vector<std::byte> held_;
  std::size_t at_ = 0;
  bool paused_ = false, ended_ = false;
  std::string failure_;
};

std::unique_ptr<HttpStream> CurlFile::stream() { return std::make_unique<CurlStream>(*this); }

std::unique_ptr<HttpFile> open(const HttpOptions& options) {
  if (!is_there()) return nullptr;
  auto file = std::make_unique<CurlFile>(options);
  if (!file->is_open()) return nullptr;
  return file;
}

}  // namespace

extern "C" GICODEC_MODULE_EXPORT const HttpModule gicodec_module;
const HttpModule gicodec_module{{"gicodec-http"}, open};

}  // namespace gicodec::tools

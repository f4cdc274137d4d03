#include "nats_tracks.h"

#include "dump/error.h"
#include "dump/text.h"
#include "dump/url.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <span>
#include <utility>

namespace gicodec::streaming {
namespace {

using nlohmann::json;
using tools::Exit;
using tools::fail;
using tools::NatsMessage;

constexpr std::size_t kMaxPrefix = 64;

bool is_plain(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

NatsMessage request(std::string subject, const std::string& reply, const json& body) {
  NatsMessage message;
  message.subject = std::move(subject);
  message.reply = reply;
  if (body.is_null()) return message;
  message.data = bytes_of(nlohmann::to_string(body));
  return message;
}

/// What an answer says; null if it is no JSON.
json parsed(const NatsMessage& message) {
  const auto* const text = reinterpret_cast<const char*>(message.data.data());
  return json::parse(text, text + message.data.size(), nullptr, false);
}

std::int64_t nanoseconds(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

/// For which a message that is published again is known: JetStream wants no more than it keeps.
double duplicate_seconds(const StreamSettings& settings) {
  return std::min(30.0, settings.keep_seconds);
}

NatsMessage make_stream(const std::string& name, const std::vector<std::string>& subjects,
                        const StreamSettings& settings, const json& more, bool exists,
                        const std::string& reply) {
  json config{
      {"name", name},          {"subjects", subjects},
      {"retention", "limits"}, {"discard", "old"},
      {"storage", "memory"},   {"num_replicas", settings.replicas},
      {"allow_direct", true},  {"duplicate_window", nanoseconds(duplicate_seconds(settings))}};
  config.update(more);
  return request(fmt::format("$JS.API.STREAM.{}.{}", exists ? "UPDATE" : "CREATE", name), reply,
                 config);
}

}  // namespace

std::vector<std::string> nats_urls(const std::string& urls, const char* flag) {
  std::vector<std::string> all;
  for (std::size_t first = 0; first <= urls.size();) {
    const std::size_t end = std::min(urls.find(',', first), urls.size());
    std::string url = urls.substr(first, end - first);
    const bool known = url.starts_with("nats://") || url.starts_with("tls://");
    if (!known || url.size() <= url.find("//") + 2)
      fail(Exit::usage,
           "{}: expected nats://HOST:PORT or tls://HOST:PORT, several with commas between, not "
           "\"{}\"",
           flag, known ? url : tools::printable(url.substr(url.rfind('@') + 1)));
    if (url.find('@') != std::string::npos)
      fail(Exit::usage,
           "{}: {}: other users of this machine could read a password there; use "
           "--nats-user and --nats-password-file",
           flag, tools::shown_url(url));
    all.push_back(std::move(url));
    first = end + 1;
  }
  return all;
}

std::unique_ptr<tools::NatsConnection> open_nats(const NatsFlags& flags, const char* program,
                                                 double timeout) {
  tools::NatsOptions options;
  options.urls = nats_urls(flags.urls, "--nats");
  options.name = program;
  options.user = flags.user;
  options.ca = flags.ca;
  options.timeout = timeout;
  options.password = flags.password;
  if (!flags.password.empty()) {
    for (const std::string& url : options.urls) {
      if (url.starts_with("nats://") && flags.ca.empty() &&
          !tools::is_loopback(tools::host_of(url)))
        fail(Exit::usage, "{}: the password would go there in clear; use tls://", url);
    }
  }
  auto connection = tools::nats_module().open(options);
  if (connection == nullptr) fail(Exit::internal, "memory ran out");
  return connection;
}

bool is_refused(const tools::NatsState& state) {
  return state.failure.find("uthoriz") != std::string::npos ||
         state.failure.find("ermissions") != std::string::npos;
}

std::string nats_failure(const tools::NatsState& state) {
  const std::string text = state.failure.empty() ? "no answer" : tools::printable(state.failure);
  const bool tls = state.failure.find("SSL") != std::string::npos ||
                   state.failure.find("certificate") != std::string::npos;
  return fmt::format("{}{}", text,
                     tls ? "; --nats-ca names the authority of its certificate"
                     : is_refused(state)
                         ? "; --nats-user and --nats-password-file name a user that may, "
                           "--nats-prefix a prefix that it may use"
                         : "");
}

std::string subject_token(std::string_view name) {
  std::string token;
  for (const char c : name) {
    if (is_plain(c)) {
      token += c;
    } else {
      token += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return token.empty() ? "%" : token;
}

TrackSubjects::TrackSubjects(const std::string& prefix) : prefix_(prefix) {
  const bool good = !prefix.empty() && prefix.size() <= kMaxPrefix && prefix.front() != '.' &&
                    prefix.back() != '.' && prefix.find("..") == std::string::npos &&
                    std::ranges::all_of(prefix, [](char c) { return is_plain(c) || c == '.'; });
  if (!good)
    fail(Exit::usage,
         "--nats-prefix: expected letters, digits, '-' and '_', with single dots "
         "between, at most {} characters, not \"{}\"",
         kMaxPrefix, tools::printable(prefix));
  std::string name = prefix;
  std::ranges::replace(name, '.', '~');  // which no prefix has
  kept_ = name + "-last";
  updates_ = name + "-updates";
}

std::string TrackSubjects::object(const TrackName& track, std::uint32_t number) const {
  const auto [volume, texture, place] = track;
  return fmt::format("{}.{}.{}.{}.{}.{}{}", prefix_, subject_token(volume), subject_token(texture),
                     place.x, place.y, place.z,
                     number == 0 ? std::string() : fmt::format(".{}", number));
}

std::vector<std::string> TrackSubjects::kept_subjects() const {
  return {prefix_ + ".*.*.*.*.*", list(), tick(), publisher()};
}

std::vector<std::string> TrackSubjects::update_subjects() const {
  return {prefix_ + ".*.*.*.*.*.*"};
}

NatsMessage make_kept_stream(const TrackSubjects& subjects, const StreamSettings& settings,
                             bool exists, const std::string& reply) {
  return make_stream(subjects.kept_stream(), subjects.kept_subjects(), settings, json::object(),
                     exists, reply);
}

NatsMessage make_update_stream(const TrackSubjects& subjects, const StreamSettings& settings,
                               bool exists, const std::string& reply) {
  return make_stream(
      subjects.update_stream(), subjects.update_subjects(), settings,
      {{"max_age", nanoseconds(settings.keep_seconds)}, {"max_bytes", settings.keep_bytes}}, exists,
      reply);
}

std::uint64_t number_in(std::string_view text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

NatsMessage make_claim(const TrackSubjects& subjects, std::uint64_t epoch) {
  NatsMessage message;
  message.subject = subjects.publisher();
  message.data = bytes_of(fmt::format("{}", epoch));
  return message;
}

std::uint64_t claimed_epoch(const NatsMessage& message) {
  return number_in({reinterpret_cast<const char*>(message.data.data()), message.data.size()});
}

NatsMessage get_last(const std::string& stream, const std::string& subject,
                     const std::string& reply) {
  return request(fmt::format("$JS.API.DIRECT.GET.{}.{}", stream, subject), reply, nullptr);
}

StreamAnswer stream_answer(const NatsMessage& message) {
  StreamAnswer answer;
  const json said = parsed(message);
  if (!message.status.empty() || !said.is_object()) {
    answer.error = -1;
    answer.text = message.status == "503" ? "no server with JetStream answers" : message.status;
    return answer;
  }
  if (const auto error = said.find("error"); error != said.end() && error->is_object()) {
    answer.error = -1;
    if (const auto code = error->find("err_code"); code != error->end() && code->is_number())
      answer.error = code->get<int>();
    if (const auto text = error->find("description"); text != error->end() && text->is_string())
      answer.text = text->get<std::string>();
    return answer;
  }
  if (const auto stream = said.find("stream"); stream != said.end() && stream->is_string())
    answer.stream = stream->get<std::string>();
  if (const auto sequence = said.find("seq"); sequence != said.end() && sequence->is_number())
    answer.sequence = sequence->get<std::uint64_t>();
  return answer;
}

}  // namespace gicodec::streaming

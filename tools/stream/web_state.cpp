#include "web_state.h"

#include "dump/error.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <utility>

namespace gicodec::streaming {
namespace {

/// Received messages of a link that wait for next(). A peer beyond it floods. lws_rx_flow_control()
/// could make it wait, but sends libwebsockets 4.1 into an endless loop over TLS.
constexpr std::size_t kMaxWaiting = 4096;

}  // namespace

WebState::WebState(const NetOptions& options_in)
    : options(options_in), wake_up(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (wake_up < 0) tools::fail(tools::Exit::io, "no more files can be opened");
}

WebState::~WebState() { ::close(wake_up); }

WebLink* WebState::add(std::unique_ptr<WebLink> link) {
  const std::lock_guard lock(mutex);
  WebLink* const raw = link.get();
  links.emplace(raw, std::move(link));
  return raw;
}

void WebState::push(NetEvent event) {
  std::list<NetEvent> one;
  one.push_back(std::move(event));
  push(one);
}

void WebState::push(std::list<NetEvent>& event) noexcept {
  events.splice(events.end(), event);
  const std::uint64_t one = 1;
  if (events.size() > 1) return;
  [[maybe_unused]] const auto written = ::write(wake_up, &one, sizeof one);
}

void WebState::add_event(WebLink* link, NetEvent::Type kind, Reason reason) {
  NetEvent event;
  event.type = kind;
  event.link = {nullptr, link};
  event.reason = reason;
  const std::lock_guard lock(mutex);
  if (!link->abandoned) push(std::move(event));
}

void WebState::receive(WebLink* link, std::span<const std::byte> bytes, const WebFrame& frame) {
  if (link->broken) return;
  link->payload += bytes.size();
  if (!frame.binary) return refuse(link, Reason::malformed);
  const std::size_t most = options.max_received - link->partial.size();
  if (bytes.size() > most || frame.left > most - bytes.size())
    return refuse(link, Reason::too_large);
  link->partial.insert(link->partial.end(), bytes.begin(), bytes.end());
  if (!frame.final) return;
  ++link->messages;
  NetEvent event;
  event.type = NetEvent::Type::received;
  event.link = {nullptr, link};
  event.message = std::exchange(link->partial, {});
  std::unique_lock lock(mutex);
  if (link->abandoned) return;
  if (link->waiting < kMaxWaiting && link->waiting_bytes <= options.max_received) {
    ++link->waiting;
    link->waiting_bytes += event.message.size();
    return push(std::move(event));
  }
  lock.unlock();
  refuse(link, Reason::flood);
}

void WebState::refuse(WebLink* link, Reason reason) {
  add_event(link, NetEvent::Type::broken, reason);
  link->broken = true;
  link->partial = {};
}

void WebState::closed(WebLink* link, bool announced, std::initializer_list<std::string_view> why,
                      bool final) noexcept {
  const std::lock_guard lock(mutex);
  link->gone = true;
  link->unsent.clear();
  link->unsent_bytes = 0;
  if (link->abandoned || !announced) return forget(link);
  NetEvent& event = link->last.front();
  event.type = NetEvent::Type::closed;
  event.link = {nullptr, link};
  event.final = final;
  try {
    for (const std::string_view part : why) event.why += part;
  } catch (const std::bad_alloc&) {
    event.why.clear();
  }
  push(link->last);
}

}  // namespace gicodec::streaming

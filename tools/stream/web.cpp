#include "web.h"

#include "clock.h"
#include "web_loop.h"
#include "web_state.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

namespace gicodec::streaming {
namespace {

constexpr std::size_t kFiles = 128;  ///< of the program beside connections

}  // namespace

struct Web::State : WebState {
  using WebState::WebState;

  void wake() { loop->wake(); }

  WebLink* closed = nullptr;      ///< its last event was taken
  std::unique_ptr<WebLoop> loop;  // Last: ends before what it uses does.
};

Web::Web(const WebListen& listen, TlsContext certificate, const NetOptions& options)
    : state_(std::make_unique<State>(options)) {
  state_->listen = listen;
  if (!listen.page.empty()) state_->files = WebFiles(listen.page);
  if (!listen.scene.empty()) {
    state_->files.add("/scene.glb",
                      std::exchange(state_->listen.scene, {}));  // which need not be kept twice
  }
  allow_files(options.links + HalfOpen::kMax + kFiles);
  state_->listener = listen_tcp(listen.address);
  state_->loop = std::make_unique<WebLoop>(*state_, std::move(certificate));
}

Web::Web(const NetOptions& options) : state_(std::make_unique<State>(options)) {
  check_trust(options.trust);
  allow_files(options.links + kFiles);
  state_->loop = std::make_unique<WebLoop>(*state_, nullptr);
}

Web::~Web() = default;

WebLink* Web::connect(const Address& address) {
  auto link = std::make_unique<WebLink>();
  link->server = address;
  link->created = now();
  link->peer.address = link->peer.host = to_string(address);
  WebLink* const raw = state_->add(std::move(link));
  {
    const std::lock_guard lock(state_->mutex);
    state_->wanted.push_back(raw);
  }
  state_->wake();
  return raw;
}

bool Web::next(NetEvent& event) {
  const std::lock_guard lock(state_->mutex);
  if (state_->closed != nullptr) state_->forget(std::exchange(state_->closed, nullptr));
  if (state_->events.empty()) return false;
  event = std::move(state_->events.front());
  state_->events.pop_front();
  if (state_->events.empty()) {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto got = ::read(state_->wake_up, &count, sizeof count);
  }
  WebLink* const link = event.link.web;
  if (event.type == NetEvent::Type::closed) state_->closed = link;
  if (event.type != NetEvent::Type::received) return true;
  --link->waiting;
  link->waiting_bytes -= event.message.size();
  return true;
}

int Web::descriptor() const { return state_->wake_up; }

bool Web::send(WebLink* link, const OutgoingMessage& message) {
  Outgoing out;
  out.bytes.resize(kFrameRoom + message.size());
  auto at = out.bytes.begin() + kFrameRoom;
  for (const auto piece : message.pieces()) {
    at = std::transform(piece.begin(), piece.end(), at,
                        [](std::byte byte) { return static_cast<unsigned char>(byte); });
  }
  const std::lock_guard lock(state_->mutex);
  if (link->gone || link->closing) return false;
  if (link->unsent_bytes >= state_->options.max_unsent) {
    // Drops queued messages before the reason, except one that is being sent.
    while (link->unsent.size() > 1) {
      link->unsent_bytes -= link->unsent.back().bytes.size() - kFrameRoom;
      link->unsent.pop_back();
    }
    NetEvent event;
    event.type = NetEvent::Type::broken;
    event.link = {nullptr, link};
    event.reason = Reason::stalled;
    state_->push(std::move(event));
    return false;
  }
  link->unsent_bytes += message.size();
  link->unsent.push_back(std::move(out));
  state_->wake();
  return true;
}

void Web::close(WebLink* link) {
  const std::lock_guard lock(state_->mutex);
  if (link->gone || link->closing) return;
  link->closing = true;
  link->closing_since = now();
  state_->wake();
}

void Web::abandon(WebLink* link) {
  const std::lock_guard lock(state_->mutex);
  std::erase_if(state_->events, [link](const NetEvent& event) { return event.link.web == link; });
  link->abandoned = true;
  const bool begun = std::erase(state_->wanted, link) == 0;
  if (link->gone || !begun) return state_->forget(link);
  state_->wake();
}

std::uint16_t Web::port() const { return port_of(state_->listener); }
const std::string& Web::host_of(const WebLink* link) { return link->peer.host; }
const std::string& Web::address_of(const WebLink* link) { return link->peer.address; }
unsigned Web::round_trip_ms(const WebLink* link) { return link->round_trip_ms; }
void Web::set_tag(WebLink* link, std::uintptr_t tag) { link->tag = tag; }
std::uintptr_t Web::tag(const WebLink* link) { return link->tag; }

TurnedAway Web::turned_away() {
  const std::lock_guard lock(state_->mutex);
  return std::exchange(state_->turned_away, {});
}

void Web::show(std::string metrics) {
  const std::lock_guard lock(state_->mutex);
  state_->shown = {std::move(metrics), now()};
}

void Web::use(TlsContext certificate) {
  const std::lock_guard lock(state_->mutex);
  state_->next_certificate = std::move(certificate);
  state_->wake();
}

}  // namespace gicodec::streaming

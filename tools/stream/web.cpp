#include "web.h"

#include "clock.h"
#include "dump/error.h"
#include "web_link.h"
#include "web_page.h"

#include <libwebsockets.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

constexpr const char* kProtocol = "gicodec";
/// Received messages of a link that nobody has asked for. Beyond, the peer floods: to make it wait
/// instead, with lws_rx_flow_control(), sends libwebsockets 4.1 into an endless loop over TLS.
constexpr std::size_t kMaxWaiting = 4096;
constexpr std::size_t kChunk = 64 << 10;          ///< bytes that leave at once
constexpr std::size_t kRead = 64 << 10;           ///< bytes that are read at once
constexpr std::size_t kFiles = 64;                ///< of the program beside connections
constexpr lws_usec_t kLookAfter = 250'000;        ///< microseconds

std::string header(lws* wsi, lws_token_indexes which) {
  std::array<char, 512> text{};
  const int size = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), which);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
}

WebLink* link_of(lws* wsi) { return static_cast<WebLink*>(lws_get_opaque_user_data(wsi)); }

}  // namespace

struct Web::State {
  explicit State(const NetOptions& options_in) : options(options_in), wake_up(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (wake_up < 0) fail(Exit::io, "no more files can be opened");
  }
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void start();
  void serve();
  void wake() {
    if (!woken.exchange(true)) lws_cancel_service(context);
  }
  WebLink* add(std::unique_ptr<WebLink> link);
  void push(NetEvent event);
  void forget(WebLink* link) { links.erase(link); }

  // The transport's thread.
  static int on_event(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                      std::size_t size);
  int take(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size);
  void accept();
  void take_wishes();
  void begin(WebLink* link);
  int opened(WebLink* link, lws* wsi);
  void receive(WebLink* link, const std::byte* bytes, std::size_t size);
  void refuse(WebLink* link, Reason reason);
  int write(WebLink* link);
  void gone(WebLink* link, const std::string& reason);
  int answer(WebLink* link, lws* wsi);
  void look_after_all();
  static void kill(WebLink* link) {
    lws_set_timeout(link->wsi, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
  }

  struct Timer {
    lws_sorted_usec_list_t sul{};
    State* state = nullptr;
  };

  NetOptions options;
  WebListen listen;
  TlsContext certificate;
  int listener = -1, wake_up = -1;
  lws_protocols protocols[2]{};
  lws_retry_bo_t patience{};
  lws_context* context = nullptr;
  lws_vhost* vhost = nullptr;
  std::atomic<bool> woken = false, stop = false;

  // The transport's thread.
  ssl_ctx_st* server_context = nullptr;
  bool prepared = true;
  WebLink* beginning = nullptr;  ///< that is being connected
  bool failed = false;           ///< it came to nothing at once; `why` says more
  std::string why;
  HalfOpen half_open;
  std::map<std::string, std::size_t> hosts;  ///< connections of each
  std::size_t open_links = 0;
  Timer timer;

  std::mutex mutex;  ///< guards what follows
  std::map<WebLink*, std::unique_ptr<WebLink>> links;
  std::deque<NetEvent> events;
  std::vector<WebLink*> wanted;  ///< connections to begin
  TlsContext next_certificate;
  Shown shown;

  WebLink* closed = nullptr;  ///< the caller's thread: its last event was taken
  std::jthread thread;
};

/// Nothing may be thrown through libwebsockets.
int Web::State::on_event(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                         std::size_t size) {
  auto* const state = static_cast<State*>(lws_context_user(lws_get_context(wsi)));
  try {
    return state->take(wsi, reason, user, in, size);
  } catch (...) {
    return -1;  // No memory for this connection.
  }
}

void Web::State::start() {
  lws_set_log_level(0, nullptr);
  const bool serves = listener >= 0;
  const auto seconds = static_cast<std::uint16_t>(std::ceil(options.timeout));
  patience.secs_since_valid_ping = static_cast<std::uint16_t>(std::max(1, seconds / 2));
  patience.secs_since_valid_hangup =
      std::max<std::uint16_t>(seconds, patience.secs_since_valid_ping + 1);
  protocols[0] = {kProtocol, on_event, 0, serves ? kRead / 16 : kRead, 0, nullptr, 0};
  lws_context_creation_info info{};
  info.user = this;
  info.port = serves ? CONTEXT_PORT_NO_LISTEN_SERVER : CONTEXT_PORT_NO_LISTEN;
  info.protocols = protocols;
  info.options = LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT | LWS_SERVER_OPTION_DISABLE_OS_CA_CERTS |
                 LWS_SERVER_OPTION_EXPLICIT_VHOSTS;
  if (certificate) info.options |= LWS_SERVER_OPTION_CREATE_VHOST_SSL_CTX;
  info.alpn = "http/1.1";
  info.server_string = "gi-server";
  info.gid = info.uid = static_cast<unsigned>(-1);
  info.retry_and_idle_policy = &patience;
  info.pt_serv_buf_size = kRead;
  info.fd_limit_per_thread =
      static_cast<unsigned>((serves ? options.links + HalfOpen::kMost : options.links) + kFiles);
  context = lws_create_context(&info);
  vhost = context == nullptr ? nullptr : lws_create_vhost(context, &info);
  if (vhost == nullptr || !prepared) fail(Exit::io, "TLS or WebSockets cannot be started here");
  timer.state = this;
  if (serves) {
    lws_sock_file_fd_type file{};
    file.filefd = listener;
    if (lws_adopt_descriptor_vhost(vhost, LWS_ADOPT_RAW_FILE_DESC, file, kProtocol, nullptr) ==
        nullptr) {
      fail(Exit::io, "{}: cannot be served", to_string(listen.address));
    }
  }
  thread = std::jthread([this] { serve(); });
}

void Web::State::serve() {
  pthread_setname_np(pthread_self(), "web");
  const auto look_after = [](lws_sorted_usec_list_t* sul) {
    auto* const own = reinterpret_cast<Timer*>(sul);
    own->state->look_after_all();
  };
  timer.sul.cb = look_after;
  lws_sul_schedule(context, 0, &timer.sul, look_after, kLookAfter);
  while (!stop && lws_service(context, 0) >= 0) {
  }
}

Web::State::~State() {
  stop = true;
  if (thread.joinable()) {
    lws_cancel_service(context);
    thread.join();
  }
  if (context != nullptr) {
    lws_sul_schedule(context, 0, &timer.sul, nullptr, LWS_SET_TIMER_USEC_CANCEL);
    lws_context_destroy(context);
  }
  if (wake_up >= 0) ::close(wake_up);
}

WebLink* Web::State::add(std::unique_ptr<WebLink> link) {
  const std::lock_guard lock(mutex);
  WebLink* const raw = link.get();
  links.emplace(raw, std::move(link));
  return raw;
}

/// Precondition: the mutex is held.
void Web::State::push(NetEvent event) {
  events.push_back(std::move(event));
  const std::uint64_t one = 1;
  if (events.size() == 1) static_cast<void>(::write(wake_up, &one, sizeof one));
}

int Web::State::take(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                     std::size_t size) {
  switch (reason) {
    case LWS_CALLBACK_OPENSSL_LOAD_EXTRA_SERVER_VERIFY_CERTS:
      server_context = static_cast<ssl_ctx_st*>(user);
      prepared = demand_tls13(server_context) && use_certificate(server_context, certificate);
      return prepared ? 0 : 1;
    case LWS_CALLBACK_OPENSSL_LOAD_EXTRA_CLIENT_VERIFY_CERTS:
      if (listener >= 0) return 0;
      prepared = demand_tls13(static_cast<ssl_ctx_st*>(user)) &&
                 use_trust(static_cast<ssl_ctx_st*>(user), options.trust);
      return prepared ? 0 : 1;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      take_wishes();
      return 0;
    case LWS_CALLBACK_RAW_RX_FILE:
      accept();
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      return std::string_view(static_cast<const char*>(in)) == "websocket" ? 0 : -1;
    default:
      break;
  }
  WebLink* const link = wsi == nullptr ? nullptr : link_of(wsi);
  if (link == nullptr) return 0;
  switch (reason) {
    case LWS_CALLBACK_OPENSSL_PERFORM_SERVER_CERT_VERIFICATION: {
      auto* const chain = static_cast<x509_store_ctx_st*>(user);
      const std::string refused =
          objection(chain, size != 0, link->server.host, options.trust, link->trusted);
      if (link->why.empty()) link->why = refused;
      return refused.empty() ? 0 : 1;
    }
    case LWS_CALLBACK_HTTP:
      return answer(link, wsi);
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return header(wsi, WSI_TOKEN_GET_URI) == "/" &&
                     lws_hdr_total_length(wsi, WSI_TOKEN_PROTOCOL) > 0
                 ? 0
                 : -1;
    case LWS_CALLBACK_CLIENT_FILTER_PRE_ESTABLISH:
      return link->server.via == Via::plain_web || link->trusted ? 0 : -1;
    case LWS_CALLBACK_ESTABLISHED:
    case LWS_CALLBACK_CLIENT_ESTABLISHED:
      return opened(link, wsi);
    case LWS_CALLBACK_RECEIVE:
    case LWS_CALLBACK_CLIENT_RECEIVE:
      receive(link, static_cast<const std::byte*>(in), size);
      return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
    case LWS_CALLBACK_CLIENT_WRITEABLE:
      return write(link);
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
      lws_set_opaque_user_data(wsi, nullptr);
      gone(link, in == nullptr ? std::string() : std::string(static_cast<const char*>(in), size));
      return 0;
    case LWS_CALLBACK_CLOSED:
    case LWS_CALLBACK_CLIENT_CLOSED:
    case LWS_CALLBACK_WSI_DESTROY:
      lws_set_opaque_user_data(wsi, nullptr);
      gone(link, {});
      return 0;
    default:
      return 0;
  }
}

void Web::State::accept() {
  TcpPeer peer;
  for (std::size_t i = 0; i < HalfOpen::kMost; ++i) {  // Others have their turn as well.
    const int descriptor = accept_tcp(listener, peer);
    if (descriptor < 0) return;
    WebLink* crowded = nullptr;
    const auto others = hosts.find(peer.host);
    const bool full = others != hosts.end() && others->second >= options.links_per_address;
    if (full) crowded = half_open.take(peer.host);
    if (crowded != nullptr) kill(crowded);
    if ((full && crowded == nullptr) || open_links >= options.links) {
      ::close(descriptor);
      continue;
    }
    ++hosts[peer.host];
    auto made = std::make_unique<WebLink>();
    made->peer = peer;
    made->accepted = true;
    made->since = now();
    WebLink* const link = add(std::move(made));
    if (WebLink* const oldest = half_open.add(link); oldest != nullptr) kill(oldest);
    lws_adopt_desc_t adopted{};
    adopted.vh = vhost;
    adopted.type =
        static_cast<lws_adoption_type>(LWS_ADOPT_SOCKET | LWS_ADOPT_HTTP | LWS_ADOPT_ALLOW_SSL);
    adopted.fd.sockfd = descriptor;
    adopted.opaque = link;
    lws* const wsi = lws_adopt_descriptor_vhost_via_info(&adopted);
    // What failed is closed, and gone() has heard of it or not.
    const std::lock_guard lock(mutex);
    if (!links.contains(link)) continue;
    if (wsi != nullptr) {
      link->wsi = wsi;
    } else {
      half_open.remove(link);
      if (--hosts[peer.host] == 0) hosts.erase(peer.host);
      forget(link);
    }
  }
}

/// What the caller's thread has asked for.
void Web::State::take_wishes() {
  woken = false;
  std::vector<WebLink*> begins;
  std::vector<WebLink*> ends;
  TlsContext fresh;
  {
    const std::lock_guard lock(mutex);
    begins.swap(wanted);
    fresh = std::exchange(next_certificate, nullptr);
    for (const auto& [link, owner] : links) {
      if (link->wsi == nullptr || link->gone) continue;
      if (link->abandoned) {
        ends.push_back(link);
      } else if (link->open && (link->closing || !link->unsent.empty())) {
        lws_callback_on_writable(link->wsi);
      }
    }
  }
  if (fresh && server_context != nullptr && use_certificate(server_context, fresh))
    certificate = fresh;
  for (WebLink* const link : ends) kill(link);
  for (WebLink* const link : begins) begin(link);
}

void Web::State::begin(WebLink* link) {
  const std::string host =
      to_string(Address{link->server.host, link->server.port, Via::enet});
  lws_client_connect_info info{};
  info.context = context;
  info.vhost = vhost;
  info.address = link->server.host.c_str();
  info.port = link->server.port;
  info.path = "/";
  info.host = host.c_str();
  info.protocol = info.local_protocol_name = kProtocol;
  info.ietf_version_or_minus_one = -1;
  info.opaque_user_data = link;
  beginning = link;
  failed = false;
  why.clear();
  info.retry_and_idle_policy = &patience;
  // Names are looked at in objection(), those of IPv6 too.
  if (link->server.via == Via::web)
    info.ssl_connection = LCCSCF_USE_SSL | LCCSCF_SKIP_SERVER_CERT_HOSTNAME_CHECK;
  lws* const wsi = lws_client_connect_via_info(&info);
  beginning = nullptr;
  if (wsi == nullptr || failed) return gone(link, why);
  link->wsi = wsi;
}

int Web::State::opened(WebLink* link, lws* wsi) {
  half_open.remove(link);
  ++open_links;
  link->wsi = wsi;
  link->open = true;
  const std::lock_guard lock(mutex);
  NetEvent event;
  event.kind = NetEvent::Kind::opened;
  event.link = {nullptr, link};
  if (!link->abandoned) push(std::move(event));
  return 0;
}

/// What cannot be a message is known before it is kept.
void Web::State::receive(WebLink* link, const std::byte* bytes, std::size_t size) {
  if (link->broken) return;
  link->payload += size;
  if (lws_frame_is_binary(link->wsi) == 0) return refuse(link, Reason::malformed);
  const std::size_t most = options.max_received - link->partial.size();
  if (size > most || lws_remaining_packet_payload(link->wsi) > most - size)
    return refuse(link, Reason::too_large);
  link->partial.insert(link->partial.end(), bytes, bytes + size);
  if (lws_is_final_fragment(link->wsi) == 0) return;
  ++link->messages;
  NetEvent event;
  event.kind = NetEvent::Kind::received;
  event.link = {nullptr, link};
  event.message = std::exchange(link->partial, {});
  {
    const std::lock_guard lock(mutex);
    if (link->waiting < kMaxWaiting && link->waiting_bytes <= options.max_received) {
      ++link->waiting;
      link->waiting_bytes += event.message.size();
      if (!link->abandoned) push(std::move(event));
      return;
    }
  }
  refuse(link, Reason::flood);
}

/// Nothing more is taken from who breaks a rule; the caller says the reason, and closes.
void Web::State::refuse(WebLink* link, Reason reason) {
  link->broken = true;
  link->partial = {};
  NetEvent event;
  event.kind = NetEvent::Kind::broken;
  event.link = {nullptr, link};
  event.reason = reason;
  const std::lock_guard lock(mutex);
  if (!link->abandoned) push(std::move(event));
}

int Web::State::write(WebLink* link) {
  while (lws_send_pipe_choked(link->wsi) == 0) {
    Outgoing* out = nullptr;
    {
      const std::lock_guard lock(mutex);
      if (link->unsent.empty()) {
        if (!link->closing) return 0;
        if (link->broken) return kill(link), 0;  // What it still sends is not waited for.
        lws_close_reason(link->wsi, LWS_CLOSE_STATUS_NORMAL, nullptr, 0);
        return -1;
      }
      out = &link->unsent.front();  // Stays where it is: others are added behind it.
    }
    const std::size_t left = out->bytes.size() - out->room - out->done;
    const std::size_t size = std::min(left, kChunk);
    const int flags = lws_write_ws_flags(LWS_WRITE_BINARY, out->done == 0, size == left);
    if (lws_write(link->wsi, out->bytes.data() + out->room + out->done, size,
                  static_cast<lws_write_protocol>(flags)) < 0) {
      return -1;
    }
    const std::lock_guard lock(mutex);
    out->done += size;
    link->unsent_bytes -= size;
    if (size == left) link->unsent.pop_front();
  }
  lws_callback_on_writable(link->wsi);
  return 0;
}

/// The connection is no more, whatever it was.
void Web::State::gone(WebLink* link, const std::string& reason) {
  if (link == beginning) {
    failed = true;
    why = reason;
    return;
  }
  if (link->open) --open_links;
  half_open.remove(link);
  if (link->accepted) {
    const auto it = hosts.find(link->peer.host);
    if (it != hosts.end() && --it->second == 0) hosts.erase(it);
  }
  const bool announced = link->open || !link->accepted;
  link->open = false;
  link->wsi = nullptr;
  const std::lock_guard lock(mutex);
  link->gone = true;
  link->unsent.clear();
  link->unsent_bytes = 0;
  if (link->abandoned || !announced) return forget(link);
  NetEvent event;
  event.kind = NetEvent::Kind::closed;
  event.link = {nullptr, link};
  event.why = link->why.empty() ? reason : link->why;
  // What answered and was found wanting will be so again.
  event.final = !link->why.empty() || event.why.starts_with("HS:");
  push(std::move(event));
}

int Web::State::answer(WebLink* link, lws* wsi) {
  Shown what;
  {
    const std::lock_guard lock(mutex);
    what = shown;
  }
  const WebRequest request{lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0,
                           header(wsi, WSI_TOKEN_GET_URI),
                           header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION), link->peer.loopback};
  std::string text(LWS_PRE, '\0');
  text += web_answer(request, what, listen.metrics_token, now());
  lws_write(wsi, reinterpret_cast<unsigned char*>(text.data()) + LWS_PRE, text.size() - LWS_PRE,
            LWS_WRITE_HTTP_FINAL);
  return -1;  // One answer for each connection.
}

void Web::State::look_after_all() {
  const double at = now();
  std::vector<WebLink*> ends;
  for (WebLink* const link : half_open.all()) {
    if (at - link->since > options.open_timeout && link->wsi != nullptr) ends.push_back(link);
  }
  std::vector<WebLink*> open;
  {
    const std::lock_guard lock(mutex);
    for (const auto& [link, owner] : links) {
      if (!link->open) continue;
      open.push_back(link);
      if (link->closing && at - link->closing_since > options.timeout) ends.push_back(link);
    }
  }
  for (WebLink* const link : open) {
    const TcpState before = std::exchange(link->tcp, tcp_state(lws_get_socket_fd(link->wsi)));
    // A long message on a slow link is a sign of life too.
    if (link->tcp.read != before.read || link->tcp.taken != before.taken)
      lws_validity_confirmed(link->wsi);
    link->round_trip_ms = link->tcp.round_trip_ms;
    if (!link->broken && floods(*link, at)) refuse(link, Reason::flood);
  }
  for (WebLink* const link : ends) kill(link);
  lws_sul_schedule(context, 0, &timer.sul, timer.sul.cb, kLookAfter);
}

Web::Web(const WebListen& listen, TlsContext certificate, const NetOptions& options)
    : state_(std::make_unique<State>(options)) {
  state_->listen = listen;
  state_->certificate = std::move(certificate);
  allow_files(options.links + HalfOpen::kMost + 2 * kFiles);
  state_->listener = listen_tcp(listen.address);
  state_->start();
}

Web::Web(const NetOptions& options) : state_(std::make_unique<State>(options)) {
  check_trust(options.trust);
  state_->start();
}

Web::~Web() = default;

WebLink* Web::connect(const Address& address) {
  auto link = std::make_unique<WebLink>();
  link->server = address;
  link->since = now();
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
    static_cast<void>(::read(state_->wake_up, &count, sizeof count));
  }
  WebLink* const link = event.link.web;
  if (event.kind == NetEvent::Kind::closed) state_->closed = link;
  if (event.kind != NetEvent::Kind::received) return true;
  --link->waiting;
  link->waiting_bytes -= event.message.size();
  return true;
}

int Web::descriptor() const { return state_->wake_up; }

bool Web::send(WebLink* link, const Message& message) {
  Outgoing out;
  out.room = LWS_PRE;
  out.bytes.resize(LWS_PRE + message.size());
  std::transform(message.begin(), message.end(), out.bytes.begin() + LWS_PRE,
                 [](std::byte byte) { return static_cast<unsigned char>(byte); });
  const std::lock_guard lock(state_->mutex);
  if (link->gone || link->closing) return false;
  if (link->unsent_bytes >= state_->options.max_unsent) {
    // Nothing of what waits needs to go before the reason, but what has begun to.
    while (link->unsent.size() > 1) {
      link->unsent_bytes -= link->unsent.back().bytes.size() - LWS_PRE;
      link->unsent.pop_back();
    }
    NetEvent event;
    event.kind = NetEvent::Kind::broken;
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
  std::erase_if(state_->events,
                [link](const NetEvent& event) { return event.link.web == link; });
  std::erase(state_->wanted, link);
  link->abandoned = true;
  if (link->gone) return state_->forget(link);
  state_->wake();
}

std::uint16_t Web::port() const { return port_of(state_->listener); }
const std::string& Web::host_of(const WebLink* link) { return link->peer.host; }
const std::string& Web::address_of(const WebLink* link) { return link->peer.address; }
unsigned Web::round_trip_ms(const WebLink* link) { return link->round_trip_ms; }
void Web::set_tag(WebLink* link, std::uintptr_t tag) { link->tag = tag; }
std::uintptr_t Web::tag(const WebLink* link) { return link->tag; }

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

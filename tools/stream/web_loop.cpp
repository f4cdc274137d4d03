#include "web_loop.h"

#include "clock.h"
#include "dump/error.h"
#include "web_state.h"

#include <libwebsockets.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

static_assert(kFrameRoom >= LWS_PRE);
constexpr const char* kProtocol = "gicodec";
constexpr std::size_t kChunk = 64 << 10;    ///< bytes that leave at once
constexpr std::size_t kRead = 64 << 10;     ///< bytes that are read at once
constexpr std::size_t kFiles = 64;          ///< of the program beside connections
constexpr lws_usec_t kLookAfter = 250'000;  ///< microseconds
/// Seconds that a client has to read the reason and to close: with what it still sends unread,
/// closing would reset the connection, which overtakes the reason.
constexpr double kReading = 0.4;

std::string header(lws* wsi, lws_token_indexes which) {
  std::array<char, 512> text{};
  const int size = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), which);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
}

WebLink* link_of(lws* wsi) { return static_cast<WebLink*>(lws_get_opaque_user_data(wsi)); }

}  // namespace

struct WebLoop::Loop {
  Loop(WebState& state_in, TlsContext certificate_in)
      : state(state_in), certificate(std::move(certificate_in)) {}
  ~Loop();
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  void start();
  void serve();
  static int on_event(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                      std::size_t size);
  int take(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size);
  void accept();
  WebLink* enter(const TcpPeer& peer);
  void leave(WebLink* link);
  void take_wishes();
  void begin(WebLink* link);
  int opened(WebLink* link, lws* wsi);
  int write(WebLink* link);
  void gone(WebLink* link, const std::string& reason);
  int answer(WebLink* link, lws* wsi);
  void look_after_all();
  /// Ends it soon. One that libwebsockets does not have, not yet or no more, has nothing to end.
  static void kill(WebLink* link) {
    if (link->wsi != nullptr)
      lws_set_timeout(link->wsi, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
  }

  struct Timer {
    lws_sorted_usec_list_t sul{};
    Loop* loop = nullptr;
  };

  WebState& state;
  TlsContext certificate;
  lws_protocols protocols[2]{};
  lws_retry_bo_t patience{};
  lws_context* context = nullptr;
  lws_vhost* vhost = nullptr;
  ssl_ctx_st* server_context = nullptr;
  bool prepared = true;
  WebLink* beginning = nullptr;  ///< that is being connected
  bool failed = false;           ///< it came to nothing at once; `why` says more
  std::string why;
  HalfOpen half_open;
  std::map<std::string, std::size_t> hosts;  ///< connections of each
  std::size_t open_links = 0;
  Timer timer;
  std::atomic<bool> woken = false, stop = false;
  std::jthread thread;
};

/// Nothing may be thrown through libwebsockets.
int WebLoop::Loop::on_event(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                            std::size_t size) {
  auto* const loop = static_cast<Loop*>(lws_context_user(lws_get_context(wsi)));
  try {
    return loop->take(wsi, reason, user, in, size);
  } catch (...) {
    // No memory for this connection; what serves them all stays.
    const bool wishes = reason == LWS_CALLBACK_EVENT_WAIT_CANCELLED;
    if (wishes) loop->woken = true;  // The timer takes them.
    return wishes || reason == LWS_CALLBACK_RAW_RX_FILE ? 0 : -1;
  }
}

void WebLoop::Loop::start() {
  lws_set_log_level(0, nullptr);
  const bool serves = state.listener >= 0;
  const auto seconds = static_cast<std::uint16_t>(std::ceil(state.options.timeout));
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
  info.gid = info.uid = -1;  // As the process is.
  info.retry_and_idle_policy = &patience;
  info.pt_serv_buf_size = kRead;
  info.fd_limit_per_thread = static_cast<unsigned>(
      (serves ? state.options.links + HalfOpen::kMost : state.options.links) + kFiles);
  context = lws_create_context(&info);
  vhost = context == nullptr ? nullptr : lws_create_vhost(context, &info);
  if (vhost == nullptr || !prepared) fail(Exit::io, "TLS or WebSockets cannot be started here");
  timer.loop = this;
  if (serves) {
    lws_sock_file_fd_type file{};
    file.filefd = state.listener;
    if (lws_adopt_descriptor_vhost(vhost, LWS_ADOPT_RAW_FILE_DESC, file, kProtocol, nullptr) ==
        nullptr) {
      fail(Exit::io, "{}: cannot be served", to_string(state.listen.address));
    }
  }
  thread = std::jthread([this] { serve(); });
}

void WebLoop::Loop::serve() {
  pthread_setname_np(pthread_self(), "web");
  const auto look_after = [](lws_sorted_usec_list_t* sul) {
    Loop* const loop = reinterpret_cast<Timer*>(sul)->loop;
    try {
      loop->look_after_all();
      if (loop->woken) loop->take_wishes();  // There was no memory for them when they came.
    } catch (...) {
      loop->woken = true;  // No memory: the next time.
    }
    lws_sul_schedule(loop->context, 0, sul, sul->cb, kLookAfter);
  };
  timer.sul.cb = look_after;
  lws_sul_schedule(context, 0, &timer.sul, look_after, kLookAfter);
  while (!stop && lws_service(context, 0) >= 0) {
  }
}

WebLoop::Loop::~Loop() {
  stop = true;
  if (thread.joinable()) {
    lws_cancel_service(context);
    thread.join();
  }
  if (context == nullptr) return;
  lws_sul_schedule(context, 0, &timer.sul, nullptr, LWS_SET_TIMER_USEC_CANCEL);
  lws_context_destroy(context);
}

int WebLoop::Loop::take(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                        std::size_t size) {
  switch (reason) {
    case LWS_CALLBACK_OPENSSL_LOAD_EXTRA_SERVER_VERIFY_CERTS:
      server_context = static_cast<ssl_ctx_st*>(user);
      prepared = demand_tls13(server_context) && use_certificate(server_context, certificate);
      return prepared ? 0 : 1;
    case LWS_CALLBACK_OPENSSL_LOAD_EXTRA_CLIENT_VERIFY_CERTS:
      if (state.listener >= 0) return 0;
      prepared = demand_tls13(static_cast<ssl_ctx_st*>(user)) &&
                 use_trust(static_cast<ssl_ctx_st*>(user), state.options.trust);
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
          objection(chain, size != 0, link->server.host, state.options.trust, link->trusted);
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
      state.receive(link, {static_cast<const std::byte*>(in), size},
                    {lws_frame_is_binary(wsi) != 0, lws_is_final_fragment(wsi) != 0,
                     lws_remaining_packet_payload(wsi)});
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

void WebLoop::Loop::accept() {
  TcpPeer peer;
  for (std::size_t i = 0; i < HalfOpen::kMost; ++i) {  // Others have their turn as well.
    const int descriptor = accept_tcp(state.listener, peer);
    if (descriptor < 0) return;
    WebLink* const link = enter(peer);
    if (link == nullptr) {
      ::close(descriptor);
      continue;
    }
    lws_adopt_desc_t adopted{};
    adopted.vh = vhost;
    adopted.type =
        static_cast<lws_adoption_type>(LWS_ADOPT_SOCKET | LWS_ADOPT_HTTP | LWS_ADOPT_ALLOW_SSL);
    adopted.fd.sockfd = descriptor;
    adopted.opaque = link;
    lws* const wsi = lws_adopt_descriptor_vhost_via_info(&adopted);
    // What failed is closed, and gone() has heard of it or not.
    const std::lock_guard lock(state.mutex);
    if (!state.links.contains(link)) continue;
    link->wsi = wsi;
    if (wsi != nullptr) continue;
    leave(link);
    state.forget(link);
  }
}

/// A place for a connection; nullptr if there is no room or no memory for it.
WebLink* WebLoop::Loop::enter(const TcpPeer& peer) {
  if (open_links >= state.options.links) return nullptr;
  WebLink* link = nullptr;
  try {
    auto made = std::make_unique<WebLink>();
    made->peer = peer;
    made->accepted = true;
    made->since = now();
    std::size_t& of_host = hosts[peer.host];
    if (of_host >= state.options.links_per_address) {
      WebLink* const crowded = half_open.take(peer.host);
      if (crowded == nullptr) return nullptr;
      kill(crowded);
    }
    link = state.add(std::move(made));
    WebLink* const oldest = half_open.add(link);
    ++of_host;
    if (oldest != nullptr) kill(oldest);
    return link;
  } catch (const std::bad_alloc&) {
    std::erase_if(hosts, [](const auto& host) { return host.second == 0; });
    const std::lock_guard lock(state.mutex);
    state.forget(link);
    return nullptr;
  }
}

/// It does not count any more.
void WebLoop::Loop::leave(WebLink* link) {
  half_open.remove(link);
  if (!link->accepted) return;
  const auto it = hosts.find(link->peer.host);
  if (it != hosts.end() && --it->second == 0) hosts.erase(it);
}

/// What the caller's thread has asked for.
void WebLoop::Loop::take_wishes() {
  woken = false;
  std::vector<WebLink*> begins;
  std::vector<WebLink*> ends;
  TlsContext fresh;
  {
    const std::lock_guard lock(state.mutex);
    for (const auto& [link, owner] : state.links) {
      if (link->wsi == nullptr || link->gone) continue;
      if (link->abandoned) {
        ends.push_back(link);
      } else if (link->open && (link->closing || !link->unsent.empty())) {
        lws_callback_on_writable(link->wsi);
      }
    }
    begins.swap(state.wanted);
    fresh = std::exchange(state.next_certificate, nullptr);
  }
  if (fresh && server_context != nullptr && use_certificate(server_context, fresh))
    certificate = fresh;
  for (WebLink* const link : ends) kill(link);
  for (WebLink* const link : begins) begin(link);
}

void WebLoop::Loop::begin(WebLink* link) {
  const std::string host = to_string(Address{link->server.host, link->server.port, Via::enet});
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

int WebLoop::Loop::opened(WebLink* link, lws* wsi) {
  half_open.remove(link);
  ++open_links;
  link->wsi = wsi;
  link->open = true;
  state.tell(link, NetEvent::Kind::opened);
  return 0;
}

int WebLoop::Loop::write(WebLink* link) {
  while (lws_send_pipe_choked(link->wsi) == 0) {
    Outgoing* out = nullptr;
    {
      const std::lock_guard lock(state.mutex);
      if (link->unsent.empty()) {
        if (!link->closing) return 0;
        if (link->accepted && link->told == 0) link->told = now();
        if (link->accepted && now() - link->told < kReading) return 0;  // look_after_all() ends it.
        if (link->broken) return kill(link), 0;  // What it still sends is not waited for.
        lws_close_reason(link->wsi, LWS_CLOSE_STATUS_NORMAL, nullptr, 0);
        return -1;
      }
      out = &link->unsent.front();  // Stays where it is: others are added behind it.
    }
    const std::size_t left = out->bytes.size() - kFrameRoom - out->done;
    const std::size_t size = std::min(left, kChunk);
    const int flags = lws_write_ws_flags(LWS_WRITE_BINARY, out->done == 0, size == left);
    if (lws_write(link->wsi, out->bytes.data() + kFrameRoom + out->done, size,
                  static_cast<lws_write_protocol>(flags)) < 0) {
      return -1;
    }
    const std::lock_guard lock(state.mutex);
    out->done += size;
    link->unsent_bytes -= size;
    if (size == left) link->unsent.pop_front();
  }
  lws_callback_on_writable(link->wsi);
  return 0;
}

/// The connection is no more, whatever it was.
void WebLoop::Loop::gone(WebLink* link, const std::string& reason) {
  if (link == beginning) {
    failed = true;
    why = reason;
    return;
  }
  if (link->open) --open_links;
  leave(link);
  const bool announced = link->open || !link->accepted;
  link->open = false;
  link->wsi = nullptr;
  // What answered and was found wanting will be so again.
  if (!link->why.empty())
    return state.closed(link, announced, "the server is not trusted: " + link->why, true);
  const bool foreign = reason.starts_with("HS:");  // libwebsockets, of answers to the upgrade
  state.closed(link, announced,
               foreign ? "what answers there is no gi-server; is it the port?" : reason, foreign);
}

int WebLoop::Loop::answer(WebLink* link, lws* wsi) {
  Shown what;
  {
    const std::lock_guard lock(state.mutex);
    what = state.shown;
  }
  const WebRequest request{lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0,
                           header(wsi, WSI_TOKEN_GET_URI),
                           header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION), link->peer.loopback};
  std::string text(LWS_PRE, '\0');
  text += web_answer(request, what, state.listen.metrics_token, now());
  lws_write(wsi, reinterpret_cast<unsigned char*>(text.data()) + LWS_PRE, text.size() - LWS_PRE,
            LWS_WRITE_HTTP_FINAL);
  return -1;  // One answer for each connection.
}

void WebLoop::Loop::look_after_all() {
  const double at = now();
  std::vector<WebLink*> ends;
  for (WebLink* const link : half_open.all()) {
    if (at - link->since > state.options.open_timeout && link->wsi != nullptr) ends.push_back(link);
  }
  std::vector<WebLink*> open;
  {
    const std::lock_guard lock(state.mutex);
    for (const auto& [link, owner] : state.links) {
      if (!link->open) continue;
      open.push_back(link);
      if (link->closing && at - link->closing_since > state.options.timeout) ends.push_back(link);
      if (link->told > 0 && at - link->told > kReading) lws_callback_on_writable(link->wsi);
    }
  }
  for (WebLink* const link : open) {
    const TcpState before = std::exchange(link->tcp, tcp_state(lws_get_socket_fd(link->wsi)));
    // A long message on a slow link is a sign of life too.
    if (link->tcp.read != before.read || link->tcp.taken != before.taken)
      lws_validity_confirmed(link->wsi);
    link->round_trip_ms = link->tcp.round_trip_ms;
    if (!link->broken && floods(*link, at)) state.refuse(link, Reason::flood);
  }
  for (WebLink* const link : ends) kill(link);
}

WebLoop::WebLoop(WebState& state, TlsContext certificate)
    : loop_(std::make_unique<Loop>(state, std::move(certificate))) {
  loop_->start();
}

WebLoop::~WebLoop() = default;

void WebLoop::wake() {
  if (!loop_->woken.exchange(true)) lws_cancel_service(loop_->context);
}

}  // namespace gicodec::streaming

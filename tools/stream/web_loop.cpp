#include "web_loop.h"

#include "dump/error.h"
#include "web_loop_state.h"

#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

constexpr std::size_t kRead = 64 << 10;     ///< bytes that are read at once
constexpr std::size_t kLoopFiles = 64;      ///< of the program beside connections
constexpr lws_usec_t kLookAfter = 250'000;  ///< microseconds

WebLink* link_of(lws* wsi) { return static_cast<WebLink*>(lws_get_opaque_user_data(wsi)); }

}  // namespace

/// Nothing may be thrown through libwebsockets.
int WebLoop::Loop::on_event(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                            std::size_t size) {
  auto* const loop = static_cast<Loop*>(lws_context_user(lws_get_context(wsi)));
  try {
    return loop->take(wsi, reason, user, in, size);
  } catch (...) {
    // No memory: closes this connection, but not the descriptor that serves all.
    const bool wishes = reason == LWS_CALLBACK_EVENT_WAIT_CANCELLED;
    if (wishes) loop->woken = true;  // The timer repeats it.
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
  protocols[0] = {kWebProtocol, on_event, 0, serves ? kRead / 16 : kRead, 0, nullptr, 0};
  lws_context_creation_info info{};
  info.user = this;
  info.port = serves ? CONTEXT_PORT_NO_LISTEN_SERVER : CONTEXT_PORT_NO_LISTEN;
  info.protocols = protocols;
  info.options = LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT | LWS_SERVER_OPTION_DISABLE_OS_CA_CERTS |
                 LWS_SERVER_OPTION_EXPLICIT_VHOSTS;
  if (certificate) info.options |= LWS_SERVER_OPTION_CREATE_VHOST_SSL_CTX;
  info.alpn = "http/1.1";
  info.http_proxy_address = "";  // Not that of the environment, which would see what is in clear.
  info.server_string = "gi-server";
  info.gid = info.uid = -1;  // Keeps those of the process.
  info.retry_and_idle_policy = &patience;
  info.pt_serv_buf_size = kRead;
  info.fd_limit_per_thread = static_cast<unsigned>(
      (serves ? state.options.links + HalfOpen::kMax : state.options.links) + kLoopFiles);
  context = lws_create_context(&info);
  vhost = context == nullptr ? nullptr : lws_create_vhost(context, &info);
  if (vhost == nullptr || !prepared) fail(Exit::io, "TLS or WebSockets cannot be started here");
  timer.loop = this;
  if (serves) {
    lws_sock_file_fd_type file{};
    file.filefd = state.listener;
    if (lws_adopt_descriptor_vhost(vhost, LWS_ADOPT_RAW_FILE_DESC, file, kWebProtocol, nullptr) ==
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
      if (loop->woken) loop->take_wishes();  // Earlier there was no memory for them.
    } catch (...) {
      loop->woken = true;  // No memory: tries again at the next turn.
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
      if (link->why.empty() && !refused.empty())
        link->why = "the server is not trusted: " + refused;
      return refused.empty() ? 0 : 1;
    }
    case LWS_CALLBACK_HTTP:
      return answer(link, wsi);
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return write_page(link, wsi);
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return header(wsi, WSI_TOKEN_GET_URI) == "/" &&
                     lws_hdr_total_length(wsi, WSI_TOKEN_PROTOCOL) > 0
                 ? admit(link, wsi)
                 : -1;
    case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER:  // Nothing was sent yet.
      if (link->server.via != Via::plain_web || peer_is_here(lws_get_socket_fd(wsi))) return 0;
      link->why = "its name stands for another machine, and ws:// is not encrypted";
      return -1;
    case LWS_CALLBACK_CLIENT_HTTP_REDIRECT:
      return -1;
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
      if (link->why.empty()) link->why = redirection(wsi);
      lws_set_opaque_user_data(wsi, nullptr);
      gone(link, in == nullptr ? std::string_view()
                               : std::string_view(static_cast<const char*>(in), size));
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

/// Carries out the requests of the caller's thread.
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

WebLoop::WebLoop(WebState& state, TlsContext certificate)
    : loop_(std::make_unique<Loop>(state, std::move(certificate))) {
  loop_->start();
}

WebLoop::~WebLoop() = default;

void WebLoop::wake() {
  if (!loop_->woken.exchange(true)) lws_cancel_service(loop_->context);
}

}  // namespace gicodec::streaming

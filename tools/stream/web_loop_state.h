// The state of a WebLoop. Only web_loop.cpp and web_connections.cpp see libwebsockets.
#pragma once

#include "web_loop.h"
#include "web_state.h"

#include <libwebsockets.h>

#include <array>
#include <atomic>
#include <map>
#include <string>
#include <thread>

namespace gicodec::streaming {

inline constexpr const char* kWebProtocol = "gicodec";

[[nodiscard]] inline std::string header(lws* wsi, lws_token_indexes which) {
  std::array<char, 512> text{};
  const int size = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), which);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
}

/// web_loop.cpp has the event loop, web_connections.cpp the connections.
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
  /// If a server answers the upgrade with a redirect: what to say of it. Nobody is followed: the
  /// client has a token, and chose whom it tells it.
  static std::string redirection(lws* wsi);
  int opened(WebLink* link, lws* wsi);
  int write(WebLink* link);
  void gone(WebLink* link, std::string_view reason);
  int answer(WebLink* link, lws* wsi);
  /// Sends the next bytes of an answer; the last ones end the connection.
  int write_page(WebLink* link, lws* wsi);
  /// 0 if a page may connect from where it is, else -1.
  int admit(WebLink* link, lws* wsi);
  bool count_anew(WebLink* link, const std::string& forwarded);
  void look_after_all();
  /// Ends the connection soon. Does nothing for a link that libwebsockets does not have.
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
  WebLink* beginning = nullptr;  ///< the link that is being connected
  bool failed = false;           ///< connecting failed at once, see `why`
  std::string why;
  HalfOpen half_open;
  std::map<std::string, std::size_t> hosts;  ///< connections of each
  std::size_t open_links = 0;
  Timer timer;
  std::atomic<bool> woken = false, stop = false;
  std::jthread thread;
};

}  // namespace gicodec::streaming

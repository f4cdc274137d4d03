// The connections of a WebLoop: accepting, opening, writing, time-outs, closing.
#include "clock.h"
#include "dump/text.h"
#include "web_loop_state.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

namespace gicodec::streaming {
namespace {

static_assert(kFrameRoom >= LWS_PRE);
constexpr std::size_t kChunk = 64 << 10;  ///< bytes that leave at once
/// Seconds that a client has to read the reason and to close. If the server closed with unread
/// bytes of the client, the reset would overtake the reason.
constexpr double kReading = 0.4;
constexpr int kChunkSeconds = 10;        ///< in which kChunk of a page must leave
constexpr double kPageSeconds = 120;     ///< in which a file of it must
constexpr std::size_t kLocation = 4096;  ///< bytes; libwebsockets takes no longer heads

}  // namespace

void WebLoop::Loop::accept() {
  TcpPeer peer;
  for (std::size_t i = 0; i < HalfOpen::kMax; ++i) {  // Other events get their turn.
    const int descriptor = accept_tcp(state.listener, peer);
    if (descriptor < 0) return;
    WebLink* const link = enter(peer);
    if (link == nullptr) {
      {
        const std::lock_guard lock(state.mutex);
        ++state.turned_away.count;
        state.turned_away.last = std::move(peer.address);
      }
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
    // After an error the connection is closed; gone() may have been called or not.
    const std::lock_guard lock(state.mutex);
    if (!state.links.contains(link)) continue;
    link->wsi = wsi;
    if (wsi != nullptr) continue;
    leave(link);
    state.forget(link);
  }
}

/// Adds a connection; nullptr if there is no room or no memory for it.
WebLink* WebLoop::Loop::enter(const TcpPeer& peer) {
  if (open_links >= state.options.links) return nullptr;
  WebLink* link = nullptr;
  try {
    auto made = std::make_unique<WebLink>();
    made->peer = peer;
    made->accepted = true;
    made->created = now();
    std::size_t& of_host = hosts[peer.host];
    const bool proxy = state.listen.behind_proxy && peer.loopback;  // of many addresses
    if (of_host >= state.options.links_per_address && !proxy) {
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

/// Counts a connection by the address for which its proxy says that it comes. False if that has too
/// many, or memory runs out.
bool WebLoop::Loop::count_anew(WebLink* link, const std::string& forwarded) {
  const std::size_t last = forwarded.find_last_of(", ");
  const std::size_t colon = link->peer.address.rfind(':');
  try {
    TcpPeer peer = peer_from_string(
        forwarded.substr(last == std::string::npos ? 0 : last + 1),
        static_cast<std::uint16_t>(std::stoul(link->peer.address.substr(colon + 1))));
    if (peer.host.empty()) return true;  // it says none
    std::size_t& of_host = hosts[peer.host];
    if (of_host >= state.options.links_per_address) {
      const std::lock_guard lock(state.mutex);
      ++state.turned_away.count;
      state.turned_away.last = std::move(peer.address);
      return false;
    }
    ++of_host;
    leave(link);
    link->peer = std::move(peer);
    return true;
  } catch (const std::bad_alloc&) {
    std::erase_if(hosts, [](const auto& host) { return host.second == 0; });
    return false;
  }
}

/// Removes a connection from the counts.
void WebLoop::Loop::leave(WebLink* link) {
  half_open.remove(link);
  if (!link->accepted) return;
  const auto it = hosts.find(link->peer.host);
  if (it != hosts.end() && --it->second == 0) hosts.erase(it);
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
  info.protocol = info.local_protocol_name = kWebProtocol;
  info.ietf_version_or_minus_one = -1;
  info.opaque_user_data = link;
  beginning = link;
  failed = false;
  why.clear();
  info.retry_and_idle_policy = &patience;
  // objection() checks names, those of IPv6 too.
  if (link->server.via == Via::web)
    info.ssl_connection = LCCSCF_USE_SSL | LCCSCF_SKIP_SERVER_CERT_HOSTNAME_CHECK;
  info.ssl_connection |= LCCSCF_HTTP_NO_FOLLOW_REDIRECT;
  lws* const wsi = lws_client_connect_via_info(&info);
  beginning = nullptr;
  if (wsi == nullptr || failed) return gone(link, why);
  link->wsi = wsi;
}

std::string WebLoop::Loop::redirection(lws* wsi) {
  const unsigned code = lws_http_client_http_response(wsi);
  if (code < 300 || code > 399) return "";
  std::string where(kLocation, '\0');
  const int size = lws_hdr_copy(wsi, where.data(), kLocation, WSI_TOKEN_HTTP_LOCATION);
  where.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return fmt::format(
      "what answers there is no gi-server, but a redirect (HTTP {}) to \"{}\", which is not "
      "followed; if a server that you trust is there, --connect to that one",
      code, tools::message(where));
}

int WebLoop::Loop::opened(WebLink* link, lws* wsi) {
  half_open.remove(link);
  ++open_links;
  link->wsi = wsi;
  link->open = true;
  state.add_event(link, NetEvent::Type::opened);
  return 0;
}

int WebLoop::Loop::write(WebLink* link) {
  while (lws_send_pipe_choked(link->wsi) == 0) {
    Outgoing* out = nullptr;
    {
      const std::lock_guard lock(state.mutex);
      if (link->unsent.empty()) {
        if (!link->closing) return 0;
        if (link->accepted && link->goodbye_sent == 0) link->goodbye_sent = now();
        // look_after_all() ends it.
        if (link->accepted && now() - link->goodbye_sent < kReading) return 0;
        if (link->broken) return kill(link), 0;  // Does not wait for its further bytes.
        lws_close_reason(link->wsi, LWS_CLOSE_STATUS_NORMAL, nullptr, 0);
        return -1;
      }
      out = &link->unsent.front();  // Its address is stable: others are added behind it.
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

/// Handles the end of a connection in any state.
void WebLoop::Loop::gone(WebLink* link, std::string_view reason) {
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
  // Who was refused would be refused again.
  if (!link->why.empty()) return state.closed(link, announced, {link->why}, true);
  const bool foreign = reason.starts_with("HS:");  // libwebsockets, of answers to the upgrade
  state.closed(link, announced,
               {foreign ? "what answers there is no gi-server; is it the port?" : reason}, foreign);
}

int WebLoop::Loop::answer(WebLink* link, lws* wsi) {
  Shown what;
  {
    const std::lock_guard lock(state.mutex);
    what = state.shown;
  }
  const bool here = link->peer.loopback && !state.listen.behind_proxy;
  const bool head = lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0;
  const WebRequest request{head || lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0,
                           header(wsi, head ? WSI_TOKEN_HEAD_URI : WSI_TOKEN_GET_URI),
                           header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION),
                           here,
                           header(wsi, WSI_TOKEN_HOST),
                           header(wsi, WSI_TOKEN_HTTP_ACCEPT_ENCODING)};
  link->page = web_answer(request, what, state.listen.metrics_token, now(), state.files);
  if (head) {
    link->page.head.resize(link->page.head.find("\r\n\r\n") + 4);
    link->page.rest = {};
  }
  link->answering = true;
  lws_callback_on_writable(wsi);
  return 0;
}

int WebLoop::Loop::write_page(WebLink* link, lws* wsi) {
  if (!link->answering) return 0;
  auto& [head, rest] = link->page;
  if (head.empty() && rest.empty()) return -1;  // One answer for each connection.
  const std::size_t size = std::min(rest.size(), kChunk);
  std::string text(LWS_PRE, '\0');
  text.append(std::exchange(head, {})).append(rest.substr(0, size));
  rest.remove_prefix(size);
  lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, kChunkSeconds);
  const auto kind = rest.empty() ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP;
  if (lws_write(wsi, reinterpret_cast<unsigned char*>(text.data()) + LWS_PRE, text.size() - LWS_PRE,
                kind) < 0) {
    return -1;
  }
  lws_callback_on_writable(wsi);  // once these bytes have left
  return 0;
}

int WebLoop::Loop::admit(WebLink* link, lws* wsi) {
  std::string origin = header(wsi, WSI_TOKEN_ORIGIN);
  const bool secure = state.listen.address.via == Via::web;
  if (may_connect(origin, header(wsi, WSI_TOKEN_HOST), state.listen.origins, secure)) {
    if (!state.listen.behind_proxy || !link->peer.loopback) return 0;
    return count_anew(link, header(wsi, WSI_TOKEN_X_FORWARDED_FOR)) ? 0 : -1;
  }
  const std::lock_guard lock(state.mutex);
  ++state.turned_away.origins;
  state.turned_away.last_origin = std::move(origin);
  return -1;
}

void WebLoop::Loop::look_after_all() {
  const double at = now();
  std::vector<WebLink*> ends;
  for (WebLink* const link : half_open.all()) {
    const double most = link->answering ? kPageSeconds : state.options.open_timeout;
    if (at - link->created > most && link->wsi != nullptr) ends.push_back(link);
  }
  std::vector<WebLink*> open;
  {
    const std::lock_guard lock(state.mutex);
    for (const auto& [link, owner] : state.links) {
      if (!link->open) continue;
      open.push_back(link);
      if (link->closing && at - link->closing_since > state.options.timeout) ends.push_back(link);
      if (link->goodbye_sent > 0 && at - link->goodbye_sent > kReading)
        lws_callback_on_writable(link->wsi);
    }
  }
  for (WebLink* const link : open) {
    const TcpState before = std::exchange(link->tcp, tcp_state(lws_get_socket_fd(link->wsi)));
    // Progress of a long message on a slow link counts as an answer.
    if (link->tcp.read != before.read || link->tcp.taken != before.taken)
      lws_validity_confirmed(link->wsi);
    link->round_trip_ms = link->tcp.round_trip_ms;
    if (!link->broken && floods(*link, at)) state.refuse(link, Reason::flood);
  }
  for (WebLink* const link : ends) kill(link);
}

}  // namespace gicodec::streaming

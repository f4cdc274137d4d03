#include "net.h"

#include <poll.h>

#include <algorithm>
#include <array>

namespace gicodec::streaming {
namespace {

TlsContext certificate_of(const WebListen& listen) {
  if (listen.certificate.empty()) return nullptr;
  return load_certificate(listen.certificate, listen.key);
}

}  // namespace

Net::Net(const std::optional<Address>& enet, const std::optional<WebListen>& web,
         const NetOptions& options) {
  if (enet) enet_ = std::make_unique<Enet>(*enet, options);
  if (!web) return;
  listen_ = *web;
  web_ = std::make_unique<Web>(*web, certificate_of(*web), options);
}

Net::Net(Via via, const NetOptions& options) {
  options_ = options;
  if (via == Via::enet) enet_ = std::make_unique<Enet>(options);
  if (via == Via::web || via == Via::plain_web) web_ = std::make_unique<Web>(options);
}

Link Net::connect(const Address& address) {
  if (address.via == Via::enet) return {enet_->connect(address)};
  if (address.via != Via::nats) return {nullptr, web_->connect(address)};
  nats_.push_back(std::make_unique<NatsReceiver>(options_.nats, options_.tracks, options_.timeout));
  return {nullptr, nullptr, nats_.back().get()};
}

/// Waits at one of them, in turn.
bool Net::next_of_nats(NetEvent& event, unsigned milliseconds) {
  for (const auto& link : nats_) {
    if (link->next(event, 0)) return true;
  }
  if (nats_.empty() || milliseconds == 0) return false;
  std::rotate(nats_.begin(), nats_.begin() + 1, nats_.end());
  return nats_.front()->next(event, milliseconds);
}

/// Asks both transports in turn, so that neither starves the other.
bool Net::next_of_any(NetEvent& event) {
  web_first_ = !web_first_;
  if (web_ && web_first_ && web_->next(event)) return true;
  if (enet_ && enet_->next(event, 0)) return true;
  return web_ && !web_first_ && web_->next(event);
}

bool Net::next(NetEvent& event, unsigned milliseconds) {
  if (!web_ && !enet_) return next_of_nats(event, milliseconds);
  if (!web_) return enet_->next(event, milliseconds);
  if (next_of_any(event)) return true;
  if (milliseconds == 0) return false;
  std::array<pollfd, 2> polled{pollfd{web_->descriptor(), POLLIN, 0}, pollfd{-1, POLLIN, 0}};
  if (enet_) polled[1].fd = enet_->descriptor();
  poll(polled.data(), polled.size(), static_cast<int>(milliseconds));
  return next_of_any(event);
}

bool Net::send(Link link, const OutgoingMessage& message) {
  if (link.nats != nullptr) {
    link.nats->send(message.head);
    return true;
  }
  return link.web != nullptr ? web_->send(link.web, message) : enet_->send(link.enet, message);
}

void Net::flush() {
  if (enet_) enet_->flush();  // What goes to WebSockets is on its way.
}

void Net::attend() {
  if (enet_) enet_->attend();  // WebSockets wait for half a minute.
}

void Net::close(Link link) {
  if (link.nats != nullptr) return link.nats->close();
  if (link.web != nullptr) return web_->close(link.web);
  enet_->close(link.enet);
}

void Net::abandon(Link link) {
  if (link.nats != nullptr) {
    std::erase_if(nats_, [&](const auto& one) { return one.get() == link.nats; });
    return;
  }
  if (link.web != nullptr) return web_->abandon(link.web);
  enet_->abandon(link.enet);
}

std::vector<std::uint16_t> Net::ports() const {
  std::vector<std::uint16_t> ports;
  if (enet_) ports.push_back(enet_->port());
  if (web_) ports.push_back(web_->port());
  return ports;
}

std::string Net::host_of(Link link) {
  return link.web != nullptr ? Web::host_of(link.web) : Enet::host_of(link.enet);
}

std::string Net::address_of(Link link) {
  return link.web != nullptr ? Web::address_of(link.web) : Enet::address_of(link.enet);
}

unsigned Net::round_trip_ms(Link link) {
  if (link.nats != nullptr) return 0;  // not known
  return link.web != nullptr ? Web::round_trip_ms(link.web) : Enet::round_trip_ms(link.enet);
}

void Net::set_tag(Link link, std::uintptr_t tag) {
  if (link.nats != nullptr) return link.nats->set_tag(tag);
  if (link.web != nullptr) return Web::set_tag(link.web, tag);
  Enet::set_tag(link.enet, tag);
}

std::uintptr_t Net::tag(Link link) {
  if (link.nats != nullptr) return link.nats->tag();
  return link.web != nullptr ? Web::tag(link.web) : Enet::tag(link.enet);
}

TurnedAway Net::turned_away() { return web_ ? web_->turned_away() : TurnedAway{}; }

void Net::show(std::string metrics) {
  if (web_) web_->show(std::move(metrics));
}

void Net::reload() {
  if (web_ && !listen_.certificate.empty()) web_->use(certificate_of(listen_));
}

}  // namespace gicodec::streaming

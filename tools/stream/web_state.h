// What the two threads of a Web share. web.cpp is the caller's side of it, web_loop.cpp the
// other's.
#pragma once

#include "tls.h"
#include "web_link.h"
#include "web_page.h"

#include <initializer_list>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::streaming {

/// Of the frame that bytes are from.
struct WebFrame {
  bool binary = false, final = false;  ///< final: they are the end of a message
  std::uint64_t left = 0;              ///< bytes that the frame still has
};

struct WebState {
  explicit WebState(const NetOptions& options);
  ~WebState();
  WebState(const WebState&) = delete;
  WebState& operator=(const WebState&) = delete;

  WebLink* add(std::unique_ptr<WebLink> link);

  // The loop's thread:
  void add_event(WebLink* link, NetEvent::Type kind, Reason reason = Reason::left);
  /// What cannot be a message is known before it is kept.
  void receive(WebLink* link, std::span<const std::byte> bytes, const WebFrame& frame);
  /// Nothing more is taken from a peer that breaks a rule; the caller says the reason, and closes.
  /// std::bad_alloc changes nothing.
  void refuse(WebLink* link, Reason reason);
  /// Forgets it, after telling if the caller knows of it. `why`: parts of the reason, which gets
  /// lost without memory.
  void closed(WebLink* link, bool announced, std::initializer_list<std::string_view> why,
              bool final) noexcept;

  // With the mutex held:
  void push(NetEvent event);
  /// Appends an event that has its memory.
  void push(std::list<NetEvent>& event) noexcept;
  void forget(WebLink* link) { links.erase(link); }

  NetOptions options;
  WebListen listen;
  WebFiles files;     ///< of listen.page
  int listener = -1;  ///< socket, if it waits for connections; the loop closes it
  int wake_up = -1;   ///< readable while there are events

  std::mutex mutex;  ///< guards what follows
  std::map<WebLink*, std::unique_ptr<WebLink>> links;
  std::list<NetEvent> events;
  std::vector<WebLink*> wanted;  ///< connections to begin
  TlsContext next_certificate;
  Shown shown;
  TurnedAway turned_away;  ///< since the caller asked
};

}  // namespace gicodec::streaming

// The thread that serves WebSockets.
#pragma once

#include "tls.h"

#include <memory>

namespace gicodec::streaming {

struct WebState;

class WebLoop {
 public:
  /// Starts the thread. `certificate`: nullptr without encryption, and for clients. Throws
  /// tools::Error.
  WebLoop(WebState& state, TlsContext certificate);
  /// Ends the thread and all connections.
  ~WebLoop();
  WebLoop(const WebLoop&) = delete;
  WebLoop& operator=(const WebLoop&) = delete;

  /// Wakes the thread: the state has work for it. Any thread may call this.
  void wake();

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace gicodec::streaming

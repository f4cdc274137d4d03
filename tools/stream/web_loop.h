// The thread that serves WebSockets.
#pragma once

#include "tls.h"

#include <memory>

namespace gicodec::streaming {

struct WebState;

class WebLoop {
 public:
  /// Begins. `certificate`: nullptr without encryption, and for clients. Throws tools::Error.
  WebLoop(WebState& state, TlsContext certificate);
  /// Ends it, and all connections with it.
  ~WebLoop();
  WebLoop(const WebLoop&) = delete;
  WebLoop& operator=(const WebLoop&) = delete;

  /// There is something to do for it in the state. Any thread.
  void wake();

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace gicodec::streaming

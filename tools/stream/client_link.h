// A client's connection on a thread of its own: connects, carries messages, comes back after a
// loss.
#pragma once

#include "net.h"

#include <gicodec/client.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace gicodec::streaming {

struct LinkOptions {
  Address server;
  NetOptions net;
  double patience = 15;  ///< seconds without a connection after which it gives up
  bool quiet = false;
};

/// Why there is no connection, for a person.
[[nodiscard]] std::string no_answer(const Address& server, const std::string& why = {});
[[nodiscard]] std::string refused(const Address& server, const std::string& why);
/// What is wrong with what the server sends, by the status of the client that took it.
[[nodiscard]] std::string unusable(Status status);

class ClientLink {
 public:
  enum class State : std::uint8_t {
    connecting,
    open,
    ended,   ///< the server has ended
    failed,  ///< it cannot be reached, or has turned the client away; see message()
  };

  /// The client must outlive it.
  ClientLink(const LinkOptions& options, ClientThread& client);
  /// close() if that was not done.
  ~ClientLink();
  ClientLink(const ClientLink&) = delete;
  ClientLink& operator=(const ClientLink&) = delete;

  /// Tells the server; of several in short time the last one.
  void set_viewpoint(const Viewpoint& view);
  /// Not if they are those of a session that was before this one.
  void subscribe(std::uint16_t volume, std::uint8_t group, const BlockMask& blocks) {
    static_cast<void>(client_.subscribe(volume, blocks, group));
  }
  /// Says goodbye and ends the connection.
  void close();

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] unsigned connections() const { return connections_; }
  [[nodiscard]] unsigned round_trip_ms() const { return round_trip_; }
  /// Why it failed or ended.
  [[nodiscard]] std::string message() const;

 private:
  void run();
  [[nodiscard]] Link connect(Net& net);
  void serve(Net& net, Link link);
  void send_messages(Net& net, Link link);
  void say_goodbye(Net& net, Link link);
  void leave(Net& net, Link link);
  /// True if the client says that the connection is over.
  bool over();
  void lost();
  void fail(const std::string& message);
  void wait(double seconds) const;

  LinkOptions options_;
  ClientThread& client_;
  std::atomic<State> state_ = State::connecting;
  std::atomic<unsigned> connections_ = 0, round_trip_ = 0;
  std::atomic<bool> stop_ = false;
  unsigned losses_ = 0;
  std::string why_;    ///< the last attempt came to nothing, as far as that is known
  bool late_ = false;  ///< the last Hello was, for the server: the link's fault, and not for ever

  mutable std::mutex mutex_;       ///< guards what follows
  std::optional<Viewpoint> view_;  ///< to be told
  std::string message_;

  std::jthread thread_;  // Last: ends before the others do.
};

}  // namespace gicodec::streaming

// A client's connection on a thread of its own: connects, carries messages, reconnects after a
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
  double patience = 15;  ///< seconds without a connection before it gives up
  bool quiet = false;
};

/// The reason why there is no connection, for people.
[[nodiscard]] std::string no_answer(const Address& server, const std::string& why = {});
[[nodiscard]] std::string refused(const Address& server, const std::string& why);
/// Why the server ended the session, and what helps, for people.
[[nodiscard]] std::string reason_and_cure(Reason reason);
/// The fault in the server's messages, for people. `status`: of Client::receive().
[[nodiscard]] std::string unusable(Status status);

class ClientLink {
 public:
  enum class State : std::uint8_t {
    connecting,
    open,
    ended,   ///< the server has ended
    failed,  ///< the server cannot be reached, or rejected the client; see message()
  };

  /// The client must outlive it.
  ClientLink(const LinkOptions& options, ClientThread& client);
  /// Calls close() if the caller has not.
  ~ClientLink();
  ClientLink(const ClientLink&) = delete;
  ClientLink& operator=(const ClientLink&) = delete;

  /// Sends the viewpoint; of several within a short time only the last.
  void set_viewpoint(const Viewpoint& view);
  /// Sends nothing if the volume is of an earlier session.
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
  /// Sends a Hello; false if memory ran out.
  bool greet(Net& net, Link link);
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
  std::string why_;    ///< why the last attempt failed, if known
  bool late_ = false;  ///< the server got the last Hello too late: a slow link, worth another try

  mutable std::mutex mutex_;       ///< guards the members below
  std::optional<Viewpoint> view_;  ///< to send
  std::string message_;

  std::jthread thread_;  // Last: ends before the others do.
};

}  // namespace gicodec::streaming

// The operator's socket of a running server: takes one line with a command, sends the answer.
// `gi-server --ask` is the other end.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <utility>

namespace gicodec::streaming {

class Control {
 public:
  /// Creates the socket, which only its owner may use. Replaces a socket without a listener; throws
  /// tools::Error of Exit::io if the path is any other file.
  explicit Control(std::string path);
  ~Control();
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;

  /// Answers the commands that have arrived, without waiting. An answer that begins with "error: "
  /// makes ask() fail.
  void serve(const std::function<std::string(const std::string& command)>& answer);

 private:
  struct Asker {
    int descriptor;
    double accepted;  ///< when
    std::string command, answer;
    bool answered = false;
  };
  /// False when it is done.
  static bool serve(Asker& asker,
                    const std::function<std::string(const std::string& command)>& answer);

  std::string path_;
  std::pair<std::uint64_t, std::uint64_t> file_;  ///< device and inode of the socket
  int descriptor_ = -1;
  std::list<Asker> askers_;
};

/// Sends a command to the server at this socket; returns its answer. Throws tools::Error of
/// Exit::io if there is no server, of Exit::bad_input if the answer is an error.
[[nodiscard]] std::string ask(const std::string& path, const std::string& command);

}  // namespace gicodec::streaming

// A socket through which the operator of a running server asks and tells it something: one line of
// a command there, the answer back. `gi-server --ask` is the other end.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <utility>

namespace gicodec::streaming {

class Control {
 public:
  /// Makes the socket, which only its owner may use. Takes the place of one that nobody listens
  /// to any more; throws tools::Error of Exit::io where something else is in the way.
  explicit Control(std::string path);
  ~Control();
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;

  /// Answers the commands that have come. Never waits. An answer that begins with "error: " is
  /// shown as one.
  void serve(const std::function<std::string(const std::string& command)>& answer);

 private:
  struct Asker {
    int descriptor;
    double since;
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

/// What the server at this socket answers. Throws tools::Error: Exit::io if there is none, Exit::
/// bad_input for an answer that is an error.
[[nodiscard]] std::string ask(const std::string& path, const std::string& command);

}  // namespace gicodec::streaming

// Who is let in: one token for all, or each user's own. Wrong ones are counted, by address.
#pragma once

#include "allowance.h"
#include "users.h"

#include <gicodec/server.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::streaming {

class Access {
 public:
  /// Without a token and without a file of users everybody is let in. Throws tools::Error.
  Access(std::string token, std::string users_file);

  void opened(ConnectionId connection, std::string host) {
    connections_[connection].host = std::move(host);
  }
  void closed(ConnectionId connection) { connections_.erase(connection); }
  /// Nothing if the client may come in.
  [[nodiscard]] std::optional<Reason> judge(ConnectionId connection, std::string_view token,
                                            double now);
  /// Whose token it said; empty if there are no users.
  [[nodiscard]] std::string user(ConnectionId connection) const;

  /// The file of users as it is now. Throws tools::Error.
  [[nodiscard]] Users read() const;
  /// From now on these.
  void use(Users users) { users_ = std::move(users); }
  /// Connections whose user is gone or has another token now.
  [[nodiscard]] std::vector<ConnectionId> outdated() const;

  [[nodiscard]] bool asks() const { return !token_.empty() || !file_.empty(); }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::size_t users() const { return users_.size(); }
  [[nodiscard]] std::uint64_t unheard() const { return unheard_; }  ///< guesses

 private:
  struct Connection {
    std::string host, user;
    User as;  ///< the line that let it in
  };
  std::string token_, file_;
  Users users_;
  std::map<ConnectionId, Connection> connections_;
  Allowance guesses_;
  std::uint64_t unheard_ = 0;
};

}  // namespace gicodec::streaming

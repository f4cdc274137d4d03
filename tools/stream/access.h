// Access of clients: one token for all, or one per user. Counts wrong tokens by address.
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
  /// Without a token and without a file of users every client may connect. Throws tools::Error.
  Access(std::string token, std::string users_file);

  void opened(ConnectionId connection, std::string host) {
    connections_[connection].host = std::move(host);
  }
  void closed(ConnectionId connection) { connections_.erase(connection); }
  /// nullopt if the client may connect, else the reason to reject it.
  [[nodiscard]] std::optional<Reason> judge(ConnectionId connection, std::string_view token,
                                            double now);
  /// The user whose token the client sent; empty if there are no users.
  [[nodiscard]] std::string user(ConnectionId connection) const;

  /// Reads the file of users again. Throws tools::Error.
  [[nodiscard]] Users read() const;
  /// Replaces the users.
  void use(Users users) { users_ = std::move(users); }
  /// Connections whose user was removed or has another token.
  [[nodiscard]] std::vector<ConnectionId> outdated() const;

  [[nodiscard]] bool asks() const { return !token_.empty() || !file_.empty(); }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::size_t users() const { return users_.size(); }
  [[nodiscard]] std::uint64_t unheard() const { return unheard_; }  ///< wrong tokens

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

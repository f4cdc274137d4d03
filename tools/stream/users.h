// Who may connect: a file with a line for each user, its name and the hash of its token.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace gicodec::streaming {

struct User {
  unsigned rounds = 0;
  std::string salt, hash;
  friend bool operator==(const User&, const User&) = default;
};
using Users = std::map<std::string, User, std::less<>>;

/// Throws tools::Error that names the line.
[[nodiscard]] Users read_users(const std::string& path);

/// The user whose token this is; empty for nobody's. Takes as long for those who are not there.
[[nodiscard]] std::string user_of(const Users& users, std::string_view token);

/// Adds a line, in a new file if there is none, and returns the token, which is kept nowhere.
/// Throws tools::Error.
[[nodiscard]] std::string add_user(const std::string& path, const std::string& name);

}  // namespace gicodec::streaming

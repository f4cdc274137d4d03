// Users that may connect: a file with a line per user, with name and hash of the token.
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

/// The user of this token; empty if there is none. Takes the same time in both cases.
[[nodiscard]] std::string user_of(const Users& users, std::string_view token);

/// Adds a line to the file, which it creates if needed. Returns the token, which is stored nowhere.
/// Throws tools::Error.
[[nodiscard]] std::string add_user(const std::string& path, const std::string& name);

}  // namespace gicodec::streaming

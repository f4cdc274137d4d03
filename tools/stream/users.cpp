#include "users.h"

#include "dump/error.h"
#include "secrets.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

constexpr const char* kHash = "pbkdf2-sha256";
/// Rounds of hashing. Tokens of 256 random bits cannot be guessed anyway; the rounds protect tokens
/// that people chose from a reader of the file.
constexpr unsigned kRounds = 4096, kMaxRounds = 1'000'000;
constexpr std::size_t kSecret = 32, kSalt = 16, kMaxName = 64;  // bytes
constexpr std::size_t kMaxFile = std::size_t{4} << 20;          // bytes
constexpr const char* kCure = "gi-server --add-user NAME FILE writes such lines";

bool is_name(std::string_view name) {
  constexpr std::string_view kLetters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._@-";
  return !name.empty() && name.size() <= kMaxName && name.find_first_not_of(kLetters) == name.npos;
}

/// The fields between colons; the last field is the rest.
std::array<std::string_view, 5> fields_of(std::string_view line) {
  std::array<std::string_view, 5> fields{};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::size_t colon = i + 1 < fields.size() ? line.find(':') : line.npos;
    fields[i] = line.substr(0, colon);
    line.remove_prefix(colon == line.npos ? line.size() : colon + 1);
  }
  return fields;
}

void add_line(Users& users, std::string_view line, const std::string& where) {
  const auto [name, kind, rounds, salt, hash] = fields_of(line);
  User user;
  const auto parsed = std::from_chars(rounds.data(), rounds.data() + rounds.size(), user.rounds);
  const auto salt_bytes = from_hex(salt), hash_bytes = from_hex(hash);
  const bool sound = is_name(name) && kind == kHash && parsed.ec == std::errc{} &&
                     parsed.ptr == rounds.data() + rounds.size() && user.rounds > 0 &&
                     user.rounds <= kMaxRounds && salt_bytes && salt_bytes->size() >= kSalt / 2 &&
                     hash_bytes && hash_bytes->size() == kSecret;
  if (!sound)
    fail(Exit::bad_input, "{}: is no line of a user, NAME:{}:ROUNDS:SALT:HASH; {}", where, kHash,
         kCure);
  user.salt = *salt_bytes;
  user.hash = *hash_bytes;
  if (!users.emplace(name, std::move(user)).second)
    fail(Exit::bad_input, "{}: user {} is there twice; remove one of the lines", where, name);
}

Users parse_users(std::string_view text, const std::string& path) {
  Users users;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    add_line(users, line, fmt::format("{}: line {}", path, number));
  }
  return users;
}

struct File {
  int descriptor;
  ~File() { ::close(descriptor); }
};

std::string read_all(int descriptor, const std::string& path) {
  std::string text;
  std::array<char, 4096> bytes{};
  while (true) {
    const ssize_t got = ::read(descriptor, bytes.data(), bytes.size());
    if (got < 0) fail(Exit::io, "{}: cannot be read: {}", path, std::strerror(errno));
    if (got == 0) return text;
    text.append(bytes.data(), static_cast<std::size_t>(got));
    if (text.size() > kMaxFile)
      fail(Exit::bad_input, "{}: is larger than {} bytes and no file of users", path, kMaxFile);
  }
}

}  // namespace

Users read_users(const std::string& path) {
  const File file{open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.descriptor < 0)
    fail(Exit::io, "{}: cannot be read: {}; {}", path, std::strerror(errno), kCure);
  return parse_users(read_all(file.descriptor, path), path);
}

std::string user_of(const Users& users, std::string_view token) {
  static const User nobody{kRounds, std::string(kSalt, '\0'), std::string(kSecret, '\0')};
  const std::size_t colon = token.find(':');
  const std::string_view name = token.substr(0, colon);
  const auto it = users.find(name);
  const User& user = it == users.end() ? nobody : it->second;
  const std::string_view secret =
      colon == token.npos ? std::string_view() : token.substr(colon + 1);
  const bool same = same_secret(slow_hash(secret, user.salt, user.rounds), user.hash);
  return same && it != users.end() ? it->first : std::string();
}

std::string add_user(const std::string& path, const std::string& name) {
  if (!is_name(name))
    fail(Exit::usage,
         "--add-user: a name has 1 to {} letters, digits, dots or any of _@-, not \"{}\"", kMaxName,
         name);
  constexpr int kFlags = O_RDWR | O_APPEND | O_CLOEXEC;
  File file{open(path.c_str(), kFlags | O_CREAT | O_EXCL, S_IRUSR | S_IWUSR)};
  const bool made = file.descriptor >= 0;
  if (!made) file.descriptor = open(path.c_str(), kFlags);
  // The lock keeps two programs from adding a name twice.
  if (file.descriptor < 0 || flock(file.descriptor, LOCK_EX) != 0)
    fail(Exit::io, "{}: cannot be written: {}", path, std::strerror(errno));
  const std::string text = read_all(file.descriptor, path);
  if (parse_users(text, path).contains(name))
    fail(Exit::bad_input, "{}: has a user {}; remove that line to give out another token", path,
         name);
  const std::string secret = to_hex(random_bytes(kSecret)), salt = random_bytes(kSalt);
  const std::string line =
      fmt::format("{}{}:{}:{}:{}:{}\n", text.empty() || text.ends_with('\n') ? "" : "\n", name,
                  kHash, kRounds, to_hex(salt), to_hex(slow_hash(secret, salt, kRounds)));
  if (::write(file.descriptor, line.data(), line.size()) != static_cast<ssize_t>(line.size()) ||
      fsync(file.descriptor) != 0) {
    const int error = errno;
    // Restores the file, so that no partial line stays.
    const bool restored = made ? unlink(path.c_str()) == 0
                               : ftruncate(file.descriptor, static_cast<off_t>(text.size())) == 0;
    fail(Exit::io, "{}: cannot be written: {}{}", path, std::strerror(error),
         restored ? "" : "; remove what follows its last whole line");
  }
  return name + ":" + secret;
}

}  // namespace gicodec::streaming

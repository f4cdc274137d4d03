// Users, their tokens, and how many wrong ones are listened to.
#include "stream/access.h"
#include "dump/error.h"
#include "stream/secrets.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace gicodec::streaming {
namespace {

class AccessTest : public testing::Test {
 protected:
  AccessTest() { std::filesystem::create_directory(folder_); }
  ~AccessTest() override { std::filesystem::remove_all(folder_); }

  std::string folder_ = testing::TempDir() + "access." + std::to_string(::getpid());
  std::string file_ = folder_ + "/users";
};

TEST_F(AccessTest, LetsInWhoseTokenItIsAndNobodyElse) {
  const std::string ada = add_user(file_, "ada"), bob = add_user(file_, "bob");
  const Users users = read_users(file_);
  ASSERT_EQ(users.size(), 2U);
  EXPECT_EQ(user_of(users, ada), "ada");
  EXPECT_EQ(user_of(users, bob), "bob");
  for (const std::string& wrong :
       {std::string(), std::string("ada"), std::string("ada:"), ada + "0", "bob" + ada.substr(3),
        "eve" + ada.substr(3), ada.substr(4), ada.substr(0, ada.size() - 1)}) {
    EXPECT_EQ(user_of(users, wrong), "") << wrong;
  }
}

TEST_F(AccessTest, RefusesLinesThatAreDamaged) {
  static_cast<void>(add_user(file_, "ada"));
  std::string line;
  std::getline(std::ifstream(file_) >> std::ws, line);
  const auto fails = [this](const std::string& text) {
    std::ofstream(file_) << text;
    EXPECT_THROW(static_cast<void>(read_users(file_)), tools::Error) << text;
  };
  for (std::size_t size = 1; size < line.size(); ++size) fails(line.substr(0, size));
  fails(line + "0");
  fails(line + "\n" + line);
  fails("a b" + line.substr(3));
  std::ofstream(file_) << "# a remark\r\n\r\n" << line << "\r\n";
  EXPECT_EQ(read_users(file_).size(), 1U);
}

TEST_F(AccessTest, KeepsTheUsersItHasWhenTheFileIsDamaged) {
  const std::string ada = add_user(file_, "ada");
  Access access("", file_);
  access.opened(1, "a");
  ASSERT_EQ(access.judge(1, ada, 0), std::nullopt);
  EXPECT_EQ(access.user(1), "ada");
  std::ofstream(file_, std::ios::app) << "nonsense\n";
  EXPECT_THROW(static_cast<void>(access.read()), tools::Error);
  EXPECT_TRUE(access.outdated().empty());
  access.opened(2, "a");
  EXPECT_EQ(access.judge(2, ada, 0), std::nullopt);

  std::filesystem::remove(file_);
  static_cast<void>(add_user(file_, "ada"));
  access.use(access.read());
  EXPECT_EQ(access.outdated(), (std::vector<ConnectionId>{1, 2}));
  EXPECT_EQ(access.judge(2, ada, 0), Reason::token);
}

TEST(AccessToken, ListensToFiveWrongOnesOfAnAddressAMinute) {
  Access access("open sesame", "");
  access.opened(1, "a");
  access.opened(2, "b");
  for (int i = 0; i < 5; ++i) EXPECT_EQ(access.judge(1, "open barley", i), Reason::token);
  EXPECT_EQ(access.unheard(), 0U);
  EXPECT_EQ(access.judge(1, "open sesame", 5), Reason::token);
  EXPECT_EQ(access.unheard(), 1U);
  EXPECT_EQ(access.judge(2, "open sesame", 5), std::nullopt);
  EXPECT_EQ(access.judge(1, "open sesame", 20), std::nullopt);
  EXPECT_EQ(access.judge(1, "open wheat", 20), Reason::token);
  EXPECT_EQ(access.judge(1, "open sesame", 21), Reason::token);
}

TEST(Allowance, CountsManyAddressesInBoundedRoom) {
  Allowance allowance(5, 1);
  const auto use_up = [&](const std::string& host, double at) {
    for (int i = 0; i < 5; ++i) {
      EXPECT_TRUE(allowance.has(host, at));
      allowance.take(host, at);
    }
    EXPECT_FALSE(allowance.has(host, at));
  };
  use_up("first", 0);
  for (int i = 0; i < 20000; ++i) allowance.take(std::to_string(i), 1 + i * 1e-6);
  use_up("last", 2);
  // What was not there is not owed.
  for (int i = 0; i < 100; ++i) allowance.take("last", 2);
  EXPECT_TRUE(allowance.has("last", 3));
}

TEST(AccessToken, NobodyIsAskedWithoutOne) {
  Access access("", "");
  EXPECT_EQ(access.judge(1, "whatever", 0), std::nullopt);
}

TEST(Secrets, HashAsTheStandardSays) {
  // RFC 7914, section 11.
  EXPECT_EQ(to_hex(slow_hash("passwd", "salt", 1)),
            "55ac046e56e3089fec1691c22544b605f94185216dde0465e68b9d57c20dacbc");
  EXPECT_TRUE(same_secret("a", "a"));
  EXPECT_FALSE(same_secret("a", "ab"));
  EXPECT_NE(random_bytes(32), random_bytes(32));
  EXPECT_EQ(from_hex("00ff"), std::string("\0\xff", 2));
  EXPECT_EQ(from_hex("0g"), std::nullopt);
  EXPECT_EQ(from_hex("0"), std::nullopt);
}

}  // namespace
}  // namespace gicodec::streaming

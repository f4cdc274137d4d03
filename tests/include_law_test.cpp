// A room knows only the rooms above it (HACKING.md, "Rooms"): read from what the sources include.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// The rooms of src/ in the order of the page's table.
std::vector<std::string> rooms_of_page() {
  std::ifstream page(GICODEC_HACKING_PAGE);
  std::vector<std::string> rooms;
  const std::regex row(R"(^\| `src/([a-z/]+)` \|.*)");
  std::smatch match;
  for (std::string line; std::getline(page, line);) {
    if (std::regex_match(line, match, row)) rooms.push_back(match[1]);
  }
  return rooms;
}

/// The room of a path below src/: the longest one that it lies in.
std::string room_of(const std::string& path, const std::vector<std::string>& rooms) {
  std::string found;
  for (const std::string& room : rooms) {
    if (path.rfind(room + "/", 0) == 0 && room.size() > found.size()) found = room;
  }
  return found;
}

TEST(IncludeLaw, APageListsEveryRoom) {
  const auto rooms = rooms_of_page();
  ASSERT_GE(rooms.size(), 10U);
  for (const auto& entry : fs::directory_iterator(GICODEC_SOURCE_DIR)) {
    if (!entry.is_directory()) continue;
    const std::string name = entry.path().filename();
    EXPECT_TRUE(std::any_of(rooms.begin(), rooms.end(), [&](const std::string& room) {
      return room == name || room.rfind(name + "/", 0) == 0;
    })) << entry.path();
  }
}

TEST(IncludeLaw, RoomsKnowOnlyThoseAboveThem) {
  const auto rooms = rooms_of_page();
  const auto rank = [&](const std::string& room) {
    return std::find(rooms.begin(), rooms.end(), room) - rooms.begin();
  };
  const std::regex include(R"re(^\s*#include "([^"]+)".*)re");
  std::size_t looked_at = 0;
  for (const auto& entry : fs::recursive_directory_iterator(GICODEC_SOURCE_DIR)) {
    const fs::path path = entry.path();
    const std::set<std::string> kinds{".h", ".cpp", ".inl"};
    if (!entry.is_regular_file() || kinds.count(path.extension()) == 0) continue;
    const std::string own = fs::relative(path, GICODEC_SOURCE_DIR).generic_string();
    const std::string room = room_of(own, rooms);
    ASSERT_FALSE(room.empty()) << own << " is in no room";
    std::ifstream file(path);
    std::smatch match;
    for (std::string line; std::getline(file, line);) {
      if (!std::regex_match(line, match, include)) continue;
      ++looked_at;
      const std::string other = room_of(match[1], rooms);
      EXPECT_FALSE(other.empty()) << own << " includes " << match[1] << " by an unknown path";
      EXPECT_LE(rank(other), rank(room)) << own << " includes " << match[1];
    }
  }
  EXPECT_GT(looked_at, 200U);
}

/// The two ends of a connection share the protocol, and nothing else.
TEST(IncludeLaw, ServerAndClientKnowNothingOfOneAnother) {
  const std::string ends[] = {"server", "client"};
  for (int i = 0; i < 2; ++i) {
    const std::regex other("^\\s*#include \"session/" + ends[1 - i] + "/.*");
    const fs::path room = fs::path(GICODEC_SOURCE_DIR) / "session" / ends[i];
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(room)) {
      ++files;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        EXPECT_FALSE(std::regex_match(line, other)) << entry.path() << ": " << line;
      }
    }
    EXPECT_GT(files, 5U) << room;
  }
}

/// Public headers are all that users get: none of them reads a room's own.
TEST(IncludeLaw, PublicHeadersKnowNoRoom) {
  const std::regex quoted(R"(^\s*#include ".*)");
  for (const auto& entry : fs::recursive_directory_iterator(GICODEC_INCLUDE_DIR)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path());
    std::size_t lines = 0;
    for (std::string line; std::getline(file, line); ++lines) {
      EXPECT_FALSE(std::regex_match(line, quoted)) << entry.path() << ": " << line;
    }
    EXPECT_LE(lines, 250U) << entry.path();
  }
}

/// Third-party codecs are seen in one room, and by one file each where that is said.
TEST(IncludeLaw, CodecsOfOthersAreSeenByBackendsOnly) {
  const std::regex foreign(R"re(^\s*#include <(zstd|lz4|lz4hc|x265|libde265/.*|libav.*)\.h>.*)re");
  for (const auto& entry : fs::recursive_directory_iterator(GICODEC_SOURCE_DIR)) {
    if (!entry.is_regular_file()) continue;
    const std::string own = fs::relative(entry.path(), GICODEC_SOURCE_DIR).generic_string();
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);) {
      EXPECT_TRUE(!std::regex_match(line, foreign) || own.rfind("backend/", 0) == 0) << own;
    }
  }
}

}  // namespace

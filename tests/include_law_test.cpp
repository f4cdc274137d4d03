// A room knows only the rooms above it (HACKING.md, "Rooms"): read from what sources include.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;

constexpr const char* kTools = GICODEC_SOURCE_DIR "/../tools";

/// The quoted names of a cell: "`a`, `b`" has two.
Names names_in(const std::string& cell) {
  const std::regex name("`([^`]+)`");
  Names names;
  for (auto at = std::sregex_iterator(cell.begin(), cell.end(), name); at != std::sregex_iterator();
       ++at)
    names.push_back((*at)[1]);
  return names;
}

/// Rows of the page whose first cell begins so, by their first two cells.
std::vector<std::pair<Names, Names>> rows_of_page(const std::string& begin) {
  std::ifstream page(GICODEC_HACKING_PAGE);
  std::vector<std::pair<Names, Names>> rows;
  const std::regex cells(R"(^\| ([^|]*) \| ([^|]*) \|.*)");
  std::smatch match;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("| `" + begin, 0) == 0 && std::regex_match(line, match, cells))
      rows.emplace_back(names_in(match[1]), names_in(match[2]));
  }
  return rows;
}

/// Which rooms stand above which: those of one row do not know each other.
struct Rooms {
  std::map<std::string, std::size_t> rank;

  /// Those below a folder, "src/" or "tools/".
  explicit Rooms(const std::string& folder) {
    std::size_t row = 0;
    for (const auto& [names, unused] : rows_of_page(folder)) {
      for (const std::string& name : names) {
        if (name.rfind(folder, 0) == 0) rank.emplace(name.substr(folder.size()), row);
      }
      ++row;
    }
  }
  /// The room of a path: the longest one that it lies in.
  [[nodiscard]] std::string of(const std::string& path) const {
    std::string found;
    for (const auto& [room, unused] : rank) {
      if (path.rfind(room + "/", 0) == 0 && room.size() > found.size()) found = room;
    }
    return found;
  }
  [[nodiscard]] bool knows(const std::string& room, const std::string& other) const {
    return room == other || rank.at(other) < rank.at(room);
  }
};

/// Calls visit(path below the folder, what it includes) for the includes of all sources.
template <typename Visit>
std::size_t for_includes(const std::string& folder, const std::regex& include, const Visit& visit) {
  const std::set<std::string> kinds{".h", ".cpp", ".inl"};
  std::size_t found = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || kinds.count(entry.path().extension()) == 0) continue;
    const std::string own = fs::relative(entry.path(), folder).generic_string();
    std::ifstream file(entry.path());
    std::smatch match;
    for (std::string line; std::getline(file, line);) {
      if (!std::regex_match(line, match, include)) continue;
      visit(own, match[1].str());
      ++found;
    }
  }
  return found;
}

const std::regex kQuoted(R"re(^\s*#include "([^"]+)".*)re");
const std::regex kPublic(R"re(^\s*#include <(gicodec/[^>]+)>.*)re");

/// The first room that may include each public header.
std::map<std::string, std::string> rooms_of_headers() {
  std::map<std::string, std::string> rooms;
  for (const auto& [headers, room] : rows_of_page("gicodec/")) {
    for (const std::string& header : headers)
      rooms[header] = room.at(0).substr(std::string("src/").size());
  }
  return rooms;
}

TEST(IncludeLaw, APageListsEveryRoom) {
  const Rooms sources("src/"), tools("tools/");
  ASSERT_GE(sources.rank.size(), 10U);
  ASSERT_GE(tools.rank.size(), 10U);
  for (const auto& [folder, rooms] :
       {std::pair{GICODEC_SOURCE_DIR, &sources}, std::pair{kTools, &tools}}) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (!entry.is_directory() || fs::is_empty(entry.path())) continue;
      const std::string name = entry.path().filename();
      EXPECT_TRUE(std::ranges::any_of(rooms->rank, [&](const auto& room) {
        return room.first == name || room.first.starts_with(name + "/");
      })) << entry.path();
    }
  }
}

TEST(IncludeLaw, RoomsKnowOnlyThoseAboveThem) {
  const Rooms rooms("src/");
  const auto visit = [&](const std::string& own, const std::string& included) {
    const std::string room = rooms.of(own), other = rooms.of(included);
    ASSERT_FALSE(room.empty()) << own << " is in no room";
    ASSERT_FALSE(other.empty()) << own << " includes " << included << " by an unknown path";
    EXPECT_TRUE(rooms.knows(room, other)) << own << " includes " << included;
  };
  EXPECT_GT(for_includes(GICODEC_SOURCE_DIR, kQuoted, visit), 200U);
}

TEST(IncludeLaw, RoomsOfToolsKnowOnlyThoseAboveThem) {
  const Rooms rooms("tools/"), sources("src/");
  const auto visit = [&](const std::string& own, const std::string& included) {
    const std::string room = rooms.of(own);
    if (room.empty()) return;  // headers.cpp
    const bool local = included.find('/') == std::string::npos;
    const std::string other = local ? room : rooms.of(included);
    if (other.empty()) {
      EXPECT_EQ(room, "train") << own << " includes " << included;
      EXPECT_FALSE(sources.of(included).empty()) << own << " includes " << included;
      return;
    }
    EXPECT_TRUE(rooms.knows(room, other)) << own << " includes " << included;
  };
  EXPECT_GT(for_includes(kTools, kQuoted, visit), 200U);
}

/// A public header belongs to a room, and what it includes to that one or those above.
TEST(IncludeLaw, PublicHeadersBelongToRooms) {
  const Rooms rooms("src/");
  const auto headers = rooms_of_headers();
  for (const auto& entry : fs::recursive_directory_iterator(GICODEC_INCLUDE_DIR)) {
    if (entry.is_directory()) continue;
    const std::string name = fs::relative(entry.path(), GICODEC_INCLUDE_DIR).generic_string();
    EXPECT_EQ(headers.count(name), 1U) << name;
  }
  const auto of_room = [&](const std::string& own, const std::string& included) {
    ASSERT_EQ(headers.count(included), 1U) << own << " includes " << included;
    EXPECT_LE(rooms.rank.at(headers.at(included)), rooms.rank.at(rooms.of(own)))
        << own << " includes " << included;
  };
  EXPECT_GT(for_includes(GICODEC_SOURCE_DIR, kPublic, of_room), 100U);
  const auto of_header = [&](const std::string& own, const std::string& included) {
    ASSERT_TRUE(headers.count(own) == 1 && headers.count(included) == 1) << own;
    EXPECT_LE(rooms.rank.at(headers.at(included)), rooms.rank.at(headers.at(own)))
        << own << " includes " << included;
  };
  EXPECT_GT(for_includes(GICODEC_INCLUDE_DIR, kPublic, of_header), 100U);
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
  const auto none = [](const std::string& own, const std::string& included) {
    ADD_FAILURE() << own << " includes " << included;
  };
  for_includes(GICODEC_INCLUDE_DIR, kQuoted, none);
  for (const auto& entry : fs::recursive_directory_iterator(GICODEC_INCLUDE_DIR)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path());
    std::size_t lines = 0;
    for (std::string line; std::getline(file, line);) ++lines;
    EXPECT_LE(lines, 250U) << entry.path();
  }
}

/// Third-party codecs are seen by one file, and in one room.
TEST(IncludeLaw, CodecsOfOthersAreSeenInOnePlace) {
  const std::regex bytes(R"re(^\s*#include <((?:zstd|zstd_errors|lz4|lz4hc)\.h)>.*)re");
  const std::regex video(R"re(^\s*#include <((?:x265|libde265/.*|libav.*)\.h)>.*)re");
  const auto one_file = [](const std::string& own, const std::string&) {
    EXPECT_EQ(own, "base/compressor.cpp");
  };
  const auto one_room = [](const std::string& own, const std::string&) {
    EXPECT_TRUE(own.starts_with("backend/hevc/")) << own;
  };
  EXPECT_GT(for_includes(GICODEC_SOURCE_DIR, bytes, one_file), 2U);
  EXPECT_GT(for_includes(GICODEC_SOURCE_DIR, video, one_room), 2U);
}

}  // namespace

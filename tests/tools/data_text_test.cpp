// CSV and JSON of names that hold anything.
#include "dump/data_text.h"
#include "dump_support.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace gicodec::tools {
namespace {

/// What `write` writes to a file.
template <typename Write>
std::string written(const Write& write) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("text");
  std::FILE* const file = std::fopen(path.c_str(), "w");
  write(file);
  std::fclose(file);
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(DataText, FieldsOfCsvStayFields) {
  EXPECT_EQ(csv_field("villa.color"), "villa.color");
  EXPECT_EQ(csv_field(""), "");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("\"a\""), "\"\"\"a\"\"\"");
  EXPECT_EQ(csv_field("a\r\nb\x1b[2J"), "a\\x0d\\x0ab\\x1b[2J");
  EXPECT_EQ(csv_field("\xff,\u202E"), "\"\\xff,\\xe2\\x80\\xae\"");
  const std::vector<std::string> fields{"", "a,b", "c\nd", ""};
  EXPECT_EQ(written([&](std::FILE* file) { write_csv(file, fields); }), ",\"a,b\",c\\x0ad,\n");
}

TEST(DataText, JsonOfAnyStringsCanBeRead) {
  const nlohmann::ordered_json json{{"name", "a\n\x1b\u202E\"\xff"}, {"list", {"\xc2\x85"}}};
  for (const int indent : {-1, 2}) {
    const std::string text = written([&](std::FILE* file) { write_json(file, json, indent); });
    EXPECT_EQ(std::ranges::count(text, '\n'), indent < 0 ? 1 : 6) << text;
    EXPECT_EQ(text.find_first_of("\x1b\xc2\xe2\xff"), std::string::npos) << text;
    const auto read = nlohmann::json::parse(text);
    EXPECT_EQ(read["name"], "a\n\x1b\u202E\"\\xff");
    EXPECT_EQ(read["list"][0], "\xc2\x85");
  }
}

}  // namespace
}  // namespace gicodec::tools

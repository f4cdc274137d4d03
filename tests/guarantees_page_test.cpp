// docs/guarantees.md names the tests that hold its promises: each of them is there. What versions
// promise is what CMake was told.
#include <gicodec/version.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace gicodec {
namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::set<std::string> all;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) {
    all.insert((*it)[1].str() + "." + (*it)[2].str());
  }
  return all;
}

TEST(GuaranteesPage, EveryTestThatItNamesExists) {
  std::set<std::string> tests;
  const std::regex definition(R"((?:TEST|TEST_F|TEST_P|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+))");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(GICODEC_TESTS_DIR)) {
    if (entry.path().extension() == ".cpp") tests.merge(matches(read(entry.path()), definition));
  }
  const std::string page = read(GICODEC_GUARANTEES_PAGE);
  const auto named = matches(page, std::regex(R"(`([A-Z]\w*)\.([A-Z]\w*)`)"));
  EXPECT_GT(named.size(), 20U);
  for (const auto& name : named) EXPECT_TRUE(tests.contains(name)) << name;
  // No section without one.
  for (std::size_t at = page.find("\n## "); at != std::string::npos;) {
    const std::size_t next = page.find("\n## ", at + 1);
    const std::string section = page.substr(at + 1, next - at - 1);
    EXPECT_NE(section.find("Held by"), std::string::npos) << section.substr(0, 40);
    at = next;
  }
}

TEST(GuaranteesPage, VersionsAreThoseOfThePackage) {
  EXPECT_EQ(kVersionString, GICODEC_PROJECT_VERSION);
  const auto number = [](std::uint32_t n) { return std::to_string(n); };
  const std::string minor = number(kVersionMajor) + "." + number(kVersionMinor);
  EXPECT_EQ(minor + "." + number(kVersionPatch), kVersionString);
  // Below 1.0 a minor version may break what a program was linked with: the loader must see it.
  EXPECT_EQ(GICODEC_SOVERSION, kVersionMajor == 0 ? minor : number(kVersionMajor));
}

}  // namespace
}  // namespace gicodec

// docs/kinds.md shows examples/toy_kind.cpp as it is.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace {

std::string text_of(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(KindsPage, ShowsTheExampleThatIsCompiledAndRun) {
  const std::string page = text_of(GICODEC_KINDS_PAGE), example = text_of(GICODEC_TOY_KIND);
  ASSERT_FALSE(example.empty());
  EXPECT_NE(page.find("```cpp\n" + example + "```\n"), std::string::npos);
}

}  // namespace

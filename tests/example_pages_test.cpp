// The pages show the examples as they are.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

void expect_shown(const std::string& page, const std::string& example) {
  const std::string text = text_of(GICODEC_EXAMPLES_DIR "/" + example);
  ASSERT_FALSE(text.empty()) << example;
  EXPECT_NE(text_of(GICODEC_DOCS_DIR "/" + page).find("```cpp\n" + text + "```\n"),
            std::string::npos)
      << page << " shows another " << example;
}

TEST(WriteAKindPage, ShowsTheExampleThatIsCompiledAndRun) {
  expect_shown("write-a-kind.md", "toy_kind.cpp");
}

TEST(LibraryPage, ShowsTheExampleThatIsCompiledAndRun) {
  expect_shown("library.md", "photon_batches.cpp");
}

TEST(StreamFromARendererPage, ShowsTheExamplesThatAreCompiledAndRun) {
  expect_shown("stream-from-a-renderer.md", "probe_server.h");
  expect_shown("stream-from-a-renderer.md", "probe_client.h");
}

TEST(PackEngineDumpsPage, ShowsTheExampleThatIsCompiledAndRun) {
  expect_shown("pack-engine-dumps.md", "engine_container.cpp");
}

TEST(Readme, ShowsTheExampleThatIsBuilt) { expect_shown("../README.md", "round_trip.cpp"); }

}  // namespace

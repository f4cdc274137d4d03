// GoogleTest's main(), but what a crash ends is one test.
#include "supervisor.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

class Announcer final : public testing::EmptyTestEventListener {
 public:
  explicit Announcer(std::function<void(std::string_view)> begins) : begins_(std::move(begins)) {}
  void OnTestStart(const testing::TestInfo& test) override {
    begins_(std::string(test.test_suite_name()) + "." + test.name());
  }

 private:
  std::function<void(std::string_view)> begins_;
};

/// The filter without these.
std::string filter_without(const std::vector<std::string>& names) {
  std::string filter = GTEST_FLAG_GET(filter);
  char before = filter.find('-') == std::string::npos ? '-' : ':';
  for (const std::string& name : names) filter += before + name, before = ':';
  return filter;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<char*> all(argv, argv + argc + 1);  // GoogleTest takes its own away.
  testing::InitGoogleTest(&argc, argv);
  // What is looked at in a debugger stays in this process.
  if (GTEST_FLAG_GET(list_tests) || GTEST_FLAG_GET(break_on_failure)) return RUN_ALL_TESTS();
  const bool good = gicodec::test::supervise(
      const_cast<char**>(all.data()), [](const auto& but, const auto& begins) {
        GTEST_FLAG_SET(filter, filter_without(but));
        testing::UnitTest::GetInstance()->listeners().Append(new Announcer(begins));
        return RUN_ALL_TESTS() == 0;
      });
  return good ? 0 : 1;
}

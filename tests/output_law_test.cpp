// What programs write goes through tools/dump/text.h, data_text.h and file.h, which make names of
// others safe to show and to read (HACKING.md, "Rules").
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;

constexpr const char* kToolsFolder = GICODEC_SOURCE_DIR "/../tools";

/// Calls that write text without these, by the file that may use them.
const std::map<std::string, std::set<std::string>>& exceptions() {
  static const std::map<std::string, std::set<std::string>> files{
      {"common/command_line.cpp", {"cout"}},  // --help, of the program's own words
      {"common/program.cpp", {"fputs"}},      // that there is no memory, without any
      {"dump/data_text.cpp", {"write_text", "dump"}},
      {"dump/file.cpp", {"fwrite"}},
      {"dump/raw.cpp", {"dump"}},  // sidecars, whose names come back as they are
      {"dump/text.cpp", {"fwrite", "write_text"}},
      {"dump/text.h", {"write_text"}},
      {"stream/log.h", {"fwrite", "log_text"}},
      {"stream/service.cpp", {"log_text"}},  // a method of this name, by log_line()
      {"stream/service.h", {"log_text"}},
      {"stream/users.cpp", {"::write"}},  // lines of users, whose names are checked
      {"stream/web_state.cpp", {"::write"}},
      {"train/fit.cpp", {"cerr"}},  // for those who change the source
      {"train/train_native.cpp", {"cout", "cerr"}},
  };
  return files;
}

/// What of it a line of source calls.
std::set<std::string> writes_of(std::string line) {
  static const std::regex words(
      R"re(\b(v?f?printf|v?dprintf|fmt::print|f?puts|f?putc|putchar|fwrite|perror|cout|cerr|clog|o?fstream(?!>)|write_text|log_text)\b|[.>](dump)\(|(?:^|[^\w])(::write)\()re");
  const std::size_t comment = line.find("//");
  if (comment != std::string::npos) line.erase(comment);
  std::set<std::string> found;
  for (std::sregex_iterator at(line.begin(), line.end(), words), end; at != end; ++at) {
    for (std::size_t group = 1; group < at->size(); ++group)
      if ((*at)[group].matched) found.insert((*at)[group]);
  }
  return found;
}

TEST(OutputLaw, TextIsWrittenInOnePlace) {
  std::map<std::string, std::set<std::string>> found;
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kToolsFolder)) {
    const std::string extension = entry.path().extension();
    if (extension != ".cpp" && extension != ".h") continue;
    ++files;
    const std::string own = fs::relative(entry.path(), kToolsFolder).generic_string();
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);)
      for (const std::string& word : writes_of(line)) found[own].insert(word);
  }
  EXPECT_GT(files, 200U);
  for (const auto& [file, words] : found) {
    const auto allowed = exceptions().find(file);
    for (const std::string& word : words) {
      EXPECT_TRUE(allowed != exceptions().end() && allowed->second.contains(word))
          << file << " uses " << word
          << ": print() and log_line() write text for people, write_csv() and write_json() text "
             "for programs, AtomicFile bytes";
    }
  }
  EXPECT_EQ(found, exceptions()) << "an exception that nothing needs";
}

TEST(OutputLaw, FindsWhatWrites) {
  using Words = std::set<std::string>;
  EXPECT_EQ(writes_of("  std::fprintf(stderr, \"x\");"), Words{"fprintf"});
  EXPECT_EQ(writes_of("std::ofstream out(path); out << name;"), Words{"ofstream"});
  EXPECT_EQ(writes_of("  std::cout << json.dump(2);"), (Words{"cout", "dump"}));
  EXPECT_EQ(writes_of("return ::write(1, a, b);"), Words{"::write"});
  EXPECT_EQ(writes_of("tools::print(\"{}\", a);  // not printf()"), Words{});
  EXPECT_EQ(writes_of("#include <fstream>"), Words{});
  EXPECT_EQ(writes_of("void File::write(int byte);"), Words{});
  EXPECT_EQ(writes_of("fmt::print(\"{}\", a);"), Words{"fmt::print"});
}

}  // namespace

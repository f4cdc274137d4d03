// README, HACKING and the pages name only what is there: members, functions, headers, files, flags.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;
using NameSet = std::set<std::string, std::less<>>;

/// What belongs to others, or stands for any name.
const NameSet kOthers = {
    "bevy_pbr::light_probe::irradiance_volume",
    "de265_image::fill_image",
    "de265_image::get_image_plane_at_pos_any_depth",
    "decode_coeff_abs_level_remaining",
    "lws_rx_flow_control",
    "DDGIVolume.cpp",
    "DDGIVolumeSpecification.h",
    "DiffuseProbeGrid.cpp",
    "DiffuseProbeGrid.h",
    "lightmap_gi.cpp",
    "lightmapper_rd.cpp",
    "shuffle3.h",
    "fuzz/NAME.cpp",
    "include/gicodec/NAME.h",
    "src/kinds/NAME.cpp",
    "simd/vector_SET.inl",
    // Functions of three.js.
    "setRequestHeader",
    "setWithCredentials",
    // Functions of programs and tests.
    "any_isa",
    "codings",
    "second_uvs",
    // CMake, CTest, Node, Google Benchmark, Git and pkg-config.
    "--benchmark_filter",
    "--build",
    "--cflags",
    "--install",
    "--libs",
    "--no-experimental-fetch",
    "--prefix",
    "--preset",
    "--static",
    "--target",
    "--test-dir",
    "--dry-run",
};

fs::path root() { return fs::path(GICODEC_DOCS_DIR).parent_path(); }

std::string read(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Without comments that go to the end of a line.
std::string without_comments(std::string text) {
  for (std::size_t at = 0; (at = text.find("//", at)) != std::string::npos;) {
    if (at > 0 && text[at - 1] == ':') {  // an address
      ++at;
      continue;
    }
    text.erase(at, std::min(text.find('\n', at), text.size()) - at);
  }
  return text;
}

/// What the tree has.
class Tree {
 public:
  Tree() {
    for (const char* room : {"include", "src", "tools", "tests", "bench", "fuzz", "examples",
                             "script", "packaging", "cmake", "testdata", "docs", "bindings"}) {
      for (const auto& entry : fs::recursive_directory_iterator(root_ / room)) add(entry.path());
    }
    for (const auto& entry : fs::directory_iterator(root_)) {
      if (entry.is_regular_file()) add(entry.path());
    }
  }

  [[nodiscard]] bool has_path(const std::string& path) const {
    const auto in = [&](const char* room) { return fs::exists(root_ / room / path); };
    return files_.contains(path) || in("") || in("src") || in("tools") || in("tests") ||
           in("src/native") || in("include") || in("examples/shaders");
  }
  [[nodiscard]] bool has_header(const std::string& path) const {
    return fs::exists(root_ / "include" / path);
  }
  [[nodiscard]] bool has_function(const std::string& name) const { return called_.contains(name); }
  /// "Class::member", perhaps with names between: where the class is defined, or by that name.
  [[nodiscard]] bool has_member(const std::string& name) const {
    const std::string first = name.substr(0, name.find("::"));
    const std::string last = name.substr(name.rfind("::") + 2);
    return std::ranges::any_of(sources_, [&](const Source& source) {
      return source.words.contains(last) &&
             (source.defined.contains(first) || source.text.find(name) != std::string::npos);
    });
  }
  [[nodiscard]] bool has_flag(const std::string& flag) const { return flags_.contains(flag); }

 private:
  struct Source {
    std::string text;
    NameSet words, defined;
  };

  void add(const fs::path& path) {
    if (!fs::is_regular_file(path)) return;
    files_.insert(path.filename().string());
    const std::string extension = path.extension().string();
    const bool code = extension == ".h" || extension == ".cpp" || extension == ".inl" ||
                      extension == ".glsl" || extension == ".hlsl" || extension == ".cmake" ||
                      extension == ".js" || path.filename() == "CMakeLists.txt";
    const bool script = extension.empty() || extension == ".sh" || extension == ".py";
    // Names of this test itself prove nothing.
    if (path == fs::path(__FILE__) || path.filename() == "page_names_test.cpp") return;
    if (script) note_flags(read(path), true);
    if (!code) return;
    Source source{without_comments(read(path)), {}, {}};
    // Functions of programs and tests have any names; pages speak of the library's.
    const std::string room = (*fs::relative(path, root_).begin()).string();
    note_words(source, room == "include" || room == "src" || room == "examples" ||
                           room == "bindings" || extension == ".cmake" ||
                           path.filename() == "CMakeLists.txt");
    if (extension == ".cpp" || extension == ".h") note_flags(source.text, false);
    sources_.push_back(std::move(source));
  }

  void note_words(Source& source, bool takes_calls) {
    const std::string& text = source.text;
    std::string before;
    for (std::size_t at = 0; at < text.size();) {
      if (!is_word(text[at])) {
        ++at;
        continue;
      }
      std::size_t end = at;
      while (end < text.size() && is_word(text[end])) ++end;
      std::string word = text.substr(at, end - at);
      if (takes_calls && end < text.size() && text[end] == '(') called_.insert(word);
      // "class GICODEC_LOCAL Name" too.
      const bool defines =
          before == "class" || before == "struct" || before == "namespace" || before == "union";
      if (defines && !word.starts_with("GICODEC_")) source.defined.insert(word);
      if (!defines || !word.starts_with("GICODEC_")) before = word;
      source.words.insert(std::move(word));
      at = end;
    }
  }

  /// Flags of programs stand alone in a text, or beside their short form; those of scripts
  /// anywhere. Settings become flags.
  void note_flags(const std::string& text, bool anywhere) {
    for (std::size_t at = 0; (at = text.find("--", at)) != std::string::npos; ++at) {
      std::size_t end = at + 2;
      while (end < text.size() && (is_word(text[end]) || text[end] == '-')) ++end;
      const char before = at > 0 ? text[at - 1] : ' ';
      const char after = end < text.size() ? text[end] : ' ';
      const bool alone = (before == '"' || before == ',' || before == '!') &&
                         (after == '"' || after == ',' || after == '{');
      if (anywhere || alone) flags_.insert(text.substr(at, end - at));
    }
    constexpr std::string_view kSetting = "Setting{\"";
    for (std::size_t at = 0; (at = text.find(kSetting, at)) != std::string::npos;) {
      at += kSetting.size();
      flags_.insert("--" + text.substr(at, text.find('"', at) - at));
    }
  }

  fs::path root_ = root();
  NameSet files_, called_, flags_;
  std::vector<Source> sources_;
};

/// What a page has in backticks, and the command lines of its examples.
std::vector<std::string> quoted(const std::string& page) {
  std::vector<std::string> all;
  std::string open;  // what began on an earlier line of the paragraph
  bool fenced = false, inside = false;
  for (std::size_t at = 0; at < page.size();) {
    const std::size_t end = std::min(page.find('\n', at), page.size());
    const std::string line = page.substr(at, end - at);
    at = end + 1;
    if (line.starts_with("```")) {
      fenced = !fenced;
      inside = false;
      continue;
    }
    if (fenced) {
      const bool command = line.starts_with("gi") || line.starts_with("script/");
      if (command) all.push_back(line.substr(0, line.find("  #")));
      continue;
    }
    if (line.empty()) inside = false;
    if (inside) open += ' ';
    for (const char c : line) {
      if (c != '`') {
        if (inside) open += c;
        continue;
      }
      if (inside) all.push_back(open);
      inside = !inside;
      open.clear();
    }
  }
  return all;
}

std::vector<std::string> find_all(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> all;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) {
    all.push_back((*it)[1].str());
  }
  return all;
}

/// What one piece of a page names and the tree does not have.
std::vector<std::string> missing(const Tree& tree, const std::string& text) {
  static const std::regex member(R"(^((?:[A-Za-z_]\w*::)+~?[A-Za-z_]\w*)(?:\(.*\))?$)");
  static const std::regex function(R"(^([A-Za-z_]\w*)\((?!1\))[^()]*\)$)");
  static const std::regex header(R"(<(gicodec/\w+\.h)>)");
  static const std::regex path(R"((?:^|\s)([A-Za-z_][\w-]*/[\w./-]*\w|[A-Za-z_]\w*\.(?:cpp|h|inl)))"
                               R"((?=$|[\s,;)]))");
  static const std::regex rooted(
      "^(src|tools|tests|script|docs|examples|include|bench|fuzz|"
      "packaging|cmake|testdata)/");
  static const std::regex file(R"(^[\w./-]+\.(cpp|h|inl|sh|cmake)$)");
  static const std::regex flag(R"((?:^|[\s\[(])(--[a-z][\w-]+))");
  std::vector<std::string> all;
  const auto check = [&](const std::string& name, bool there) {
    if (!there && !kOthers.contains(name)) all.push_back(name);
  };
  for (const std::string& name : find_all(text, member)) {
    if (!name.starts_with("std::")) check(name, tree.has_member(name));
  }
  for (const std::string& name : find_all(text, function)) check(name, tree.has_function(name));
  for (const std::string& name : find_all(text, header)) check(name, tree.has_header(name));
  for (const std::string& name : find_all(text, path)) {
    const bool ours = std::regex_search(name, rooted) || std::regex_search(name, file);
    if (ours && !name.starts_with("build/")) check(name, tree.has_path(name));
  }
  for (const std::string& name : find_all(text, flag)) check(name, tree.has_flag(name));
  return all;
}

std::vector<fs::path> pages() {
  std::vector<fs::path> all = {root() / "README.md", root() / "HACKING.md"};
  for (const auto& entry : fs::directory_iterator(GICODEC_DOCS_DIR)) {
    if (entry.path().extension() == ".md") all.push_back(entry.path());
  }
  return all;
}

TEST(PageNames, AllAreThere) {
  const Tree tree;
  std::size_t pieces = 0;
  for (const fs::path& path : pages()) {
    for (const std::string& text : quoted(read(path))) {
      ++pieces;
      for (const std::string& name : missing(tree, text)) {
        ADD_FAILURE() << path.filename().string() << ": `" << text << "`: there is no " << name;
      }
    }
  }
  EXPECT_GT(pieces, 1000U);
}

TEST(PageNames, WhatIsNotThereIsFound) {
  const Tree tree;
  for (const char* name :
       {"Server::look", "TextureGroup::together", "NoClass::publish", "no_such_function()",
        "<gicodec/host.h>", "src/no_such_file.cpp", "no_such_file.h", "--no-flag-of-ours"}) {
    EXPECT_EQ(missing(tree, name).size(), 1U) << name;
  }
  for (const char* name : {"Server::publish", "TextureGroup::bundled", "publish(volume, blocks)",
                           "<gicodec/server.h>", "src/stream/encoder.cpp", "encoder.cpp",
                           "gicodec encode --vk-format color=R16_UNORM", "std::bit_cast"}) {
    EXPECT_TRUE(missing(tree, name).empty()) << name;
  }
  EXPECT_EQ(quoted("a `b\nc` d\n\n```sh\ngicodec info x  # y `z`\n```\n"),
            (std::vector<std::string>{"b c", "gicodec info x"}));
}

}  // namespace

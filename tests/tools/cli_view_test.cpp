// gicodec view --export: what a page gets inside, and what is refused.
#include "dump/file.h"
#include "tools/cli_support.h"
#include "tools/dump_support.h"

#include <gicodec/engines.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace gicodec::tools {
namespace {

class CliView : public testing::Test {
 protected:
  CliView() {
    const VolumeDesc volume = *three_volume({2, 2, 1});
    const Dump dump = random_dump(textures_of(volume)[0]->desc, 1);
    std::filesystem::create_directories(program_.path("in"));
    write_dump(program_.path("in/grid.0000.ktx2"), dump.info, dump.texels);
    program_.succeed({"encode", "-o", "x.gic", "--layout", "three", "--grid", "2x2x1", "in"});
    write("page.html", "<html><!-- files -->\n</html>");
  }
  void write(const std::string& name, std::string_view text) {
    write_file(program_.path(name), std::as_bytes(std::span(text)), Existing::replace);
  }
  [[nodiscard]] std::string text_of(const std::string& name) const {
    const auto bytes = file_bytes(program_.path(name));
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  Program program_;
};

/// Base64 by another rule than the program's: six bits at a time.
std::string decoded(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned word = 0, bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    word = word << 6 | static_cast<unsigned>(kDigits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(word >> bits & 255);
  }
  return bytes;
}

std::string between(const std::string& text, std::string_view begin, std::string_view end) {
  const std::size_t from = text.find(begin) + begin.size();
  return text.substr(from, text.find(end, from) - from);
}

TEST_F(CliView, PutsFilesInsideAPage) {
  for (const std::string_view scene : {"glTF", "glTF2", "glTF20"}) {  // each end of base64
    write("room.glb", scene);
    program_.succeed({"view", "x.gic", "--scene", "room.glb", "--page", "page.html", "--export",
                      "out.html", "--overwrite"});
    const std::string page = text_of("out.html");
    EXPECT_TRUE(
        page.starts_with("<html><script type=\"application/octet-stream\" id=\"container\" "
                         "data-name=\"x.gic\">"));
    EXPECT_TRUE(page.ends_with("</script>\n\n</html>"));
    EXPECT_EQ(decoded(between(page, "data-name=\"x.gic\">", "</script>")), text_of("x.gic"));
    EXPECT_EQ(decoded(between(page, "data-name=\"room.glb\">", "</script>")), scene);
  }
}

TEST_F(CliView, NamesAreText) {
  if (kWindows) return;  // which has no such names
  const std::string name = "<a b='c'>&\".gic";
  std::filesystem::copy(program_.path("x.gic"), program_.path(name));
  program_.succeed({"view", name, "--page", "page.html", "--export", "out.html"});
  EXPECT_EQ(between(text_of("out.html"), "data-name=\"", "\""),
            "&#60;a b=&#39;c&#39;&#62;&#38;&#34;.gic");
}

TEST_F(CliView, RefusesWhatItCannotShow) {
  const auto refuse = [&](Exit exit, const Arguments& words,
                          const std::vector<std::string>& parts) {
    program_.expect_failure(exit, Arguments{"view"} + words, parts);
    EXPECT_FALSE(std::filesystem::exists(program_.path("out.html")));
  };
  const Arguments to{"--export", "out.html"}, page{"--page", "page.html"};
  refuse(Exit::io, Arguments{"absent.gic"} + to + page, {"absent.gic"});
  write("bad.gic", "no container");
  refuse(Exit::bad_input, Arguments{"bad.gic"} + to + page, {"bad.gic"});
  refuse(Exit::io, Arguments{"x.gic"} + to, {"script/build-web", "--page"});
  write("other.html", "<html></html>");
  refuse(Exit::bad_input, Arguments{"x.gic", "--page", "other.html"} + to,
         {"other.html: is not the viewer.html"});
  refuse(Exit::io, Arguments{"x.gic", "--page", "in"} + to, {"in: is a folder"});
  refuse(Exit::io, Arguments{"x.gic", "--scene", "in"} + to + page, {"in: "});
  refuse(Exit::io, Arguments{"x.gic", "--scene", "absent.glb"} + to + page, {"absent.glb"});
  refuse(Exit::bad_input, Arguments{"x.gic", "--scene", "x.gic"} + to + page, {"glTF", "gi-trace"});
  refuse(Exit::usage, Arguments{"x.gic", "--export", "x.gic", "--overwrite"} + page, {"x.gic"});
  write("there.html", "mine");
  refuse(Exit::io, Arguments{"x.gic", "--export", "there.html"} + page,
         {"there.html", "--overwrite"});
  EXPECT_EQ(text_of("there.html"), "mine");
}

}  // namespace
}  // namespace gicodec::tools

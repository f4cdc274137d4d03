#include "tools/cli_support.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace gicodec::tools {
namespace {

std::string text_of(const std::string& path) {
  const auto bytes = file_bytes(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Outcome Program::run(const std::vector<std::string>& arguments,
                     const std::string& input_file) const {
  const TemporaryDirectory streams;
  const std::string out = streams.path("out"), err = streams.path("err");
  std::vector<char*> argv = {const_cast<char*>(GICODEC_CLI)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  // x265 does not free everything it allocates; only LeakSanitizer looks at this.
  const std::string suppressions = streams.path("suppressions");
  write_bytes(suppressions, std::as_bytes(std::span(std::string_view("leak:libx265\n"))));
  const std::string lsan_options = "print_suppressions=0:suppressions=" + suppressions;
  const std::string root = directory_.path("");
  const pid_t child = fork();
  if (child == 0) {
    const auto redirect = [](const std::string& path, int flags, int to) {
      const int from = open(path.c_str(), flags, 0644);
      if (from < 0 || dup2(from, to) < 0) _exit(125);
    };
    redirect(input_file, O_RDONLY, 0);
    redirect(out, O_WRONLY | O_CREAT, 1);
    redirect(err, O_WRONLY | O_CREAT, 2);
    if (chdir(root.c_str()) != 0) _exit(125);
    setenv("LSAN_OPTIONS", lsan_options.c_str(), 1);
    execv(argv[0], argv.data());
    _exit(126);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, text_of(out), text_of(err)};
}

Outcome Program::succeed(const std::vector<std::string>& arguments) const {
  Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  return outcome;
}

void Program::expect_failure(Exit exit, const std::vector<std::string>& arguments,
                             const std::vector<std::string>& parts) const {
  const auto before = files();
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.exit, static_cast<int>(exit)) << outcome.out << outcome.err;
  for (const std::string& part : parts) {
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err << "lacks " << part;
  }
  EXPECT_EQ(files(), before) << "something was left behind";
}

std::vector<std::string> Program::make_dumps(unsigned frames) const {
  std::filesystem::create_directories(path("in"));
  std::vector<std::string> paths;
  for (const TextureDesc& desc : {kColourDesc, kVisDesc}) {
    const bool colour = desc.core == 8;
    Dump dump = random_dump(desc, desc.core);
    if (colour) dump = without_alpha(dump);
    for (unsigned frame = 0; frame < frames; ++frame) {
      dump.texels[(frame * 977U) * 4 % dump.texels.size()] ^= std::byte{0x3C};
      paths.push_back(path(fmt::format("in/{}.{:04}.exr", colour ? "color" : "vis", frame)));
      write_dump(paths.back(), dump.info, dump.texels);
    }
  }
  return paths;
}

}  // namespace gicodec::tools

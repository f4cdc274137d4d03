#include "tools/cli_support.h"

#include <gtest/gtest.h>

#include <cstring>

namespace gicodec::tools {

namespace {

/// Pictures are not in every build.
bool is_left_out(const std::vector<std::string>& arguments) {
  return !kWithImages && !arguments.empty() && arguments.front() == "preview";
}

}  // namespace

Outcome Program::succeed(const std::vector<std::string>& arguments) const {
  Outcome outcome;
  if (is_left_out(arguments)) return outcome;
  outcome = run(arguments);
  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  return outcome;
}

void Program::expect_failure(Exit exit, const std::vector<std::string>& arguments,
                             const std::vector<std::string>& parts) const {
  if (is_left_out(arguments)) return;
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
    const bool colour = desc.block.x == 8;
    Dump dump = random_dump(desc, desc.block.x);
    if (colour) dump = without_alpha(dump);
    for (unsigned frame = 0; frame < frames; ++frame) {
      dump.texels[(frame * 977U) * 4 % dump.texels.size()] ^= std::byte{0x3C};
      paths.push_back(path(fmt::format("in/{}.{:04}.exr", colour ? "color" : "vis", frame)));
      write_dump(paths.back(), dump.info, dump.texels);
    }
  }
  return paths;
}

// The end entry: type, size, offset of the last index part, checksum.
std::size_t end_of_packets(std::span<const std::byte> container) {
  std::uint64_t offset = 0;
  std::memcpy(&offset, &container[container.size() - 12], sizeof offset);
  return static_cast<std::size_t>(offset);
}

}  // namespace gicodec::tools

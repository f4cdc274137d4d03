// Long sequences and great containers in little memory.
#include "tools/cli_support.h"

#include <gtest/gtest.h>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

constexpr long kMegabyte = 1024;

/// Writes frames of one texture that differ in everything if `noise`, else in a few probes.
void write_frames(const Program& program, const TextureDesc& desc, unsigned frames, bool noise) {
  fs::create_directories(program.path("in"));
  Dump dump = random_dump(desc, 1);
  set_attribute(dump.info.attributes, {"compression", "compression", "0x00"});
  for (unsigned frame = 0; frame < frames; ++frame) {
    if (noise) dump.texels = random_texels(desc, frame);
    dump.texels[frame * 977U % (dump.texels.size() / 4) * 4] ^= std::byte{1};
    set_attribute(dump.info.attributes, {"gicodec:time", "float", fmt::format("{}", frame * 0.5)});
    const std::string path = program.path(fmt::format("in/vis.{:05}.exr", frame));
    write_bytes(path, to_exr({&dump, 1}, path));  // Without waiting for the disk.
  }
}

/// Runs a command and gives the most memory it took, in MB.
long peak(const Program& program, const std::vector<std::string>& arguments) {
  // What AddressSanitizer keeps of freed memory is not the program's.
  setenv("ASAN_OPTIONS", "quarantine_size_mb=1", 1);
  Circumstances watched;
  watched.kill_when = [] { return false; };
  const Outcome outcome = program.run_in(watched, arguments);
  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  const long megabytes = outcome.peak_kilobytes / kMegabyte;
  testing::Test::RecordProperty(arguments[0] + "_peak_megabytes", std::to_string(megabytes));
  fmt::print("{}: at most {} MB\n", arguments[0], megabytes);
  return megabytes;
}

/// The most memory of each command.
std::vector<long> peaks(const Program& program) {
  return {peak(program, {"encode", "-o", "x.gic", "--backend", "raw", "--gop", "1", "in"}),
          peak(program, {"verify", "x.gic", "in"}), peak(program, {"info", "x.gic"}),
          peak(program, {"decode", "x.gic", "-o", "out"})};
}

// Ten times the frames take hardly more memory: names, attributes that change and the seek index.
TEST(CliLong, TenThousandFrames) {
  const TextureDesc desc = ddgi_visibility({2, 2, 1});
  std::vector<long> few, many;
  {
    const Program program;
    write_frames(program, desc, 1000, false);
    few = peaks(program);
  }
  const Program program;
  write_frames(program, desc, 10000, false);
  many = peaks(program);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_LT(many[i], few[i] + 100) << i;
  program.succeed({"compare", "-q", "in", "out"});
}

TEST(CliLong, ContainerOfAGigabyte) {
  const TextureDesc desc = ddgi_visibility({32, 16, 32});
  const unsigned frames =
      (1U << 30) / static_cast<unsigned>(texture_bytes(desc)) * 4 / 3;  // Core only.
  const Program program;
  write_frames(program, desc, frames, true);
  for (const long megabytes : peaks(program)) EXPECT_LT(megabytes, 1024);
  EXPECT_GT(fs::file_size(program.path("x.gic")), std::uintmax_t{1} << 30);
}

TEST(CliLong, Volumes) {
  const Program program;
  for (const TextureDesc& desc : {ddgi_irradiance({64, 16, 64}), ddgi_visibility({64, 16, 64})}) {
    fs::remove_all(program.path("in"));
    fs::remove_all(program.path("out"));
    write_frames(program, desc, 2, false);
    program.succeed({"encode", "-o", "x.gic", "in"});
    program.succeed({"verify", "x.gic", "in"});
    program.succeed({"decode", "x.gic", "-o", "out"});
    program.succeed({"compare", "in", "out"});
  }
}

}  // namespace
}  // namespace gicodec::tools

// Disks that are full, programs that are killed: former outputs stay, and what was written of a
// container can be read.
#include "dump/file.h"
#include "tools/cli_support.h"

#include <gicodec/textures.h>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

class CliFault : public testing::Test {
 protected:
  [[nodiscard]] Outcome limited(std::uint64_t bytes,
                                const std::vector<std::string>& arguments) const {
    Circumstances full;
    full.file_bytes = bytes;
    return program_.run_in(full, arguments);
  }
  Program program_;
};

// Standard error may be on that disk as well.
TEST_F(CliFault, FullDisk) {
  program_.make_dumps(3);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  program_.succeed({"decode", "x.gic", "-o", "out"});
  const auto container = file_bytes(program_.path("x.gic"));
  const auto files = program_.files();
  for (const std::size_t bytes : {std::size_t{1}, container.size() / 2}) {
    const Outcome outcome = limited(bytes, {"encode", "-o", "x.gic", "--backend", "raw", "in"});
    EXPECT_EQ(outcome.exit, 4) << bytes;
    EXPECT_EQ(file_bytes(program_.path("x.gic")), container);
    EXPECT_EQ(program_.files(), files);
  }
  const auto dumps = program_.files("out");
  for (const std::uint64_t bytes : {1, 5000}) {
    const Outcome outcome = limited(bytes, {"decode", "x.gic", "-o", "out", "--overwrite"});
    EXPECT_EQ(outcome.exit, 4);
    EXPECT_EQ(bytes > 1, outcome.err.find("too large") != std::string::npos) << outcome.err;
    EXPECT_EQ(program_.files("out"), dumps);
    for (const std::string& name : dumps) {
      EXPECT_EQ(file_bytes(program_.path("out/" + name)), file_bytes(program_.path("in/" + name)));
    }
    EXPECT_EQ(limited(bytes, {"decode", "x.gic", "-o", "new"}).exit, 4);
    EXPECT_FALSE(fs::exists(program_.path("new"))) << "a folder or temporary was left behind";
  }
}

/// Texels and the sidecar that describes them are of one decoding, on a full disk too.
TEST_F(CliFault, FullDiskUnderASidecar) {
  const auto make = [&](const char* name, Format format, Grid size, std::uint32_t seed) {
    const TextureDesc desc = map_texture(format, size, {8, 8, 1});
    const Dump dump{make_info(desc), random_texels(desc, seed)};
    fs::create_directories(program_.path(name));
    write_dump(program_.path(fmt::format("{}/a.raw", name)), dump.info, dump.texels);
    program_.succeed({"encode", "-q", "-o", fmt::format("{}.gic", name), name});
  };
  make("old", Format::R16_UNORM, {80, 25, 1}, 1);
  make("new", Format::R8G8B8A8_UNORM, {40, 25, 1}, 2);
  fs::copy(program_.path("old"), program_.path("out"));
  EXPECT_EQ(limited(1024, {"decode", "new.gic", "-o", "out", "--overwrite"}).exit, 4);
  for (const char* name : {"a.raw", "a.json"}) {
    EXPECT_EQ(file_bytes(program_.path(fmt::format("out/{}", name))),
              file_bytes(program_.path(fmt::format("old/{}", name))));
  }
  EXPECT_EQ(program_.files("out").size(), 2U);
  EXPECT_EQ(limited(1024, {"decode", "new.gic", "-o", "other"}).exit, 4);
  EXPECT_FALSE(fs::exists(program_.path("other")));
}

#if defined(GICODEC_FAILING_MALLOC)
/// Any allocation may fail: what is there is whole, and the exit code says whether it is all. Those
/// before main() are of the loader.
TEST_F(CliFault, AllocationsThatFail) {
  program_.make_dumps(1);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  program_.succeed({"decode", "x.gic", "-o", "raw", "--files", "raw"});
  const auto allocations = [&](const std::vector<std::string>& arguments) {
    Circumstances counted;
    counted.allocations = program_.path("count");
    EXPECT_EQ(program_.run_in(counted, arguments).exit, 0);
    const auto bytes = file_bytes(program_.path("count"));
    return std::stol(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  };
  const long first = allocations({"--version"});
  for (const std::string kind : {"in", "raw"}) {
    const std::vector<std::string> decode = {
        "decode",    "x.gic",      "-o",      "out",
        "--threads", "1",          "--files", kind == "in" ? "exr" : "raw",
        "--quiet",   "--overwrite"};
    const long last = allocations(decode);
    ASSERT_GT(last, first);
    for (long number = first; number <= last; number += 1 + (last - first) / 60) {
      fs::remove_all(program_.path("out"));
      Circumstances failing;
      failing.failing_allocation = number;
      const Outcome outcome = program_.run_in(failing, decode);
      EXPECT_TRUE(outcome.exit == 0 || outcome.exit == 4 || outcome.exit == 5)
          << number << ": " << outcome.exit << outcome.err;
      const auto files =
          fs::exists(program_.path("out")) ? program_.files("out") : std::vector<std::string>();
      if (outcome.exit == 0) {
        EXPECT_EQ(files, program_.files(kind)) << number;
      }
      for (const std::string& name : files) {
        ASSERT_TRUE(fs::exists(program_.path(kind + "/" + name))) << number << name;
        EXPECT_EQ(file_bytes(program_.path("out/" + name)),
                  file_bytes(program_.path(kind + "/" + name)))
            << number << name;
      }
    }
  }
}
#endif

TEST_F(CliFault, ResultsThatCannotBeWritten) {
  program_.make_dumps(1);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  for (const std::vector<std::string>& command : {std::vector<std::string>{"info", "x.gic"},
                                                  {"info", "x.gic", "--format", "json"},
                                                  {"backends"},
                                                  {"verify", "x.gic", "in"},
                                                  {"--help"}}) {
    EXPECT_EQ(limited(1, command).exit, 4) << command.front();
  }
}

TEST_F(CliFault, KilledEncoderLeavesAPartialContainer) {
  constexpr unsigned kFrames = 16;
  program_.make_dumps(kFrames);
  program_.succeed({"encode", "-o", "whole.gic", "in"});
  const auto whole = file_bytes(program_.path("whole.gic"));
  const std::string old = "\x89GIC\r\n\x1a\n, but an old one";
  const std::string partial = program_.path("x.gic.partial");
  for (const double share : {0.0, 0.1, 0.97}) {  // 0.97 is behind both keyframes.
    write_bytes(program_.path("x.gic"), std::as_bytes(std::span(old)));
    const auto enough = static_cast<std::uintmax_t>(share * static_cast<double>(whole.size()));
    Circumstances killed;
    killed.kill_when = [&] {
      std::error_code error;
      const auto size = fs::file_size(partial, error);
      return !error && size >= enough;
    };
    const Outcome outcome = program_.run_in(killed, {"encode", "-o", "x.gic", "in"});
    if (outcome.exit == 0) continue;  // It was faster.
    EXPECT_EQ(outcome.exit, 128 + SIGKILL);
    EXPECT_EQ(file_bytes(program_.path("x.gic")).size(), old.size());
    const auto left = file_bytes(partial);
    ASSERT_TRUE(std::equal(left.begin(), left.end(), whole.begin()));
    if (left.empty()) continue;
    program_.expect_failure(Exit::io, {"encode", "-o", "x.gic", "in"},
                            {"x.gic.partial", "was left over", "gicodec decode"});
    ASSERT_EQ(file_bytes(partial), left);
    fs::rename(partial, program_.path("rescued.gic"));
    if (share == 0.0) continue;  // May be cut within the description.

    // Every whole packet comes back.
    fs::remove_all(program_.path("out"));
    const Outcome decoded =
        program_.succeed({"decode", "rescued.gic", "-o", "out", "--allow-incomplete"});
    if (left.size() < whole.size()) {  // Else it was killed when all was written.
      EXPECT_NE(decoded.err.find(fmt::format("of frames 0-{}", kFrames - 1)), std::string::npos)
          << decoded.err;
    }
    const auto files = program_.files("out");
    if (share > 0.5) {
      EXPECT_GE(files.size(), 4U);
    }
    for (const std::string& name : files) {
      ASSERT_EQ(file_bytes(program_.path("out/" + name)), file_bytes(program_.path("in/" + name)));
    }
  }
  program_.succeed({"encode", "-o", "x.gic", "in"});
  EXPECT_EQ(file_bytes(program_.path("x.gic")), whole);
  EXPECT_FALSE(fs::exists(partial));
}

TEST_F(CliFault, APartialFileOfSomethingElseStays) {
  program_.make_dumps(1);
  write_bytes(program_.path("x.gic.partial"), std::as_bytes(std::span("a user's own")));
  program_.expect_failure(Exit::io, {"encode", "-o", "x.gic", "in"},
                          {"x.gic.partial", "is in the way"});
  EXPECT_EQ(file_bytes(program_.path("x.gic.partial")).size(), 13U);
  fs::remove(program_.path("x.gic.partial"));
  {
    AtomicFile other(program_.path("x.gic"), Existing::container, AtomicFile::Temporary::partial);
    program_.expect_failure(Exit::io, {"encode", "-o", "x.gic", "in"},
                            {"x.gic.partial", "another program"});
  }
  EXPECT_FALSE(fs::exists(program_.path("x.gic.partial")));
}

TEST_F(CliFault, KilledDecoderLeavesWholeFiles) {
  program_.make_dumps(10);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  const auto names = program_.files("in");
  const std::string old = "an old dump";
  for (const std::size_t wanted : {1U, 8U}) {
    fs::create_directories(program_.path("out"));
    for (const std::string& name : names) {
      write_bytes(program_.path("out/" + name), std::as_bytes(std::span(old)));
    }
    Circumstances killed;
    killed.kill_when = [&] {
      const auto changed = std::count_if(names.begin(), names.end(), [&](const std::string& name) {
        return fs::file_size(program_.path("out/" + name)) != old.size();
      });
      return static_cast<std::size_t>(changed) >= wanted;
    };
    (void)program_.run_in(killed, {"decode", "x.gic", "-o", "out", "--overwrite"});
    for (const std::string& name : names) {
      const auto bytes = file_bytes(program_.path("out/" + name));
      EXPECT_TRUE(bytes.size() == old.size() || bytes == file_bytes(program_.path("in/" + name)))
          << name << " after " << wanted;
    }
  }
}

// Many probes in little memory: blocks of one texel and its guard band.
// Else the container would get the number of standard error, and the summary.
TEST_F(CliFault, ClosedStreams) {
  program_.make_dumps(2);
  program_.succeed({"encode", "-q", "-o", "x.gic", "in"});
  Circumstances closed{.kill_when = {}};
  closed.closed = true;
  EXPECT_EQ(program_.run_in(closed, {"encode", "-o", "y.gic", "in"}).exit, 0);
  EXPECT_EQ(file_bytes(program_.path("y.gic")), file_bytes(program_.path("x.gic")));
  EXPECT_EQ(program_.run_in(closed, {"info", "x.gic"}).exit, 4);
}

// The loader would end the program.
TEST_F(CliFault, ModulesThatAreNone) {
  program_.make_dumps(1);
  program_.succeed({"encode", "-o", "x.gic", "in"});
  fs::create_directories(program_.path("modules"));
  Circumstances other;
  other.libraries = program_.path("modules");
  const auto program = file_bytes(GICODEC_CLI);
  const std::span whole(program);
  const std::string_view text =
      "no module, but longer than the head of an ELF file would have to be";
  for (const auto bytes : {std::span<const std::byte>(), std::as_bytes(std::span(text)),
                           std::span<const std::byte>(whole.first(4)),
                           std::span<const std::byte>(whole.first(whole.size() / 2)),
                           std::span<const std::byte>(whole.first(whole.size() - 1))}) {
    write_bytes(program_.path("modules/gicodec-images.so"), bytes);
    const Outcome outcome = program_.run_in(other, {"preview", "x.gic", "-o", "x.png"});
    EXPECT_EQ(outcome.exit, static_cast<int>(Exit::internal)) << bytes.size();
    EXPECT_NE(outcome.err.find("modules/gicodec-images.so"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("is damaged; install it again"), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(program_.path("x.png")));
  }
  // What needs no module goes on.
  EXPECT_EQ(program_.run_in(other, {"info", "x.gic"}).exit, 0);
}

TEST_F(CliFault, WhatWaitsForAPipeCanBeEnded) {
  program_.make_dumps(1);
  ASSERT_EQ(mkfifo(program_.path("pipe").c_str(), 0600), 0);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"info", "pipe"}, {"encode", "-o", "pipe", "in"}}) {
    int asked = 0;
    Circumstances ended;
    ended.kill_when = [&] { return ++asked > 1000; };
    ended.signal = SIGTERM;
    EXPECT_EQ(program_.run_in(ended, command).exit, 128 + SIGTERM) << command.front();
  }
}

// What takes seconds is not written once it is interrupted.
TEST_F(CliFault, InterruptedPictures) {
  const TextureDesc desc = probe_texture(Format::R8G8B8A8_UNORM, {64, 32, 4}, 30);
  fs::create_directories(program_.path("in"));
  const Dump dump = random_dump(desc, 1);
  write_dump(program_.path("in/c.0000.exr"), dump.info, dump.texels);
  for (const int asked_before : {100, 2000}) {
    int asked = 0;
    Circumstances ended;
    ended.kill_when = [&] { return ++asked > asked_before; };
    ended.signal = SIGTERM;
    const Outcome outcome = program_.run_in(ended, {"preview", "in/c.0000.exr", "-o", "c.png"});
    EXPECT_TRUE(outcome.exit == 0 || outcome.exit == 128 + SIGTERM) << outcome.err;
    EXPECT_EQ(fs::exists(program_.path("c.png")), outcome.exit == 0);
    fs::remove(program_.path("c.png"));
  }
}

TEST_F(CliFault, VolumesOf65536Probes) {
  const TextureDesc desc = probe_texture(Format::A2R10G10B10_UNORM_PACK32, {64, 16, 64}, 1);
  Dump dump = random_dump(desc, 1);
  fs::create_directories(program_.path("big"));
  for (int frame = 0; frame < 2; ++frame) {
    dump.texels[dump.texels.size() - 4 * (frame + 1)] ^= std::byte{1};
    write_dump(program_.path(fmt::format("big/c.{}.exr", frame)), dump.info, dump.texels);
  }
  program_.succeed({"encode", "-o", "big.gic", "big"});
  program_.succeed({"verify", "big.gic", "big"});
  program_.succeed({"decode", "big.gic", "-o", "out"});
  for (const std::string& name : program_.files("big")) {
    EXPECT_EQ(file_bytes(program_.path("out/" + name)), file_bytes(program_.path("big/" + name)));
  }
}

}  // namespace
}  // namespace gicodec::tools

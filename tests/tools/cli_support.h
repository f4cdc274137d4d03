// Runs the built program.
#pragma once

#include "dump/file_system.h"
#include "tools/dump_support.h"

#include <csignal>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace gicodec::tools {

inline constexpr bool kWithImages = !kWindows;  ///< PNG, TIFF and DPX

using Arguments = std::vector<std::string>;
[[nodiscard]] inline Arguments operator+(Arguments left, const Arguments& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

struct Outcome {
  int exit = -1;  ///< exit code; 128 + signal if the program was killed
  std::string out;
  std::string err;
  long peak_kilobytes = 0;  ///< most memory it had at a time; for runs with kill_when
};

inline constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};
/// The circumstances of a run. On Windows the first two, and kill_when, which sends Ctrl-C.
struct Circumstances {
  std::string input = "/dev/null";      ///< standard input
  std::uint64_t file_bytes = kNoLimit;  ///< no file may grow beyond
  /// Addresses that the program may have; with sanitizers, which have terabytes of them, memory,
  /// and theirs besides.
  std::uint64_t memory = kNoLimit;
  std::string libraries = {};       ///< folder that is searched first for libraries and modules
  long failing_allocation = 0;      ///< number of one that fails; 0: none
  std::string allocations = {};     ///< a file that gets their number
  bool closed = false;              ///< standard output and error are
  std::string output = {};          ///< standard output, for Outcome::out if it is empty
  bool unread = false;              ///< standard output is a pipe that nobody reads
  const char* program = nullptr;    ///< another than gicodec
  bool one_stream = false;          ///< standard error goes where standard output goes
  bool terminal = false;            ///< standard output is one; Outcome::out is empty
  std::function<bool()> kill_when;  ///< `signal` as soon as this holds; asked again and again
  int signal = 9;                   // SIGKILL
};

/// Runs gicodec with these arguments in a directory of its own.
class Program {
 public:
  [[nodiscard]] Outcome run(const std::vector<std::string>& arguments,
                            const std::string& input_file = "/dev/null") const {
    return run_in({.input = input_file, .kill_when = {}}, arguments);
  }
  [[nodiscard]] Outcome run_in(const Circumstances& circumstances,
                               const std::vector<std::string>& arguments) const;
  /// The same and expects success. This and the next do nothing for what a build without images
  /// cannot do.
  Outcome succeed(const std::vector<std::string>& arguments) const;
  /// The same and expects an exit code, a message on standard error that has all the parts, and no
  /// file in the directory that was not there before.
  void expect_failure(Exit exit, const std::vector<std::string>& arguments,
                      const std::vector<std::string>& parts) const;

  [[nodiscard]] std::string path(const std::string& name) const { return directory_.path(name); }
  [[nodiscard]] std::vector<std::string> files(const std::string& folder = "") const {
    return directory_.files(folder);
  }

  /// Writes `frames` frames of colour and visibility, in which a few probes change per frame, to
  /// in/color.0000.exr and so on; returns their paths.
  std::vector<std::string> make_dumps(unsigned frames) const;

 private:
  TemporaryDirectory directory_;
};

/// Where the last packet's entry of a container with one index part ends.
[[nodiscard]] std::size_t end_of_packets(std::span<const std::byte> container);

inline const TextureDesc kColourDesc = ddgi_irradiance({4, 2, 3});
inline const TextureDesc kVisDesc = ddgi_visibility({4, 2, 3});

}  // namespace gicodec::tools

// A container compared with its dumps.
#pragma once

#include "common/backend_flags.h"
#include "common/cli.h"
#include "common/container_input.h"
#include "dump/sequence.h"
#include "finding.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::tools {

struct VerifyOptions {
  std::string input;
  std::vector<std::string> files;
  std::string volume;
  std::string format = "text";
  std::vector<std::string> max_error;
  DecoderFlags decoder;
};

/// Findings so far. Equal files are only counted, unless `keep_all`, so memory does not grow with
/// frames.
struct Report {
  bool keep_all = false;
  std::vector<Sequence> sequences;  ///< dumps to compare with
  std::vector<Finding> findings;
  std::size_t files = 0, same = 0, good = 0;
  std::string last_file;  ///< of the last finding, and how its file is so far
  bool last_same = false, last_good = false;
  std::vector<float> max_error;                     ///< by texture
  std::vector<std::vector<std::uint64_t>> largest;  ///< largest distance, by texture and channel
  std::vector<std::uint64_t> packets;               ///< by texture
  std::set<std::string> unseen;                     ///< files not yet compared

  /// Findings about images of one file follow one another.
  void add(Finding finding) {
    if (finding.file.empty() || finding.file != last_file) {
      ++files, ++same, ++good;
      last_file = finding.file;
      last_same = last_good = true;
    }
    if (!finding.same() && std::exchange(last_same, false)) --same;
    if (!finding.good() && std::exchange(last_good, false)) --good;
    if (!finding.file.empty()) unseen.erase(finding.file);
    if (keep_all || !finding.good()) findings.push_back(std::move(finding));
  }
  /// Notes the largest distances of textures with an error bound.
  void note_distances(std::size_t texture, const Finding& finding) {
    if (!finding.difference || max_error[texture] == 0) return;
    largest[texture].resize(finding.difference->channels.size());
    for (std::size_t i = 0; i < largest[texture].size(); ++i) {
      std::uint64_t& most = largest[texture][i];
      most = std::max(most, finding.difference->channels[i].max_distance);
    }
  }
};

/// What comparing found.
struct Verified {
  std::unique_ptr<ContainerInput> input;
  Report report = {};
  std::size_t frames = 0;
  std::string damage = {};  ///< the error that ended it
  std::string cure = {};    ///< of the damage, in words

  [[nodiscard]] bool compared() const { return !report.sequences.empty(); }
  /// True if every file is as it should be, or within the bound.
  [[nodiscard]] bool good() const {
    return compared() && report.good == report.files && report.files > 0;
  }
};
/// Decodes every frame and compares it with the dumps, if any are named. Throws Error, at damage
/// too unless the format is json.
[[nodiscard]] Verified verify_dumps(const VerifyOptions& options, const Cli& cli);

}  // namespace gicodec::tools

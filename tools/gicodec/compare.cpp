// gicodec compare: compares two dumps, or two directories of dumps.
#include "common/cli.h"
#include "common/volume_words.h"
#include "difference.h"
#include "dump/dump.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/sequence.h"
#include "dump/text.h"
#include "geometry_flags.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <utility>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

/// Replaces the frame's number of files that are paired by name.
constexpr std::uint64_t kOneName = UINT64_MAX;

constexpr const char* kCompareFooter =
    "Counts probes, texels and channels that differ, and says by how much and where first. "
    "Distances\n"
    "are codes for integer channels and steps between neighbouring values (ULP) for "
    "floating-point\n"
    "ones. Attributes and channel types count as well between images of one kind, unless\n"
    "--texels-only is given; compression does not. Two directories are compared file by file.\n"
    "\n"
    "Examples:\n"
    "  gicodec compare dumps/color.0003.exr out/color.0003.exr\n"
    "  gicodec compare dumps/ out/ --format json\n";

struct CompareOptions {
  std::string left, right;
  std::string format = "text";
  bool texels_only = false;
  GeometryFlags geometry;
};

struct Pair {
  std::string left, right;
  std::string texture;
};

struct Compared {
  Pair pair;
  std::string image;  ///< empty: the main one, or all there is
  TextureDesc desc;
  Difference difference;
  std::vector<std::string> headers;
  [[nodiscard]] bool same() const { return difference.same() && headers.empty(); }
};

NumberOptions with_gaps(NumberOptions numbers) {
  numbers.allow_gaps = true;
  return numbers;
}

/// The file, or one of its name whose kind is only read, so that decode gives EXR for it.
std::string source_of(const fs::path& file) {
  for (const char* ending : {".exr", ".png", ".tif", ".tiff", ".dpx"}) {
    const fs::path other = fs::path(file).replace_extension(ending);
    if (fs::exists(other)) return path_text(other);
  }
  return path_text(file);
}

/// Pairs files of the same name, and else of the same texture and frame, because folders may hold
/// files of different kinds.
std::vector<Pair> pairs_of_folders(const std::string& left, const std::vector<Sequence>& lefts,
                                   const std::string& right, const std::vector<Sequence>& rights) {
  using Key = std::pair<std::string, std::uint64_t>;
  std::map<Key, Pair> pairs;
  std::set<std::string> both;
  const auto name_of = [](const std::string& path) {
    return path_text(native_path(path).filename());
  };
  for (const auto& [own, other] : {std::pair(left, right), std::pair(right, left)}) {
    for (const Sequence& sequence : own == left ? lefts : rights) {
      for (const FrameFile& file : sequence.frames) {
        const std::string name = name_of(file.path),
                          there = path_text(native_path(other) / native_path(name));
        const bool same = fs::exists(native_path(there));
        if (same && !both.insert(name).second) continue;
        Pair& pair = pairs[{same ? name : sequence.name, same ? kOneName : file.frame}];
        (own == left ? pair.left : pair.right) = file.path;
        pair.texture = sequence.name;
        if (same) pair.right = there;
      }
    }
  }
  std::vector<Pair> all;
  for (auto& [key, pair] : pairs) {
    if (pair.left.empty())
      pair.left = source_of(native_path(left) / native_path(name_of(pair.right)));
    if (pair.right.empty())
      pair.right = source_of(native_path(right) / native_path(name_of(pair.left)));
    all.push_back(pair);
  }
  std::ranges::sort(all, {}, &Pair::left);
  return all;
}

/// True if both sides are folders; throws unless both or neither are.
bool are_folders(const CompareOptions& options) {
  for (const std::string& path : {options.left, options.right}) {
    require_exists(path);
    if (!fs::is_directory(native_path(path))) (void)require_image_kind(path);
  }
  const bool left_directory = fs::is_directory(native_path(options.left));
  if (left_directory != fs::is_directory(native_path(options.right))) {
    fail(Exit::usage, "compare needs two files or two directories");
  }
  return left_directory;
}

Compared compare_images(const Pair& pair, const Dump& left, const Dump& right, bool headers) {
  if (left.info.desc != right.info.desc) {
    fail(Exit::bad_input, "{} and {} cannot be compared: {} against {}", pair.left, pair.right,
         shape_text(left.info.desc), shape_text(right.info.desc));
  }
  return {pair, left.info.image, left.info.desc,
          compare_texels(left.info.desc, left.texels, right.texels),
          headers ? compare_headers(left.info, right.info) : std::vector<std::string>{}};
}

/// One for each image of the files. Adds to `left_out` what dumps do not keep of them.
std::vector<Compared> compare_pair(const Pair& pair, const CompareOptions& options,
                                   std::vector<std::string>& left_out) {
  Hints hints =
      settle_formats(std::vector{pair.left, pair.right}, hints_for(options.geometry, pair.texture));
  std::vector<Dump> left = read_dumps(pair.left, hints), right = read_dumps(pair.right, hints);
  for (const auto& [own, other] : {std::pair(&left, &right), std::pair(&right, &left)}) {
    const DumpInfo &guessed = own->front().info, &known = other->front().info;
    if (!guessed.guessed || known.guessed || guessed.desc.record == known.desc.record) continue;
    // The other file says what the values are.
    hints.format = known.desc.record.format;
    *own = read_dumps(own == &left ? pair.left : pair.right, hints);
    break;
  }
  const auto same_image = [](const Dump& a, const Dump& b) { return a.info.image == b.info.image; };
  if (!std::ranges::equal(left, right, same_image)) {
    const auto names = [](const std::vector<Dump>& images) {
      return listed(images, [](const Dump& image) { return image_words(image.info); });
    };
    fail(Exit::bad_input, "{} and {} cannot be compared: they hold {} against {}", pair.left,
         pair.right, names(left), names(right));
  }
  // Files of different kinds have different attributes even for the same texels.
  const bool one_kind = image_kind(pair.left) == image_kind(pair.right);
  const bool headers = !options.texels_only && one_kind;
  if (!options.texels_only && !one_kind) {
    left_out.push_back(fmt::format(
        "{} and {} are files of two kinds: their attributes and channels are not compared",
        pair.left, pair.right));
  }
  for (const auto& [path, images] :
       {std::pair(&pair.left, &left), std::pair(&pair.right, &right)}) {
    for (const Dump& image : *images) {
      if (image.info.lost.empty()) continue;
      left_out.push_back(
          fmt::format("{}: {} not compared", *path, fmt::join(image.info.lost, ", ")));
    }
  }
  std::vector<Compared> all;
  for (std::size_t i = 0; i < left.size(); ++i) {
    all.push_back(compare_images(pair, left[i], right[i], headers));
  }
  return all;
}

void print_text(const Compared& compared) {
  const auto& [pair, image, desc, difference, headers] = compared;
  const std::string of = image.empty() ? "" : fmt::format("{} of ", image);
  const Record& record = desc.record;
  const char* const word = block_word(desc);
  if (compared.same()) {
    print("{}{} and {} are identical: {} {}s, {} texels\n", of, pair.left, pair.right,
          difference.total_probes, word, difference.total_texels);
    return;
  }
  print("{}{} and {} differ\n", of, pair.left, pair.right);
  for (const std::string& line : headers) print("  {}\n", line);
  print("  {} of {} {}s, {} of {} texels\n", difference.probes, difference.total_probes, word,
        difference.texels, difference.total_texels);
  if (difference.same()) return;
  for (std::size_t i = 0; i < difference.channels.size(); ++i) {
    const ChannelDifference& channel = difference.channels[i];
    const bool floating = record.components[i].type == ComponentType::sfloat;
    print("  channel {}: {} texels, at most {} {}\n", channel.name, channel.texels,
          channel.max_distance, floating ? "ULP" : "codes");
  }
  print("  first: {}\n", to_string(*difference.first, record));
  if (difference.psnr) print("  PSNR {:.2f} dB\n", *difference.psnr);
}

Exit compare(const CompareOptions& options, const Cli& cli) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool same = true;
  const bool folders = are_folders(options);
  SequenceRemarks remarks;
  const NumberOptions numbers = with_gaps(options.geometry.numbers);
  const auto left = group_sequences({options.left}, numbers, &remarks);
  const auto right = group_sequences({options.right}, numbers, &remarks);
  for (const std::string& line : remarks.left_out) remark(line);
  const auto pairs = folders ? pairs_of_folders(options.left, left, options.right, right)
                             : std::vector<Pair>{{options.left, options.right, left.front().name}};
  std::vector<Sequence> all = left;
  all.insert(all.end(), right.begin(), right.end());
  check_names(options.geometry, all);
  Progress progress("comparing", pairs.size(), cli);
  for (const Pair& pair : pairs) {
    progress.step();
    const bool both = fs::exists(native_path(pair.left)) && fs::exists(native_path(pair.right));
    if (pairs.size() > 1 && !both) {
      const std::string& missing = fs::exists(native_path(pair.left)) ? pair.right : pair.left;
      same = false;
      if (options.format == "text") print("{} does not exist\n", missing);
      json.push_back({{"left", pair.left}, {"right", pair.right}, {"missing", missing}});
      continue;
    }
    std::vector<std::string> left_out;
    for (const Compared& compared : compare_pair(pair, options, left_out)) {
      same &= compared.same();
      if (options.format == "text") {
        print_text(compared);
        continue;
      }
      nlohmann::ordered_json item = {{"left", pair.left}, {"right", pair.right}};
      if (!compared.image.empty()) item["image"] = compared.image;
      item.update(to_json(compared.difference, compared.desc.record));
      item["identical"] = compared.same();
      if (!compared.headers.empty()) item["headers"] = compared.headers;
      if (!left_out.empty()) item["not_compared"] = left_out;
      json.push_back(item);
    }
    if (options.format == "text") {
      for (const std::string& line : left_out) print("{}\n", line);
    }
  }
  if (options.format == "json") {
    print_json(json.size() == 1 ? json.front() : json);
  }
  return same ? Exit::ok : Exit::different;
}

}  // namespace

void add_compare(Cli& cli) {
  auto options = std::make_shared<CompareOptions>();
  Command* command = cli.app.add_command("compare", "Says how two dumps differ");
  command->footer(kCompareFooter);
  command->add_option("left", options->left, "A dump or a directory")->required()->type_name("A");
  command->add_option("right", options->right, "Another one")->required()->type_name("B");
  command->add_flag("--texels-only", options->texels_only, "Ignore attributes and channel types");
  add_output_format(*command, options->format);
  add_geometry_flags(*command, options->geometry);
  add_number_flags(*command, options->geometry.numbers);
  command->callback(
      [&cli, options] { cli.run = [&cli, options] { return compare(*options, cli); }; });
}

}  // namespace gicodec::tools

#include "train/table_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gicodec::train {
namespace {

constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

template <typename Values>
std::string list(const Values& values) {
  std::string text;
  unsigned column = 0;
  for (const unsigned v : values) {
    const std::string item = fmt::format("{},", v);
    if (column + item.size() > 92) {
      text += "\n     ";
      column = 0;
    }
    text += item;
    column += static_cast<unsigned>(item.size());
  }
  text.pop_back();
  return text;
}

}  // namespace

std::string to_source(const Model& model) {
  std::string text =
      "// Made by tools/train/train_native; not to be edited by hand.\n// clang-format off\n"
      "#include \"native/tables.h\"\n\nnamespace gicodec::native {\n\n"
      "const TableData kTableData = {\n    // Frequencies of the tokens.\n    {\n";
  for (const auto& d : model.family) text += fmt::format("     {{{}}},\n", list(quantise(d)));
  text +=
      "    },\n    // Member of the family by context: 5 sign classes of 24 magnitudes.\n    {\n";
  for (const auto& map : model.map) {
    text += "     {\n";
    for (unsigned row = 0; row < native::kRows; ++row) {
      for (unsigned c = 0; c < native::kSignClasses; c += 3) {
        std::string digits;
        for (unsigned i = c * native::kMagnitudes;
             i < std::min(native::kSignClasses, c + 3) * native::kMagnitudes; ++i) {
          digits += kDigits[map[row * native::kRowSize + i]];
        }
        text += fmt::format("      \"{}\"{}\n", digits, c > 0 ? "," : "");
      }
    }
    text += "     },\n";
  }
  text += "    },\n    // Ends of hit symbols 0 and 1.\n    {\n";
  for (const auto& set : model.hits) {
    text += "     {\n";
    for (const auto& kind : set) {
      std::vector<unsigned> ends[2];
      for (const auto& p : kind) {
        const auto first = static_cast<unsigned>(std::lround(p[0] * native::kProbabilityScale));
        const auto second = static_cast<unsigned>(std::lround(p[1] * native::kProbabilityScale));
        ends[0].push_back(std::clamp(first, 1U, native::kProbabilityScale - 2));
        ends[1].push_back(
            std::clamp(ends[0].back() + std::max(1U, second), 2U, native::kProbabilityScale - 1));
      }
      text += fmt::format("      {{{{{}}},\n      {{{}}}}},\n", list(ends[0]), list(ends[1]));
    }
    text += "     },\n";
  }
  return text + "    }};\n\n}  // namespace gicodec::native\n";
}

}  // namespace gicodec::train

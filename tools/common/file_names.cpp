#include "file_names.h"

#include "dump/sequence.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {
namespace {

/// File names: a number between two texts, or one name.
struct Names {
  std::string before;
  unsigned digits = 0;  ///< least digits of the number, padded with zeros; 0: no number
  std::string after;
};

bool all_digits(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// True if `text`, followed by a number of `digits` or more, can be a number of `wanted` digits or
/// more.
bool completes(std::string_view text, unsigned digits, unsigned wanted) {
  if (!all_digits(text)) return false;
  return text.empty() || text[0] != '0' || text.size() + digits <= wanted;
}

bool is_one_of(const std::string& name, const Names& names) {
  if (names.digits == 0) return name == names.before + names.after;
  const std::size_t around = names.before.size() + names.after.size();
  if (name.size() < around + names.digits || !name.starts_with(names.before) ||
      !name.ends_with(names.after))
    return false;
  const auto number = std::string_view(name).substr(names.before.size(), name.size() - around);
  return all_digits(number) && (number.size() == names.digits || number[0] != '0');
}

bool meet(const Names& a, const Names& b) {
  if (a.digits == 0) return is_one_of(a.before + a.after, b);
  if (b.digits == 0) return is_one_of(b.before + b.after, a);
  if (a.after != b.after) return false;
  if (a.before.size() > b.before.size()) return meet(b, a);
  if (!b.before.starts_with(a.before)) return false;
  return completes(std::string_view(b.before).substr(a.before.size()), b.digits, a.digits);
}

/// True if attribute raw:sidecar of any frame has the value `where`.
bool has_sidecar(const StoredTexture& texture, std::string_view where) {
  const auto says = [&](const Attribute* attribute) {
    return where == (attribute == nullptr ? std::string_view() : attribute->value);
  };
  return says(find_attribute(texture.info.attributes, kRawSidecar)) ||
         std::ranges::any_of(texture.changes, [&](const FrameAttribute& change) {
           return change.attribute.name == kRawSidecar && says(&change.attribute);
         });
}

std::vector<Names> names_of(const StoredTexture& texture) {
  const std::string before = texture.digits == 0 ? texture.name : texture.name + texture.separator;
  const std::string ending = texture.extension.empty() ? "" : "." + texture.extension;
  std::vector<Names> names{{before, texture.digits, ending}};
  if (image_kind("x" + ending) != ImageKind::raw) return names;
  if (has_sidecar(texture, "")) names.push_back({before, texture.digits, ".json"});
  if (has_sidecar(texture, "shared")) {
    names.push_back({texture_path(texture.file_name(0)), 0, ".json"});
  }
  return names;
}

}  // namespace

bool names_meet(const StoredTexture& a, const StoredTexture& b) {
  const auto others = names_of(b);
  return std::ranges::any_of(names_of(a), [&](const Names& own) {
    return std::ranges::any_of(others, [&](const Names& other) { return meet(own, other); });
  });
}

}  // namespace gicodec::tools

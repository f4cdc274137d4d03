#include "data_text.h"

#include "text.h"

#include <nlohmann/json.hpp>

namespace gicodec::tools {
namespace {

/// Makes strings UTF-8: names of files and channels may hold any bytes. Keys are the program's or a
/// container's, and so are UTF-8.
void make_utf8(nlohmann::ordered_json& json) {
  if (json.is_string()) {
    json = utf8_text(json.get_ref<const std::string&>());
  } else if (json.is_structured()) {
    for (auto& item : json) make_utf8(item);
  }
}

}  // namespace

std::string csv_field(std::string_view text) {
  std::string shown = printable(text);
  if (shown.find_first_of(",\"") == std::string::npos) return shown;
  std::string field = "\"";
  for (const char c : shown) field.append(c == '"' ? 2 : 1, c);
  return field + "\"";
}

void write_csv(std::FILE* stream, std::span<const std::string> fields) {
  std::string line;
  for (const std::string& field : fields) line += csv_field(field) + ",";
  if (!line.empty()) line.pop_back();
  write_text(stream, line + "\n");
}

void write_json(std::FILE* stream, nlohmann::ordered_json json, int indent) {
  make_utf8(json);
  write_text(stream, printable_json(json.dump(indent)) + "\n");
}

}  // namespace gicodec::tools

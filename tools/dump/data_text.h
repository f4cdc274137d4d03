// Text for programs that read it: CSV and JSON. Text for people is that of text.h.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdio>
#include <span>
#include <string>
#include <string_view>

namespace gicodec::tools {

/// printable() text as a field of CSV, in quotes where it needs them (RFC 4180).
[[nodiscard]] std::string csv_field(std::string_view text);

/// Writes a line of CSV, its fields by csv_field(); as write_text() otherwise.
void write_csv(std::FILE* stream, std::span<const std::string> fields);

/// Writes JSON, its strings by utf8_text() and printable_json(), and a new line; on one line if
/// `indent` is negative. As write_text() otherwise.
void write_json(std::FILE* stream, nlohmann::ordered_json json, int indent = -1);

}  // namespace gicodec::tools

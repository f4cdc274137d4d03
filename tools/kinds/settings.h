// Settings of a kind on the command line: --set NAME=VALUE.
#pragma once

#include "ddgi/gather.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::kinds {

struct Setting {
  std::string_view name;
  std::string_view usual;    ///< its default value
  std::string_view summary;  ///< with the range and the unit
};

/// The values of a kind's settings.
class Settings {
 public:
  Settings() = default;
  /// `given`: NAME=VALUE each; the last of a name counts. `flag`: the text before a name in
  /// messages. Throws tools::Error of Exit::usage for a name that the kind does not have.
  Settings(std::string_view kind, std::span<const Setting> known,
           std::span<const std::string> given, std::string flag = "--set ");

  // Precondition: the kind has a setting of that name. All but text() throw tools::Error of
  // Exit::usage, which says what is allowed.
  [[nodiscard]] const std::string& text(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name, double least, double most) const;
  [[nodiscard]] std::uint32_t whole(std::string_view name, std::uint32_t least,
                                    std::uint32_t most) const;
  /// The index of the value among `allowed`.
  [[nodiscard]] std::size_t choice(std::string_view name,
                                   std::span<const std::string_view> allowed) const;

 private:
  std::map<std::string, std::string, std::less<>> values_;
  std::string flag_;
};

// Settings of kinds that gather light along rays.
[[nodiscard]] constexpr Setting rays_turned(std::string_view usual) {
  return {"rays-turned", usual, "1: each point has them turned otherwise, 0: all have the same"};
}
inline constexpr Setting kRaysAnew{"rays-anew", "0", "1: other rays with every update"};
inline constexpr Setting kWarmup{"warmup", "3", "bounces before the first update, 0 to 100"};
/// The options of these settings, and "rays" in that range. Throws tools::Error of Exit::usage.
[[nodiscard]] ddgi::GatherOptions gather_options(const Settings& settings, std::uint32_t least,
                                                 std::uint32_t most, std::uint32_t seed);

/// "1,2.5,-3" with exactly `count` numbers up to a million, or none.
[[nodiscard]] std::vector<float> numbers_from_string(std::string_view text, std::size_t count);

/// A line for each setting, for --help.
[[nodiscard]] std::string help_of(std::span<const Setting> known);

}  // namespace gicodec::kinds

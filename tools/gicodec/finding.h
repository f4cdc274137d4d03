// The findings of verify, as text and JSON.
#pragma once

#include "common/stored_texture.h"
#include "difference.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

/// The finding about one file, or one image of it.
struct Finding {
  std::string texture;
  std::string of_file;  ///< StoredTexture::file
  std::uint64_t frame = 0;
  std::string file;                  ///< empty: there is none
  std::string missing;               ///< what is missing; empty: nothing
  std::vector<std::string> headers;  ///< differences besides texels
  std::optional<Difference> difference;
  TextureDesc desc;
  float max_error = 0;

  [[nodiscard]] bool same() const {
    return missing.empty() && headers.empty() && difference && difference->same();
  }
  /// True if all differences are within the bound.
  [[nodiscard]] bool good() const {
    return missing.empty() && headers.empty() && difference && difference->beyond == 0;
  }
};

/// Prints to standard output. `texture`: the container's, or null.
void print_text(const Finding& finding, const StoredTexture* texture);
[[nodiscard]] nlohmann::ordered_json finding_json(const Finding& finding);

}  // namespace gicodec::tools

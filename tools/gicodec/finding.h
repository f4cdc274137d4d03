// What verify found about one file, in words and as JSON.
#pragma once

#include "common/stored_texture.h"
#include "difference.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::tools {

/// What was found about one file.
struct Finding {
  std::string texture;
  std::uint64_t frame = 0;
  std::string file;                  ///< empty if there is none
  std::string missing;               ///< what is missing, if something is
  std::vector<std::string> headers;  ///< differences besides texels
  std::optional<Difference> difference;
  TextureDesc desc;
  float max_error = 0;

  [[nodiscard]] bool same() const {
    return missing.empty() && headers.empty() && difference && difference->same();
  }
  /// Off by no more than allowed.
  [[nodiscard]] bool good() const {
    return missing.empty() && headers.empty() && difference && difference->beyond == 0;
  }
};

/// On standard output; `texture`: in the container, if it is there.
void print_text(const Finding& finding, const StoredTexture* texture);
[[nodiscard]] nlohmann::ordered_json finding_json(const Finding& finding);

}  // namespace gicodec::tools

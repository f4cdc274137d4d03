#include "finding.h"

#include "dump/text.h"

#include <nlohmann/json.hpp>

namespace gicodec::tools {

void print_text(const Finding& finding, const StoredTexture* texture) {
  const std::string where =
      finding.file.empty() ? fmt::format("frame {}, texture {}", finding.frame, finding.texture)
                           : fmt::format("{}: frame {}", finding.file, finding.frame);
  if (!finding.missing.empty()) print("{}: {}\n", where, finding.missing);
  for (const std::string& line : finding.headers) print("{}: {}\n", where, line);
  if (!finding.difference || finding.difference->beyond == 0) return;
  const Difference& difference = *finding.difference;
  print("{}: {} of {} {}s and {} texels differ", where, difference.probes, difference.total_probes,
        block_word(finding.desc), difference.texels);
  if (finding.max_error > 0) print(", {} by more than {}", difference.beyond, finding.max_error);
  print(", first {} in the container", to_string(*difference.first, finding.desc.record));
  if (difference.psnr) print("; PSNR {:.2f} dB", *difference.psnr);
  if (texture != nullptr && !texture->lossy.empty()) {
    print("; coded LOSSY ({})", texture->lossy);
  }
  print("\n");
}

nlohmann::ordered_json finding_json(const Finding& finding) {
  nlohmann::ordered_json json = {{"texture", finding.texture},
                                 {"frame", finding.frame},
                                 {"file", finding.file},
                                 {"identical", finding.same()}};
  if (!finding.missing.empty()) json["missing"] = finding.missing;
  if (!finding.headers.empty()) json["headers"] = finding.headers;
  if (finding.difference) json["texels"] = to_json(*finding.difference, finding.desc.record);
  return json;
}

}  // namespace gicodec::tools

// The chunks of an EXR file: whether they hold as many samples as the header says.
#pragma once

#include "dump/exr_header.h"
#include "dump/exr_images.h"

#include <string>
#include <vector>

namespace gicodec::tools {

/// Throws Error if a chunk of a part that `images` are of has fewer samples than its place in the
/// image: OpenEXR would give what its memory held before. Damage that OpenEXR notices is left to
/// it.
void check_exr_chunks(const std::string& path, const std::vector<ExrPart>& parts,
                      const std::vector<ExrImage>& images);

}  // namespace gicodec::tools

// The files of folders that are read.
#pragma once

#include "dump/sequence.h"

#include <string>
#include <vector>

namespace gicodec::tools {

/// Each path once, and in place of a folder its .exr, .dds, .ktx2, .raw and .bin files, ascending;
/// without sidecars of raw files. Of files that are only read those of a `known` name count too.
/// `remarks`, if not null: what of a folder is left out, a line each. Throws for a folder of more
/// than 10,000 of them, or of none.
[[nodiscard]] std::vector<std::string> expand_directories(const std::vector<std::string>& paths,
                                                          const std::vector<Sequence>& known,
                                                          std::vector<std::string>* remarks);

}  // namespace gicodec::tools

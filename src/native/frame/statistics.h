// Where the bits of decoded chunks went.
#pragma once

#include "native/frame/workspace.h"

namespace gicodec::native {

/// Adds the modes, repeats and residuals of a decoded group: `group` as decoding left it.
/// Overwrites the workspace's steps.
void count_group(const Update& u, const Group& group, const Tables& tables, Workspace& w,
                 PayloadStatistics& statistics);

}  // namespace gicodec::native

// An update's message in two pieces: a connection's own, and one that connections may share.
#pragma once

#include <gicodec/protocol.h>

namespace gicodec {

/// Appends the type, and the epoch and number of `update`.
Status write_update_head(const UpdateMessage& update, Message& out);
/// Appends all that follows. invalid_argument if a reader would refuse it.
Status write_update_rest(const UpdateMessage& update, Message& out);

}  // namespace gicodec

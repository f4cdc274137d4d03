// An update's message in two pieces: what is of one client, and what others may share.
#pragma once

#include <gicodec/protocol.h>

namespace gicodec {

/// Appends the type and `update`'s sync point and number.
Status write_update_head(const UpdateMessage& update, Message& out);
/// Appends all that follows. invalid_argument for what could not be read again.
Status write_update_rest(const UpdateMessage& update, Message& out);

}  // namespace gicodec

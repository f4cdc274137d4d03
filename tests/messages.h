// Messages of a host in one piece, as they arrive.
#pragma once

#include <gicodec/protocol.h>

#include <vector>

namespace gicodec {

inline std::vector<Message> joined(const std::vector<OutgoingMessage>& messages) {
  std::vector<Message> all;
  for (const OutgoingMessage& message : messages) all.push_back(*message.joined());
  return all;
}

}  // namespace gicodec

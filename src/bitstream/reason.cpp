// What reasons for the end of a connection say to people.
#include <gicodec/protocol.h>

namespace gicodec {

std::string_view to_string(Reason reason) noexcept {
  switch (reason) {
    case Reason::left:
      return "it left";
    case Reason::version:
      return "it speaks another protocol version";
    case Reason::token:
      return "the token is wrong";
    case Reason::full:
      return "no more clients are taken";
    case Reason::malformed:
      return "it sent a malformed message";
    case Reason::too_large:
      return "it sent a message that is too large";
    case Reason::flood:
      return "it sent too many messages";
    case Reason::out_of_order:
      return "it sent a message out of order";
    case Reason::unknown_volume:
      return "it asked for a volume that does not exist";
    case Reason::silent:
      return "it said no hello in time, or others needed its place";
    case Reason::stalled:
      return "it does not take its updates";
    case Reason::shutdown:
      return "the server ends";
    case Reason::replaced:
      return "its session goes on over another connection";
    case Reason::dismissed:
      return "the server's operator ended it";
    case Reason::exhausted:
      return "the server has no memory for it";
    case Reason::unicast_full:
      return "no more unicast clients are taken";
  }
  return "unknown reason";
}

}  // namespace gicodec

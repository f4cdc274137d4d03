// Payloads made by hand, for tests of what decoders refuse: valid ones, and the same with one
// fault.
#pragma once

#include "native/content.h"
#include "native/frame/chunk_head.h"

#include <initializer_list>

namespace gicodec::test {

[[nodiscard]] Bytes bytes(std::initializer_list<int> values);
[[nodiscard]] int at(const Bytes& payload, std::size_t place);
[[nodiscard]] Bytes with(Bytes payload, std::size_t place, int value);
[[nodiscard]] Bytes longer(Bytes payload, std::size_t by);

/// The library and the reference decoder read the update's records from it.
void expect_sound(const UpdateCase& u, const Bytes& payload);
/// Both refuse it, the library with that status.
void expect_refused(const UpdateCase& u, const Bytes& payload, Status status = Status::corrupt);
/// So does check_payload().
void expect_refused_at_once(const UpdateCase& u, const Bytes& payload,
                            Status status = Status::corrupt);

inline constexpr std::size_t kChunk = 1;  ///< where the only chunk of a payload begins
/// Steps of each group of a chunk, in coding order.
using Groups = std::vector<std::vector<native::Step>>;
/// A payload of one chunk with that head, whether decoders accept it or not.
[[nodiscard]] Bytes payload_of(const UpdateCase& u, const native::ChunkHead& head,
                               const Groups& groups);

/// What an encoder made of an update of one chunk; without tables of the encoder's choice.
struct Encoded {
  native::ChunkHead head;
  Groups groups;
};
[[nodiscard]] Encoded encoded(const UpdateCase& u);

/// Four planes, the last of which is constant.
[[nodiscard]] UpdateCase colour(bool keyframe);
[[nodiscard]] UpdateCase visibility(bool keyframe);

}  // namespace gicodec::test

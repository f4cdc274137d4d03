// What volumes of every kind have to bear, as bodies that tests and fuzzers share: each answers
// with what went wrong, or nothing.
#pragma once

#include <gicodec/streaming.h>

#include "payload_rows.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace gicodec::test {

using Generator = std::mt19937_64;
using Contents = std::vector<std::vector<std::byte>>;  ///< of all textures of a volume, in memory

/// Changes some of the contents: a few bytes of some blocks, and what exists of them.
void change(const VolumeDesc& volume, Contents& contents, Generator& random);
[[nodiscard]] Contents blank(const VolumeDesc& volume);
/// Which records of a texture's blocks exist by these contents; empty where all do.
[[nodiscard]] std::span<const std::byte> presence_of(const VolumeDesc& volume,
                                                     const Contents& contents, std::size_t texture);

/// What a client shows against what was published: the same, and all of it received.
[[nodiscard]] std::string compare(const VolumeDesc& volume, const Contents& contents,
                                  const ClientVolume& shown);

/// A description and back; cut at every prefix; every bit flipped.
[[nodiscard]] std::string check_description(const Row& row);
/// Packets of one texture by a backend: exact round trips of some updates, of which every prefix
/// and a flip in every byte is refused. "unsupported" if the backend, built in or not, does not
/// take it.
[[nodiscard]] std::string check_codec(const VolumeDesc& volume, std::size_t texture,
                                      const Backend& backend, Generator& random);
/// Updates of all textures by a VolumeEncoder, which a VolumeDecoder takes exactly; blocks of sets
/// that travel together are the same in all their textures. "unsupported" as above.
[[nodiscard]] std::string check_volume(const VolumeDesc& volume, const Backend& backend,
                                       Generator& random);
/// A container with regions: all packets and those of one region.
[[nodiscard]] std::string check_container(const Row& row, Generator& random);
/// A session over a way that loses every so manieth message; ends with equal contents.
/// "unsupported" if the backend does not take all of the volume's textures.
[[nodiscard]] std::string check_session(const Row& row, const Backend& backend, Delivery delivery,
                                        unsigned lost_one_in, Generator& random);

}  // namespace gicodec::test

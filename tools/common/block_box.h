// A box of blocks of a grid, as flags take it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace gicodec::tools {

/// Places of its first and last block along x, y and z.
struct BlockBox {
  std::array<std::uint32_t, 3> first{}, last{};
};
/// Of "0-7,0-3,4-11". Throws Error of Exit::usage that names the flag, and `other` that it takes.
[[nodiscard]] BlockBox box_from_flag(const char* flag, const std::string& text,
                                     const char* other = "");

}  // namespace gicodec::tools

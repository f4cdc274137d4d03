// H.264 by x264 through FFmpeg, as Crassin et al. §4.2 send their maps: a peer of lossy maps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gicodec::bench {

class H264Peer {
 public:
  /// Pictures of 4:4:4 in 10 bits; the first is a keyframe. Throws std::runtime_error, also where
  /// FFmpeg has no x264.
  H264Peer(std::uint32_t width, std::uint32_t height, int qp);
  H264Peer(H264Peer&&) noexcept;
  ~H264Peer();

  /// Codes texels of A2B10G10R10, row by row, as luma and chroma (HevcPacking::luma), and decodes
  /// them; their bytes.
  std::size_t add(std::span<const std::uint32_t> texels);
  [[nodiscard]] const std::vector<std::byte>& decoded() const { return decoded_; }

 private:
  struct Codec;
  std::unique_ptr<Codec> codec_;
  std::vector<std::byte> decoded_;  ///< texels
};

}  // namespace gicodec::bench

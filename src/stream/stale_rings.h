// Guard bands that are coded because they do not follow the rule.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// Rings of some probes, ascending, side by side.
class StaleRings {
 public:
  /// `probe` is above those before it, the ring as large as theirs.
  void add(std::uint32_t probe, std::span<const std::byte> ring) {
    probes_.push_back(probe);
    ring_bytes_ = ring.size();
    bytes_.insert(bytes_.end(), ring.begin(), ring.end());
  }
  /// Zeros for each of these probes.
  void assign(std::vector<std::uint32_t>&& probes, std::size_t ring_bytes) {
    bytes_.assign(probes.size() * ring_bytes, std::byte{0});
    probes_ = std::move(probes);
    ring_bytes_ = ring_bytes;
  }
  void clear() noexcept {
    probes_.clear();
    bytes_.clear();
  }

  [[nodiscard]] bool empty() const noexcept { return probes_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return probes_.size(); }
  [[nodiscard]] std::span<const std::uint32_t> probes() const noexcept { return probes_; }
  [[nodiscard]] std::span<std::byte> bytes() noexcept { return bytes_; }
  [[nodiscard]] std::span<std::byte> ring(std::size_t i) noexcept {
    return std::span(bytes_).subspan(i * ring_bytes_, ring_bytes_);
  }
  [[nodiscard]] std::span<const std::byte> ring(std::size_t i) const noexcept {
    return std::span(bytes_).subspan(i * ring_bytes_, ring_bytes_);
  }
  friend bool operator==(const StaleRings&, const StaleRings&) = default;

 private:
  std::vector<std::uint32_t> probes_;
  std::vector<std::byte> bytes_;
  std::size_t ring_bytes_ = 0;
};

}  // namespace gicodec

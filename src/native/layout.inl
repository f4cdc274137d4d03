// Layout changes between blocks and lanes.

void to_lanes(const std::uint16_t* const* blocks, std::size_t count, std::uint16_t* lanes) {
  for (std::size_t t = 0; t < count; t += 8) {
    for (unsigned l = 0; l < kLanes; l += 8) {
      const std::uint16_t* in[8];
      std::uint16_t* out[8];
      for (unsigned k = 0; k < 8; ++k) {
        in[k] = blocks[l + k] + t;
        out[k] = lanes + (t + k) * kLanes + l;
      }
      transpose8(in, out);
    }
  }
}
void from_lanes(const std::uint16_t* lanes, std::size_t count, std::uint16_t* const* blocks) {
  for (std::size_t t = 0; t < count; t += 8) {
    for (unsigned l = 0; l < kLanes; l += 8) {
      const std::uint16_t* in[8];
      std::uint16_t* out[8];
      for (unsigned k = 0; k < 8; ++k) {
        in[k] = lanes + (t + k) * kLanes + l;
        out[k] = blocks[l + k] + t;
      }
      transpose8(in, out);
    }
  }
}

// Layout changes between blocks and lanes.

void to_lanes(const std::uint16_t* const* blocks, std::size_t count, std::uint16_t* lanes) {
  for (std::size_t t = 0; t < count; t += 8) tile_to_lanes(blocks, t, lanes + t * kLanes);
}
void from_lanes(const std::uint16_t* lanes, std::size_t count, std::uint16_t* const* blocks) {
  for (std::size_t t = 0; t < count; t += 8) tile_from_lanes(lanes + t * kLanes, t, blocks);
}

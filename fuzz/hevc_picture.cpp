// Blocks ↔ raster ↔ picture, and the head and alpha section of HEVC payloads: a description, a byte
// for packing and layout, blocks, then texels, repeated. Texels come back exactly; any samples give
// texels in range.
#include "backend/hevc/payload.h"
#include "backend/hevc/picture.h"
#include "input.h"
#include "transform/yuv444p16.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  auto desc = input.any_desc();
  const auto choice = input.byte();
  const auto places = input.blocks(desc);
  const auto pattern = input.rest();
  const auto packing = (choice & 1) != 0 ? HevcPacking::planes : HevcPacking::paper;
  const auto layout = (choice & 2) != 0 ? HevcLayout::packed : HevcLayout::atlas;
  const std::uint8_t size_class =
      layout == HevcLayout::packed ? hevc::size_class_of(desc, places.size()) : std::uint8_t{0};
  const auto shape = hevc::frame_shape(desc, packing, layout, size_class);
  if (!shape || shape->picture.plane_bytes() > 1U << 20) return 0;
  const bool colour = is_a2rgb10(desc.record.format);

  fuzz::Exact blocks(places.size() * block_bytes(desc));
  for (std::size_t i = 0; i < blocks.span().size() && !pattern.empty(); ++i) {
    blocks.span()[i] = pattern[i % pattern.size()];
  }
  fuzz::Exact raster(raster_bytes(desc, *shape)), raster_back(raster.span().size(), 1);
  hevc::blocks_to_raster(desc, *shape, places, blocks.span(), raster.span());
  hevc::Picture picture;
  hevc::raster_to_picture(best_isa(), desc, *shape, raster.span(), picture);
  hevc::picture_to_raster(best_isa(), desc, *shape, picture, raster_back.span());
  fuzz::Exact back(blocks.span().size(), 1);
  hevc::raster_to_blocks(desc, *shape, places, raster_back.span(), back.span());

  hevc::PayloadHead head{.packing = packing,
                         .layout = layout,
                         .lossy = (choice & 4) != 0,
                         .bit_depth = shape->picture.bit_depth,
                         .size_class = size_class,
                         .hash = choice * 0x01010101U};
  std::vector<std::byte> section, written;
  if (colour) {
    auto alpha = hevc::write_alpha(blocks.span(), head);
    fuzz::check(alpha.ok(), "alpha can be written");
    section = *std::move(alpha);
  }
  hevc::write_payload(head, section, pattern, written);
  fuzz::Exact exact(written);
  const auto payload = hevc::read_payload(exact.span());
  fuzz::check(payload.ok(), "what was written can be read");
  const auto& read = payload->head;
  fuzz::check(read.packing == head.packing && read.layout == head.layout &&
                  read.lossy == head.lossy && read.bit_depth == head.bit_depth &&
                  read.size_class == head.size_class && read.alpha == head.alpha &&
                  read.hash == head.hash && fuzz::same(payload->alpha_section, section) &&
                  fuzz::same(payload->access_unit, pattern),
              "the same head and sections");
  if (colour) {
    fuzz::check(hevc::read_alpha(*payload, back.span()) == Status::ok, "alpha can be read");
  }
  fuzz::check(fuzz::same(back.span(), blocks.span()), "texels come back");

  // Hostile bytes as payload, and any samples.
  if (const auto any = hevc::read_payload(pattern); any.ok() && colour) {
    fuzz::Exact texels(4 * (pattern.size() % 67));
    std::ranges::fill(texels.span(), std::byte{0});
    static_cast<void>(hevc::read_alpha(*any, texels.span()));
  }
  if (!pattern.empty()) {
    const std::byte mask = shape->picture.bit_depth == 8    ? std::byte{0xFF}
                           : shape->picture.bit_depth == 10 ? std::byte{0x03}
                                                            : std::byte{0x0F};
    for (std::size_t i = 0; i < picture.samples.size(); ++i) {
      picture.samples[i] = pattern[i % pattern.size()] & (i % 2 == 0 ? std::byte{0xFF} : mask);
    }
    hevc::picture_to_raster(best_isa(), desc, *shape, picture, raster_back.span());
    for (std::size_t i = 3; i < raster_back.span().size() && colour; i += 4) {
      fuzz::check((raster_back.span()[i] & std::byte{0xC0}) == std::byte{0},
                  "any samples leave alpha zero");
    }
  }
  return 0;
}

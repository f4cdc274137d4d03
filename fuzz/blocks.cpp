// strip and reconstruct, on every instruction set, and the bands of stale guard bands: a
// description, gaps between rows and slices, blocks, then records, repeated. Every listed block of
// a texture comes back, and nothing else is written.
#include "texture/blocks.h"

#include "input.h"
#include "texture/block_kernels.h"
#include "texture/guard_band.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto desc = input.any_desc();
  const auto measure = extent(desc);
  const std::size_t pieces = desc.layout.tiling == Tiling::blocks ? block_count(desc) : 1;
  const std::size_t slices = measure.slices / pieces;
  const std::size_t row = measure.width * desc.record.bytes;
  const std::size_t row_pitch = row + input.below(9);
  const std::size_t slice_pitch = measure.height * row_pitch + input.below(9);
  const std::size_t block_pitch = slices * slice_pitch;
  const std::size_t whole = (pieces - 1) * block_pitch + (slices - 1) * slice_pitch +
                            (measure.height - 1) * row_pitch + row;
  const auto blocks = input.blocks(desc);
  const auto pattern = input.rest();
  fuzz::Exact from(whole), to(whole, 1), untouched(whole, 1);
  // Guard bands by the rule, then what the input says in places.
  fuzz::Exact records(block_count(desc) * block_bytes(desc));
  for (std::size_t i = 0; i < records.span().size() && !pattern.empty(); ++i) {
    records.span()[i] = pattern[i % pattern.size()];
  }
  std::vector<std::uint32_t> all(block_count(desc));
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const auto writable =
      check_view(desc, TextureView{from.span(), row_pitch, slice_pitch, block_pitch});
  const auto target = check_view(desc, TextureView{to.span(), row_pitch, slice_pitch, block_pitch});
  const auto view =
      check_view(desc, ConstTextureView(from.span(), row_pitch, slice_pitch, block_pitch));
  fuzz::check(writable.ok() && target.ok() && view.ok(), "views of the right size");
  reconstruct(best_isa(), desc, *writable, all, records.span());
  for (std::size_t i = 0; i + 2 < std::min<std::size_t>(pattern.size(), 48); i += 3) {
    const auto at = std::to_integer<std::size_t>(pattern[i]) |
                    std::to_integer<std::size_t>(pattern[i + 1]) << 8;
    from.span()[at % whole] ^= pattern[i + 2];
  }

  fuzz::Exact stripped(blocks.size() * block_bytes(desc));
  Vector<std::uint32_t> stale;
  strip(best_isa(), desc, *view, blocks, stripped.span(), stale);
  reconstruct(best_isa(), desc, *target, blocks, stripped.span());
  fuzz::Exact band(band_bytes(desc)), ruled(band.span().size()), other(band.span().size(), 1);
  std::size_t next = 0;
  for (std::uint32_t place = 0; place < blocks.size(); ++place) {
    gather_band(desc, *view, blocks[place], band.span());
    band_by_rule(desc, stripped.span().data() + place * block_bytes(desc), ruled.span());
    const bool marked = next < stale.size() && stale[next] == place;
    fuzz::check(marked != fuzz::same(band.span(), ruled.span()), "what breaks the rule is marked");
    if (!marked) continue;
    ++next;
    scatter_band(desc, *target, blocks[place], band.span());
    const auto back =
        check_view(desc, ConstTextureView(to.span(), row_pitch, slice_pitch, block_pitch));
    gather_band(desc, *back, blocks[place], other.span());
    fuzz::check(fuzz::same(other.span(), band.span()), "a band comes back");
  }
  fuzz::check(next == stale.size(), "marks belong to blocks, in order");

  // In place of `to`, what it has to be: the listed blocks and nothing else.
  const std::size_t record = desc.record.bytes, both = 2U * desc.guard_band;
  for (const auto block : blocks) {
    const auto inside = block_inside(desc, block);
    for (std::uint32_t z = 0; z < inside.z; ++z) {
      for (std::uint32_t y = 0; y < inside.y + both; ++y) {
        auto origin = block_origin(desc, block);
        origin.y += y;
        origin.slice += z;
        const std::byte* line = view->at(origin, record);
        std::memcpy(untouched.span().data() + (line - from.span().data()), line,
                    (inside.x + both) * record);
      }
    }
  }
  fuzz::check(fuzz::same(to.span(), untouched.span()), "the listed blocks come back, no others");
  if (desc.block.x != desc.block.y || desc.block.z != 1 || desc.records.x != 0) return 0;

  // One run of blocks by each instruction set.
  const unsigned in_row = desc.layout.slots.x != 0 ? desc.layout.slots.x : desc.grid.x;
  const unsigned count = std::min({in_row, block_count(desc), 64U});
  const auto place = [&](std::uint32_t block) {
    return static_cast<std::size_t>(view->at(block_origin(desc, block), record) -
                                    from.span().data());
  };
  const std::size_t first = place(0), step = count > 1 ? place(1) - first : 0;
  const auto run_in = [&](auto bytes) {
    return BlockRun<typename decltype(bytes)::element_type>{
        bytes.data() + first,         row_pitch, step, count, desc.block.x, desc.guard_band,
        static_cast<unsigned>(record)};
  };
  const std::size_t run_bytes = std::size_t{count} * block_bytes(desc);
  std::uint64_t marks = 0;
  for (const Isa isa : supported_isas()) {
    fuzz::Exact out(run_bytes, static_cast<unsigned>(isa)), again(whole, 1);
    const auto found = kernels<BlockKernels>(isa).strip_run(
        run_in(std::span<const std::byte>(from.span())), out.span().data());
    if (isa == Isa::scalar) {
      marks = found;
      std::ranges::copy(out.span(), records.span().begin());
      std::ranges::copy(to.span(), untouched.span().begin());
      kernels<BlockKernels>(isa).reconstruct_run(records.span().data(), run_in(untouched.span()));
    }
    fuzz::check(found == marks, "the same marks on every instruction set");
    fuzz::check(fuzz::same(out.span(), records.span().first(run_bytes)),
                "the same records on every instruction set");
    std::ranges::copy(to.span(), again.span().begin());
    kernels<BlockKernels>(isa).reconstruct_run(records.span().data(), run_in(again.span()));
    fuzz::check(fuzz::same(again.span(), untouched.span()),
                "the same blocks on every instruction set");
  }
  return 0;
}

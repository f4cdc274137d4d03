// strip and reconstruct, on every instruction set, and the rings of stale guard bands: a
// description, gaps between rows and slices, probes, then texels, repeated. Every listed block of a
// texture comes back, and nothing else is written.
#include "texture/blocks.h"

#include "input.h"
#include "simd/kernels.h"
#include "texture/guard_band.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto desc = input.desc();
  const auto measure = extent(desc);
  const std::size_t row = std::size_t{measure.width} * texel_bytes(desc);
  const std::size_t row_pitch = row + input.below(9);
  const std::size_t slice_pitch = measure.height * row_pitch + input.below(9);
  const std::size_t whole =
      (measure.slices - 1) * slice_pitch + (measure.height - 1) * row_pitch + row;
  const auto probes = input.probes(desc);
  const auto pattern = input.rest();
  fuzz::Exact from(whole), to(whole, 1), untouched(whole, 1);
  // Guard bands by the rule, then what the input says in places.
  fuzz::Exact cores(probe_count(desc) * core_bytes(desc));
  for (std::size_t i = 0; i < cores.span().size() && !pattern.empty(); ++i) {
    cores.span()[i] = pattern[i % pattern.size()];
  }
  std::vector<std::uint32_t> all(probe_count(desc));
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const auto writable = check_view(desc, TextureView{from.span(), row_pitch, slice_pitch});
  const auto target = check_view(desc, TextureView{to.span(), row_pitch, slice_pitch});
  const auto view = check_view(desc, ConstTextureView(from.span(), row_pitch, slice_pitch));
  fuzz::check(writable.ok() && target.ok() && view.ok(), "views of the right size");
  reconstruct(best_isa(), desc, *writable, all, cores.span());
  for (std::size_t i = 0; i + 2 < std::min<std::size_t>(pattern.size(), 48); i += 3) {
    const auto at = std::to_integer<std::size_t>(pattern[i]) |
                    std::to_integer<std::size_t>(pattern[i + 1]) << 8;
    from.span()[at % whole] ^= pattern[i + 2];
  }

  fuzz::Exact stripped(probes.size() * core_bytes(desc));
  std::vector<std::uint32_t> stale;
  strip(best_isa(), desc, *view, probes, stripped.span(), stale);
  reconstruct(best_isa(), desc, *target, probes, stripped.span());
  fuzz::Exact ring(ring_bytes(desc)), ruled(ring.span().size()), other(ring.span().size(), 1);
  std::size_t next = 0;
  for (std::uint32_t place = 0; place < probes.size(); ++place) {
    gather_ring(desc, *view, probes[place], ring.span());
    ring_by_rule(desc, stripped.span().data() + place * core_bytes(desc), ruled.span());
    const bool marked = next < stale.size() && stale[next] == place;
    fuzz::check(marked != fuzz::same(ring.span(), ruled.span()), "what breaks the rule is marked");
    if (!marked) continue;
    ++next;
    scatter_ring(desc, *target, probes[place], ring.span());
    const auto back = check_view(desc, ConstTextureView(to.span(), row_pitch, slice_pitch));
    gather_ring(desc, *back, probes[place], other.span());
    fuzz::check(fuzz::same(other.span(), ring.span()), "a ring comes back");
  }
  fuzz::check(next == stale.size(), "marks belong to probes, in order");

  // In place of `to`, what it has to be: the listed blocks and nothing else.
  for (const auto probe : probes) {
    for (std::uint32_t y = 0; y < block_side(desc); ++y) {
      auto origin = block_origin(desc, probe);
      origin.y += y;
      const std::byte* line = view->at(origin, texel_bytes(desc));
      std::memcpy(untouched.span().data() + (line - from.span().data()), line,
                  std::size_t{block_side(desc)} * texel_bytes(desc));
    }
  }
  fuzz::check(fuzz::same(to.span(), untouched.span()), "the listed blocks come back, no others");

  // One run of blocks by each instruction set.
  const unsigned count = std::min(desc.grid.x, 64U);
  const std::size_t run_bytes = std::size_t{count} * core_bytes(desc);
  std::uint64_t marks = 0;
  for (const Isa isa : supported_isas()) {
    fuzz::Exact out(run_bytes, static_cast<unsigned>(isa)), again(whole, 1);
    const auto texel = static_cast<unsigned>(texel_bytes(desc));
    const auto found = kernels(isa).strip_run(
        {from.span().data(), row_pitch, count, desc.core, desc.border, texel}, out.span().data());
    if (isa == Isa::scalar) {
      marks = found;
      std::ranges::copy(out.span(), cores.span().begin());
      std::ranges::copy(to.span(), untouched.span().begin());
      kernels(isa).reconstruct_run(cores.span().data(), {untouched.span().data(), row_pitch, count,
                                                         desc.core, desc.border, texel});
    }
    fuzz::check(found == marks, "the same marks on every instruction set");
    fuzz::check(fuzz::same(out.span(), cores.span().first(run_bytes)),
                "the same core texels on every instruction set");
    std::ranges::copy(to.span(), again.span().begin());
    kernels(isa).reconstruct_run(cores.span().data(), {again.span().data(), row_pitch, count,
                                                       desc.core, desc.border, texel});
    fuzz::check(fuzz::same(again.span(), untouched.span()),
                "the same blocks on every instruction set");
  }
  return 0;
}

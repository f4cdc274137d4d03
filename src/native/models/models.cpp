#include "native/models/models.h"

#include "native/frame/chunk_head.h"
#include "native/models/chunk_coding.h"

#include <algorithm>
#include <array>

namespace gicodec::native {
namespace {

constexpr std::array kModels{
    ModelRow{Model::none, false, Adapts::if_small, 1U << 17},
    ModelRow{Model::stacked, true, Adapts::never, 1U << 17},
    ModelRow{Model::continuous, true, Adapts::if_strong, 1U << 17},
    ModelRow{Model::unordered, false, Adapts::always, 1U << 16},
    ModelRow{Model::octree, false, Adapts::always, 1U << 20},  // most voxels do not exist
    ModelRow{Model::hemispheres, true, Adapts::if_small, 1U << 17},
};
constexpr const ModelRow& row(Model model) { return kModels[static_cast<std::size_t>(model)]; }
static_assert(std::all_of(kModels.begin(), kModels.end(),
                          [](const ModelRow& one) { return &row(one.model) == &one; }));

template <typename Coder>
bool code(const ChunkCoding<Coder>& chunk) {
  switch (model_of(chunk.update.desc).model) {
    case Model::none:
    case Model::stacked:
      return code_records(chunk);
    case Model::continuous:
      return takes_raster(chunk.update.desc) ? code_continuous(chunk) : code_records(chunk);
    case Model::unordered:
      return code_unordered(chunk);
    case Model::octree:
      return code_octree(chunk);
    case Model::hemispheres:
      return code_hemispheres(chunk);
  }
  return false;
}

}  // namespace

bool takes_raster(const TextureDesc& desc) noexcept {
  const auto used = desc.record.used();
  return desc.model == Model::continuous &&
         std::any_of(used.begin(), used.end(), [](const Component& component) {
           return component.type != ComponentType::opaque;
         });
}

const ModelRow& model_of(const TextureDesc& desc) noexcept {
  const bool light = desc.record.format == Format::E5B9G9R9_UFLOAT_PACK32 ||
                     desc.record.format == Format::R16G16B16A16_SFLOAT;
  return row(desc.model == Model::octree && !light ? Model::none : desc.model);
}

namespace {

bool encode(const Update& u, std::span<const std::uint32_t> positions, const BlockTable& records,
            std::size_t most, bool palettes, ModelMemory& memory, std::vector<std::byte>& out) {
  const std::size_t begin = out.size();
  out.push_back(std::byte{kAdaptiveChunk});
  BinaryEncoder coder(out);
  const bool within = code(ChunkCoding<BinaryEncoder>{.update = u,
                                                      .positions = positions,
                                                      .records = records,
                                                      .decoded = {},
                                                      .coder = coder,
                                                      .memory = memory,
                                                      .most = begin + most,
                                                      .palettes = palettes});
  coder.finish();
  if (within && out.size() - begin <= most) return true;
  out.resize(begin);
  return false;
}

}  // namespace

bool encode_adaptive(const Update& u, std::span<const std::uint32_t> positions,
                     const BlockTable& records, std::size_t most, ModelMemory& memory,
                     std::vector<std::byte>& out) {
  const std::size_t begin = out.size();
  const bool done = encode(u, positions, records, most, true, memory, out);
  if (!takes_raster(u.desc) || !memory.continuous.forms.have_places()) {
    return done;
  }
  // Whether palettes pay shows only without them.
  const std::size_t end = out.size();
  if (!encode(u, positions, records, done ? end - begin : most, false, memory, out)) return done;
  out.erase(out.begin() + static_cast<std::ptrdiff_t>(begin),
            out.begin() + static_cast<std::ptrdiff_t>(end));
  return true;
}

Status decode_adaptive(const Update& u, std::span<const std::uint32_t> positions,
                       std::span<const std::byte> bytes, std::span<std::byte> records,
                       ModelMemory& memory) {
  BinaryDecoder coder(bytes);
  const bool valid = code(ChunkCoding<BinaryDecoder>{.update = u,
                                                     .positions = positions,
                                                     .records = {records.data(), u.block_bytes()},
                                                     .decoded = records,
                                                     .coder = coder,
                                                     .memory = memory});
  if (u.cancelled()) return Status::cancelled;
  if (coder.overrun()) return Status::truncated;
  return valid && coder.ended() ? Status::ok : Status::corrupt;
}

}  // namespace gicodec::native

// Kind 5, photons (FORMAT.md, "Kinds" and "Photons").
#include <gicodec/photons.h>

#include "base/guard.h"
#include "bitstream/description.h"
#include "kinds/made_volume.h"
#include "kinds/record_parts.h"
#include "quantise/set_order.h"

namespace gicodec {
namespace {

Record photon_record(PhotonForm form) noexcept {
  using enum ComponentType;
  if (form == PhotonForm::halves) {
    return record_of({{"x", 16, unorm},
                      {"y", 16, unorm},
                      {"z", 16, unorm},
                      {"u", 8, snorm},
                      {"v", 8, snorm},
                      {"r", 16, sfloat},
                      {"g", 16, sfloat},
                      {"b", 16, sfloat},
                      {"radius", 16, sfloat},
                      {"norm", 32, sfloat}});
  }
  return record_of({{"x", 16, unorm},
                    {"y", 16, unorm},
                    {"z", 16, unorm},
                    {"u", 16, snorm},
                    {"v", 16, snorm},
                    {"radius", 16, sfloat},
                    {"r", 9, ufloat},
                    {"g", 9, ufloat},
                    {"b", 9, ufloat},
                    {"e", 5, exponent},
                    {"norm", 32, sfloat}});
}

Record batch_record() noexcept {
  using enum ComponentType;
  return record_of({{"x", 32, sfloat},
                    {"y", 32, sfloat},
                    {"z", 32, sfloat},
                    {"width", 32, sfloat},
                    {"height", 32, sfloat},
                    {"depth", 32, sfloat},
                    {"watts", 32, sfloat},
                    {"light", 16, uint},
                    {"state", 16, uint},
                    {"emitted", 32, uint}});
}

constexpr std::uint32_t kSlice = kMaxBlockSide * kMaxBlockSide;

/// The block of `capacity` records; an empty shape if the number is not allowed.
BlockShape shape_of(std::uint32_t capacity) noexcept {
  const auto side = [](std::uint32_t n) { return static_cast<std::uint8_t>(n); };
  if (capacity <= kMaxBlockSide) return {side(capacity), 1, 1};
  if (capacity <= kSlice && capacity % kMaxBlockSide == 0) {
    return {kMaxBlockSide, side(capacity / kMaxBlockSide), 1};
  }
  if (capacity <= kMaxPhotons && capacity % kSlice == 0) {
    return {kMaxBlockSide, kMaxBlockSide, side(capacity / kSlice)};
  }
  return {0, 0, 0};
}

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (volume.kind != kKindPhotons || volume.groups.size() != 1 ||
      volume.groups.front().textures.size() != 3) {
    return Status::invalid_description;
  }
  const TextureDesc& photons = volume.groups.front().textures.back().desc;
  const auto form = photon_form(photons.record);
  if (!form) return Status::invalid_description;
  const auto made = photon_volume(photons.grid.x, record_count(photons.block), *form);
  return write_made(volume, made, out, [&](ByteWriter& writer) {
    writer.varint(photons.grid.x);
    writer.varint(record_count(photons.block));
    writer.fixed(static_cast<std::uint8_t>(*form));
  });
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  ByteReader reader(description);
  const auto batches = static_cast<std::uint32_t>(reader.varint(kMaxBlocks));
  const auto capacity = static_cast<std::uint32_t>(reader.varint(kMaxPhotons));
  const auto form = reader.fixed<std::uint8_t>();
  if (!reader.ok() || !reader.rest().empty() || form > 1) return Status::corrupt;
  return read_made(photon_volume(batches, capacity, static_cast<PhotonForm>(form)));
}

void sort(const TextureDesc& desc, std::span<std::byte> block) {
  if (photon_form(desc.record)) sort_set(desc.record, block);
}

}  // namespace

constinit const Kind kPhotons{kKindPhotons, "photons", write, read, sort};

Result<PhotonForm> photon_form(const Record& record) noexcept {
  for (const auto form : {PhotonForm::halves, PhotonForm::shared_exponent}) {
    if (record == photon_record(form)) return form;
  }
  return Status::unsupported_format;
}

Result<VolumeDesc> photon_volume(std::uint32_t batches, std::uint32_t capacity, PhotonForm form) {
  if (form > PhotonForm::shared_exponent) return Status::invalid_description;
  return guarded([&]() -> Result<VolumeDesc> {
    TextureDesc photons = pool_texture(photon_record(form), batches, shape_of(capacity));
    photons.presence = Presence::count;
    photons.model = Model::unordered;
    VolumeDesc volume{kKindPhotons, {{}}};
    TextureGroup& group = volume.groups.front();
    group.bundled = true;
    group.presence = 0;
    group.textures = {
        {"count", pool_texture(Format::R16_UINT, batches, {1, 1, 1}), Threshold::exact},
        {"batch", pool_texture(batch_record(), batches, {1, 1, 1}), Threshold::exact},
        {"photons", photons, Threshold::exact}};
    if (const Status status = validate(volume); status != Status::ok) return status;
    return volume;
  });
}

}  // namespace gicodec

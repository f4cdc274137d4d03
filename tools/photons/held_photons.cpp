#include "held_photons.h"

#include "dump/error.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <string_view>

namespace gicodec::photons {
namespace {

using ddgi::vec;
using ddgi::Vec3;
using tools::Exit;
using tools::fail;

bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool at_least_zero(Vec3 v) { return v.x >= 0 && v.y >= 0 && v.z >= 0; }

bool usable(const PhotonBatch& batch) {
  return batch.emitted > 0 && batch.watts >= 0 && std::isfinite(batch.watts) &&
         finite(vec(batch.minimum)) && finite(vec(batch.extent)) &&
         at_least_zero(vec(batch.extent));
}

bool usable(const HeldPhoton& photon) {
  return finite(photon.position) && finite(photon.direction) && finite(photon.flux) &&
         at_least_zero(photon.flux) && photon.radius > 0 && std::isfinite(photon.radius);
}

std::size_t hash_of(std::span<const std::byte> head, std::span<const std::byte> records) {
  if (head.empty()) return 0;
  const auto one = [](std::span<const std::byte> bytes) {
    return std::hash<std::string_view>{}(
        {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  };
  return (one(head) * 31 + one(records)) | 1;
}

}  // namespace

HeldPhotons::HeldPhotons(const VolumeDesc& desc) {
  const bool photons = desc.kind == kKindPhotons && desc.groups.size() == 1 &&
                       desc.groups.front().textures.size() == 3;
  if (!photons) fail(Exit::bad_input, "this volume is not one of photons");
  const TextureDesc& records = desc.groups.front().textures.back().desc;
  if (records.grid.x > kMaxBatches)
    fail(Exit::bad_input, "photons: {} batches cannot be drawn; up to {} can", records.grid.x,
         kMaxBatches);
  form_ = tools::take(photon_form(records.record), "photons");
  capacity_ = record_count(records.block);
  desc_ = tools::take(photon_volume(records.grid.x, capacity_, form_), "photons");
  const auto& own = desc_.groups.front().textures;
  if (!std::ranges::equal(own, desc.groups.front().textures, {}, &NamedTexture::desc,
                          &NamedTexture::desc))
    fail(Exit::bad_input, "photons: the volume is no array of batches");
  batches_.resize(records.grid.x);
}

void HeldPhotons::update(const kinds::HeldVolume& volume) {
  kinds::check_held(volume, desc_);
  const auto& textures = volume.textures;
  for (std::size_t slot = 0; slot < batches_.size(); ++slot) {
    Batch& batch = batches_[slot];
    std::span<const std::byte> head, records;
    if (textures[0].has(slot) && textures[1].has(slot) && textures[2].has(slot)) {
      std::uint16_t count = 0;
      std::memcpy(&count, &textures[0].texels[slot * sizeof count], sizeof count);
      const std::size_t size = std::min<std::size_t>(count, capacity_) * kPhotonBytes;
      head = textures[1].texels.subspan(slot * kPhotonBatchBytes, kPhotonBatchBytes);
      records = textures[2].texels.subspan(slot * capacity_ * kPhotonBytes, size);
    }
    const std::size_t hash = hash_of(head, records);
    if (hash == batch.hash) continue;
    batch.hash = hash;
    unpack(head, records, batch);
  }
  expire();
}

void HeldPhotons::unpack(std::span<const std::byte> head, std::span<const std::byte> records,
                         Batch& batch) const {
  batch.photons.clear();
  batch.batch = {};
  if (head.empty()) return;
  const PhotonBatch said = unpack_photon_batch(head.first<kPhotonBatchBytes>());
  if (!usable(said)) return;
  batch.batch = said;
  batch.photons.reserve(records.size() / kPhotonBytes);
  for (std::size_t at = 0; at < records.size(); at += kPhotonBytes) {
    const Photon photon =
        unpack_photon(records.subspan(at).first<kPhotonBytes>(), batch.batch, form_);
    const HeldPhoton held{vec(photon.position), vec(photon.direction),
                          vec(photon.power) * (photon.normalisation * batch.batch.watts),
                          photon.radius};
    if (usable(held)) batch.photons.push_back(held);
  }
}

void HeldPhotons::expire() {
  struct Light {
    std::uint16_t newest = 0;
    double emitted = 0;  ///< by its batches, weighed
  };
  std::map<std::uint16_t, Light> lights;
  for (const Batch& batch : batches_) {
    if (batch.batch.emitted == 0) continue;
    const auto [at, first] = lights.try_emplace(batch.batch.light);
    const auto ahead = static_cast<std::uint16_t>(batch.batch.generation - at->second.newest);
    if (first || (ahead > 0 && ahead < 0x8000)) at->second.newest = batch.batch.generation;
  }
  for (Batch& batch : batches_) {
    batch.scale = 0;
    if (batch.batch.emitted == 0) continue;
    Light& light = lights[batch.batch.light];
    const auto age = static_cast<std::uint16_t>(light.newest - batch.batch.generation);
    if (age > kOldest) continue;
    batch.scale = std::ldexp(1.0F, -age);
    light.emitted += double{batch.scale} * batch.batch.emitted;
  }
  for (Batch& batch : batches_) {
    if (batch.scale <= 0) continue;
    batch.scale = static_cast<float>(batch.scale / lights[batch.batch.light].emitted);
  }
}

}  // namespace gicodec::photons

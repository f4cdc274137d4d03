#include "maps.h"

#include "dump/error.h"

namespace gicodec::maps {

MapServer::MapServer(const ddgi::Scene& scene, const MapOptions& options, unsigned threads,
                     std::function<bool()> cancelled)
    : options_(options),
      scene_(scene),
      pool_(threads, std::move(cancelled)),
      map_(scene, options.desc.width, options.desc.height),
      code_(options.desc.format) {
  ddgi::FrameState rest;
  for (const ddgi::Object& object : scene.objects) rest.transforms.push_back(object.transform);
  for (const ddgi::Material& material : scene.materials) {
    rest.emission.push_back(material.emission);
  }
  scene_.set_state(std::move(rest));
  texels_ = open_texels(map_, scene_, pool_);
  coverage_ = coverage_of(map_, texels_);
  exists_ = existence_of(map_, coverage_);
  if (options_.by_bases) {
    bases_ = make_bases(map_, scene_, texels_, options_.bases, options_.spacing, pool_);
    coefficients_.resize(bases_.centres.size());
  }
  if (options_.desc.way == MapWay::bases) {
    options_.desc.bases = (static_cast<std::uint32_t>(bases_.centres.size()) + 63) / 64 * 64;
    blends_ = blends_of(map_, texels_, bases_.blends);
  }
  const std::size_t places = std::size_t{map_.width()} * map_.height();
  values_.resize(places);
  direct_.resize(places);
  lit_.resize(places);
}

void MapServer::update(double time) {
  for (; updates_ < options_.gather.warmup; ++updates_) step(time);
  step(time);
  ++updates_;
}

void MapServer::step(double time) {
  count_ = {};
  scene_.set_state(scene_.scene().state_at(time));
  light_directly(map_, scene_, texels_, pool_, direct_, count_);
  for (const MapTexel& texel : texels_) {
    lit_[texel.place] = direct_[texel.place] + values_[texel.place];
  }
  if (!options_.by_bases) {
    std::vector<Vec3> found(texels_.size());
    gather(map_, scene_, texels_, lit_, exists_, options_.gather, updates_, pool_, found, count_);
    for (std::size_t i = 0; i < found.size(); ++i) values_[texels_[i].place] = found[i];
    clipped_ = code_.clips(found);
    return;
  }
  gather(map_, scene_, bases_.centres, lit_, exists_, options_.gather, updates_, pool_,
         coefficients_, count_);
  clipped_ = code_.clips(coefficients_);
  // As a client has them.
  std::vector<std::byte> texel(code_.bytes());
  for (Vec3& coefficient : coefficients_) {
    code_.store(texel.data(), coefficient);
    coefficient = code_.load(texel.data());
  }
  reconstruct(texels_, bases_.blends, coefficients_, values_);
}

std::vector<std::vector<std::byte>> MapServer::textures() const {
  if (options_.desc.way == MapWay::bases) {
    return {coefficients_of(code_, coefficients_), coverage_, blends_, hash_of(map_)};
  }
  return {coverage_, texels_of(map_, texels_, code_, values_), hash_of(map_)};
}

}  // namespace gicodec::maps

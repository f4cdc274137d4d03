// The texels of a chunk, row by row (docs/native/continuous.md).
#include "native/models/chunk_coding.h"

namespace gicodec::native {
namespace {

template <typename Coder>
bool code_texel(Coder& coder, CounterTable& counters, ContinuousModel& model, const Place& place) {
  auto& raster = model.raster;
  auto& forms = model.forms;
  auto& predictor = model.predictor;
  if (model.repeats.code(coder, counters, raster, forms, place)) {
    predictor.pass(place);
    return true;
  }
  model.residuals.begin_texel();
  for (unsigned k = 0; k < forms.coded().size(); ++k) {
    const Prediction prediction = predictor.predict(raster, forms, place, k);
    std::int64_t residual = 0;
    if (!model.residuals.code(coder, counters, raster, forms, predictor, place, k, prediction,
                              residual)) {
      return false;
    }
    predictor.learn(raster, place, k, prediction, residual);
  }
  return true;
}

}  // namespace

template <typename Coder>
bool code_continuous(const ChunkCoding<Coder>& chunk) {
  const Update& u = chunk.update;
  if (!fits_raster(u.desc, u.box)) return false;
  ValueModel& values = chunk.memory.values;
  ContinuousModel& model = chunk.memory.continuous;
  Raster& raster = model.raster;
  values.reset();
  raster.lay_out(u, chunk.positions);
  if constexpr (!Coder::kDecodes) {
    for (const auto position : chunk.positions) raster.load(u, position, chunk.in(position));
    choose_forms(raster, chunk.palettes, model.forms, model.form_scratch);
  }
  if (!model.forms.code(chunk.coder, raster.channels(), raster.coded_texels(), values)) {
    return false;
  }
  to_places(model.forms, raster);
  model.repeats.reset(raster);
  model.predictor.reset(raster, model.forms);
  model.residuals.reset(raster, model.forms);
  const Grid size = raster.size();
  for (std::uint32_t z = 0; z < size.z; ++z) {
    for (std::uint32_t y = 0; y < size.y; ++y) {
      for (std::uint32_t x = 0; x < size.x && !model.forms.coded().empty(); ++x) {
        const Place place = place_of(raster, x, y, z);
        if (!raster.coded(place.here)) {
          model.predictor.pass(place);
        } else if (!code_texel(chunk.coder, values.counters(), model, place)) {
          return false;
        }
        model.repeats.learn(raster, model.forms, place);
      }
      if (!chunk.goes_on()) return false;
    }
  }
  if constexpr (Coder::kDecodes) {
    from_places(model.forms, raster);
    for (const auto position : chunk.positions) raster.store(u, position, chunk.out(position));
  }
  return true;
}

template bool code_continuous(const ChunkCoding<BinaryEncoder>& chunk);
template bool code_continuous(const ChunkCoding<BinaryDecoder>& chunk);

}  // namespace gicodec::native

// Textures whose texels resemble those next to them, over edges of blocks
// (docs/native/continuous.md).
#pragma once

#include "native/models/continuous/raster_forms.h"
#include "native/models/continuous/texel_predictor.h"
#include "native/models/continuous/texel_repeats.h"
#include "native/models/continuous/texel_residuals.h"
#include "native/raster/raster.h"

namespace gicodec::native {

/// Memory of one thread, kept for its capacity.
struct ContinuousModel {
  Raster raster;
  ChannelForms forms;
  FormScratch form_scratch;
  TexelRepeats repeats;
  TexelPredictor predictor;
  TexelResiduals residuals;
};

}  // namespace gicodec::native

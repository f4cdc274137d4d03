// Modules are not built for Windows: Debian has no OpenImageIO, x265 and FFmpeg to build them with.
#include "modules/module.h"

#include "error.h"
#include "modules/hevc.h"
#include "modules/http.h"
#include "modules/images.h"

namespace gicodec::tools {

const ImageModule& image_module() {
  fail(Exit::internal, "this build is without PNG, TIFF and DPX; use EXR, DDS or KTX2");
}

const HttpModule& http_module() {
  fail(Exit::internal, "this build is without HTTP; get the file with curl -O");
}

const HevcModule& hevc_module() {
  fail(Exit::internal, "HEVC is not in this build; choose another backend");
}

}  // namespace gicodec::tools

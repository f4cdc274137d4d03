#include "feed_fit.h"

#include "common/backend_flags.h"
#include "dump/error.h"

#include <gicodec/backend.h>

#include <algorithm>

namespace gicodec::streaming {

using tools::Exit;
using tools::fail;

void check_backend(const ServerFlags& o, const FeedVolume& volume) {
  const auto all = built_in_backends();
  const auto backend = std::ranges::find(all, o.backend, &Backend::name);
  if (backend == all.end()) return;
  for (const NamedTexture* texture : textures_of(volume.desc)) {
    const Status status = (*backend)->make_encoder(texture->desc, o.server.settings).status();
    if (status == Status::invalid_settings) {
      fail(Exit::usage,
           "backend {} refuses{}: native takes --preset auto, turbo, fast or strong and --chunk up "
           "to 4096, lz4 --level -64 to 12, zstd -64 to 22, raw none of them",
           o.backend, tools::given_settings(o.server.settings));
    }
  }
}

}  // namespace gicodec::streaming

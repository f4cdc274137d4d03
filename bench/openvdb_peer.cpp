#include "openvdb_peer.h"

#ifdef GICODEC_HAS_OPENVDB
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <sstream>
#endif

namespace gicodec::bench {

#ifdef GICODEC_HAS_OPENVDB

std::size_t openvdb_zip(const std::vector<std::vector<OpenVdbVoxel>>& levels) {
  openvdb::initialize();
  openvdb::GridPtrVec grids;
  for (const auto& level : levels) {
    for (std::size_t direction = 0; direction < 6; ++direction) {
      auto grid = openvdb::Vec3SGrid::create();
      grid->setSaveFloatAsHalf(true);
      auto accessor = grid->getAccessor();
      for (const OpenVdbVoxel& voxel : level) {
        const auto& c = voxel.light[direction];
        accessor.setValueOn({voxel.at[0], voxel.at[1], voxel.at[2]}, {c[0], c[1], c[2]});
      }
      grids.push_back(grid);
    }
  }
  std::ostringstream file(std::ios::binary);
  openvdb::io::Stream stream(file);
  stream.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  stream.write(grids);
  return file.str().size();
}

#else

std::size_t openvdb_zip(const std::vector<std::vector<OpenVdbVoxel>>& /*levels*/) { return 0; }

#endif

}  // namespace gicodec::bench

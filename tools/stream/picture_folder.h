// The folder of a client's pictures: their names, and the files that they may replace.
#pragma once

#include "dump/file.h"

#include <cstdint>
#include <set>
#include <string>

namespace gicodec::streaming {

class PictureFolder {
 public:
  /// The folder must exist once pictures are written. A picture never replaces one of `inputs`.
  PictureFolder(std::string folder, tools::Existing existing, tools::InputFiles inputs = {});

  /// The path of a picture, and whether it may replace a file once it is ready.
  struct Place {
    std::string path;
    tools::Existing existing;
  };
  // Both throw tools::Error of Exit::io where `existing` keeps a file of that name, unless it is
  // one of these pictures.

  /// FOLDER/frame.NNNN.png
  [[nodiscard]] Place frame(std::uint32_t number);
  /// FOLDER/VOLUME.TEXTURE.NNNN.png, the server's names by tools::as_file_name().
  [[nodiscard]] Place texture(const std::string& volume, const std::string& texture,
                              std::uint32_t number);

 private:
  Place checked(const std::string& name, std::uint32_t number);

  std::string folder_;
  tools::Existing existing_;
  tools::InputFiles inputs_;
  std::uint32_t number_ = 0;
  std::set<std::string>
      made_;  ///< names of this number, because names of textures may become equal
};

}  // namespace gicodec::streaming

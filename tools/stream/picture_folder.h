// Where a client's pictures go: their names, and which files they may take the place of.
#pragma once

#include "dump/file.h"

#include <cstdint>
#include <set>
#include <string>

namespace gicodec::streaming {

class PictureFolder {
 public:
  /// The folder exists by the time that pictures are written.
  /// `inputs` never give way to a picture.
  PictureFolder(std::string folder, tools::Existing existing, tools::InputFiles inputs = {});

  /// A picture that may be written now, and what it may take the place of when it is ready.
  struct Place {
    std::string path;
    tools::Existing existing;
  };
  // Both throw tools::Error of Exit::io where `existing` keeps a file of that name, unless it is
  // one of these pictures.

  /// FOLDER/frame.NNNN.png
  [[nodiscard]] Place frame(std::uint32_t number);
  /// FOLDER/VOLUME.TEXTURE.NNNN.png, whatever names the server chose: characters other than
  /// letters, digits and '-' become '_', and long names are cut.
  [[nodiscard]] Place texture(const std::string& volume, const std::string& texture,
                              std::uint32_t number);

 private:
  Place checked(const std::string& name, std::uint32_t number);

  std::string folder_;
  tools::Existing existing_;
  tools::InputFiles inputs_;
  std::uint32_t number_ = 0;
  std::set<std::string> made_;  ///< of this number: names of textures may become the same
};

}  // namespace gicodec::streaming

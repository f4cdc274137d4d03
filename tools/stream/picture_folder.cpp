#include "picture_folder.h"

#include "common/file_names.h"
#include "dump/sequence.h"

#include <utility>

namespace gicodec::streaming {
namespace {

constexpr std::size_t kMaxPart = 100;  ///< bytes; two parts and a number are a file's name

/// Without dots, which stand between parts, and without what shells and other systems read.
std::string file_name_part(const std::string& name) {
  return tools::as_file_name(name, kMaxPart, " !\"#$&'()*+,.:;<=>?@[\\]^`{|}");
}

}  // namespace

PictureFolder::PictureFolder(std::string folder, tools::Existing existing, tools::InputFiles inputs)
    : folder_(std::move(folder)), existing_(existing), inputs_(std::move(inputs)) {}

PictureFolder::Place PictureFolder::frame(std::uint32_t number) { return checked("frame", number); }

PictureFolder::Place PictureFolder::texture(const std::string& volume, const std::string& texture,
                                            std::uint32_t number) {
  return checked(file_name_part(volume) + "." + file_name_part(texture), number);
}

PictureFolder::Place PictureFolder::checked(const std::string& name, std::uint32_t number) {
  std::string path =
      folder_ + "/" + tools::FileNames{.digits = 4, .extension = "png"}.of(name, number);
  if (std::exchange(number_, number) != number) made_.clear();
  if (!made_.insert(path).second) return {path, tools::Existing::replace};
  tools::check_output(path, inputs_, existing_);
  return {path, existing_};
}

}  // namespace gicodec::streaming

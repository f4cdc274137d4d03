// What the headers of a sequence's files make textures of.
#include "dump/cure.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "file_names.h"
#include "stored_texture.h"
#include "volume_words.h"

#include <set>
#include <utility>

namespace gicodec::tools {
namespace {

void require_same_shape(const DumpInfo& first, const DumpInfo& other, const std::string& first_path,
                        const std::string& path) {
  if (other.image != first.image || other.place != first.place) {
    fail(Exit::bad_input, "{}: has other images than {}: {} in the place of {}; {}", path,
         first_path, image_words(other), image_words(first), to_cure(Cure::stills));
  }
  if (other.desc != first.desc) {
    fail(Exit::bad_input, "{}: has another shape than {}: {} instead of {}; {}", path, first_path,
         shape_text(other.desc), shape_text(first.desc), to_cure(Cure::stills));
  }
  if (other.channels != first.channels) {
    fail(Exit::bad_input, "{}: has other channels than {}: {} instead of {}; {}", path, first_path,
         to_string(other.channels, other.desc.record.format),
         to_string(first.channels, first.desc.record.format), to_cure(Cure::stills));
  }
}

void add_changes(StoredTexture& texture, const Attributes& attributes, std::uint64_t frame) {
  for (const Attribute& attribute : attributes) {
    const Attribute* first = find_attribute(texture.info.attributes, attribute.name);
    if (first == nullptr || *first != attribute) texture.changes.push_back({frame, attribute});
  }
  for (const Attribute& attribute : texture.info.attributes) {
    if (find_attribute(attributes, attribute.name) == nullptr) {
      texture.changes.push_back({frame, {attribute.name, "", ""}});
    }
  }
}

/// Takes what is not kept of a file, and by what name each thing is called.
void note_lost(StoredTexture& texture, const DumpInfo& info, const std::string& path,
               std::set<std::string>& seen) {
  for (const std::string& what : info.lost) {
    if (!seen.insert(what).second) continue;
    texture.dropped += (texture.dropped.empty() ? "" : ", ") + what;
    if (texture.dropped_in.empty()) texture.dropped_in = path;
  }
}

StoredTexture stored_image(const Sequence& sequence, DumpInfo info) {
  StoredTexture texture;
  texture.file = from_file_name(sequence.name);
  texture.name = texture.file + (info.image.empty() ? "" : ".") + info.image;
  texture.made_of_files = true;
  texture.names = sequence.names;
  texture.names.extension = written_extension(sequence);
  texture.info = std::move(info);
  if (const auto* lost = find_attribute(texture.info.attributes, kLossyAttribute);
      lost != nullptr && lost->type == "string") {
    texture.lossy = lost->value;
    texture.largest_error = error_of(texture.lossy);
  }
  return texture;
}

}  // namespace

bool becomes_exr(const Sequence& sequence) {
  return !is_written(require_image_kind(sequence.frames.front().path));
}

std::vector<StoredTexture> inspect(const Sequence& sequence, Hints hints) {
  const FrameFile& first = sequence.frames.front();
  std::vector<std::string> paths;
  for (const FrameFile& file : sequence.frames) paths.push_back(file.path);
  hints = settle_formats(paths, std::move(hints));
  std::vector<StoredTexture> textures;
  std::vector<std::set<std::string>> lost;
  for (const FrameFile& file : sequence.frames) {
    auto infos = read_dump_infos(file.path, hints);
    if (becomes_exr(sequence)) {
      // Such a file would else be read as what its channels look like.
      for (DumpInfo& info : infos) describe(info.attributes, info.desc);
    }
    if (&file == &first) {
      for (const DumpInfo& info : infos) textures.push_back(stored_image(sequence, info));
      lost.resize(textures.size());
    }
    if (infos.size() != textures.size()) {
      fail(Exit::bad_input, "{}: has {} images, and {} has {}; {}", file.path, infos.size(),
           first.path, textures.size(), to_cure(Cure::one_kind));
    }
    for (std::size_t i = 0; i < infos.size(); ++i) {
      note_lost(textures[i], infos[i], file.path, lost[i]);
      if (&file == &first) continue;
      require_same_shape(textures[i].info, infos[i], first.path, file.path);
      add_changes(textures[i], infos[i].attributes, file.frame);
    }
    textures.front().file_bytes += size_of_file(file.path).value_or(0);
  }
  return textures;
}

std::string written_extension(const Sequence& sequence) {
  return becomes_exr(sequence) ? "exr" : sequence.names.extension;
}

}  // namespace gicodec::tools

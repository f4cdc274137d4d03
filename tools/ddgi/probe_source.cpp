#include "probe_source.h"

#include "common/container_input.h"
#include "common/volume_words.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/sequence.h"
#include "dump/text.h"

#include <algorithm>

namespace gicodec::ddgi {
namespace {

using tools::Exit;
using tools::fail;

/// `others`: why textures besides were not looked at.
void check_complete(const ProbeFrame& frame, const std::string& others = "") {
  const ProbeTextures& t = frame.textures;
  const std::string why = others.empty() ? "" : "; " + others;
  if (t.color.empty())
    fail(Exit::bad_input, "{}: has no irradiance texture (colour with a guard band, {}){}",
         frame.source, names_of(color_formats()), why);
  if (t.visibility.empty())
    fail(Exit::bad_input, "{}: has no visibility texture (distances with a guard band, {}){}",
         frame.source, names_of(visibility_formats()), why);
  if (t.color_desc.grid != t.visibility_desc.grid) {
    fail(Exit::bad_input, "{}: its textures have different grids, {} and {}", frame.source,
         tools::to_string(t.color_desc.grid), tools::to_string(t.visibility_desc.grid));
  }
}

Encoding encoding_of(const ProbeFrame& frame, const TextureDesc& desc,
                     const tools::Attributes& attributes) {
  const auto* text = find_attribute(attributes, tools::kEncodingAttribute);
  if (text == nullptr) return usual_encoding(desc.record.format);
  const auto encoding = encoding_from_string(text->value);
  if (!encoding) {
    fail(Exit::bad_input, "{}: {} is \"{}\", neither gamma5 nor linear", frame.source,
         tools::kEncodingAttribute, tools::utf8_text(text->value));
  }
  return *encoding;
}

/// Takes a texture if it is one of the two.
void take(ProbeFrame& frame, const TextureDesc& desc, std::span<const std::byte> texels,
          const tools::Attributes& attributes) {
  ProbeTextures& t = frame.textures;
  if (is_color(desc) && t.color.empty()) {
    t.color_desc = desc;
    t.color.assign(texels.begin(), texels.end());
    t.encoding = encoding_of(frame, desc, attributes);
    read_attributes(frame, attributes);
  } else if (is_visibility(desc) && t.visibility.empty()) {
    t.visibility_desc = desc;
    t.visibility.assign(texels.begin(), texels.end());
  }
}

/// Whether nothing can be missing of what the frame was given.
bool is_whole(const tools::ContainerInput& input) {
  const auto arrived = input.arrived();
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const TextureEntry& entry = input.description().textures[i];
    if (!tools::no_probes(input.description(), entry).empty()) continue;
    if (input.description().volumes[entry.volume].region != Grid{}) return false;
    if (std::ranges::find(arrived, i) == arrived.end()) return false;
  }
  return true;
}

}  // namespace

void read_attributes(ProbeFrame& frame, const tools::Attributes& attributes) {
  if (const auto* scene = find_attribute(attributes, tools::kSceneAttribute))
    frame.scene = scene->value;
  if (const auto time = find_floats(attributes, tools::kTimeAttribute, 1))
    frame.time = time->front();
  if (const auto o = find_floats(attributes, tools::kOriginAttribute, 3))
    frame.origin = {(*o)[0], (*o)[1], (*o)[2]};
  if (const auto s = find_floats(attributes, tools::kSpacingAttribute, 3))
    frame.spacing = {(*s)[0], (*s)[1], (*s)[2]};
}

ProbeFrame load_stream(const std::string& path, std::uint64_t frame, bool allow_incomplete,
                       const tools::DecoderFlags& decoding) {
  ProbeFrame out;
  out.source = path;
  tools::ContainerInput input(path, decoding);
  out.missing = require_complete(input, allow_incomplete);
  input.seek(frame);
  std::optional<std::uint64_t> last;
  while ((!last || *last < frame) && input.next_frame() && input.frame() <= frame) {
    last = input.frame();
  }
  if (out.missing.empty()) out.missing = require_complete(input, allow_incomplete);
  if (!last || *last != frame) {
    fail(Exit::bad_input, "{}: has no frame {}{}", path, frame,
         last ? fmt::format("; the last one before it is {}", *last) : "");
  }
  std::string others;
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const tools::StoredTexture& texture = input.textures()[i];
    const std::string why_not =
        tools::no_probes(input.description(), input.description().textures[i]);
    if (others.empty()) others = why_not;
    if (!why_not.empty()) continue;
    const auto info = texture.info_at(frame);
    if (out.loss.empty()) out.loss = texture.loss();
    take(out, info.desc, input.texels(i), info.attributes);
  }
  check_complete(out, others);
  if (!is_whole(input)) tools::require_whole(input);
  return out;
}

ProbeFrame load_dumps(const std::string& folder, std::uint64_t frame) {
  ProbeFrame out;
  out.source = folder;
  std::string others;
  for (const auto& sequence : tools::group_sequences({folder}, true)) {
    const auto* file = sequence.find(frame);
    if (file == nullptr) {
      fail(Exit::bad_input, "{}: has no frame {} of texture {}; it holds {} to {}", folder, frame,
           sequence.name, sequence.frames.front().frame, sequence.frames.back().frame);
    }
    if (tools::image_kind(file->path) == tools::ImageKind::dds) {
      others =
          "its DDS files do not say what they hold; draw a container of them by --stream, or "
          "decode it to another kind of files";
      continue;
    }
    const tools::Dump dump = tools::read_dump(file->path);
    take(out, dump.info.desc, dump.texels, dump.info.attributes);
  }
  check_complete(out, others);
  return out;
}

}  // namespace gicodec::ddgi

#include "file_forms.h"

#include "dump/cure.h"
#include "dump/error.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <array>
#include <set>

namespace gicodec::tools {
namespace {

struct Form {
  ImageKind kind;
  const char* ending;
};
constexpr std::array<Form, 4> kForms{{{ImageKind::exr, "exr"},
                                      {ImageKind::dds, "dds"},
                                      {ImageKind::ktx2, "ktx2"},
                                      {ImageKind::raw, "raw"}}};

ImageKind kind_of(const StoredTexture& texture) {
  return image_kind("x." + texture.names.extension).value_or(ImageKind::exr);
}

/// True if files of that kind can hold the attribute. All kinds but DDS can hold text; other types
/// belong to one kind, such as an EXR's compression.
bool can_have(ImageKind kind, const Attribute& attribute) {
  if (kind == ImageKind::dds || attribute.value.starts_with("0x")) return false;
  return kind != ImageKind::exr || exr_has_attribute(attribute);
}

/// True if EXR files had all channels of a texture but alpha.
bool lacks_alpha(const StoredTexture& texture) {
  const auto used = texture.info.desc.record.used();
  return texture.made_of_files && !texture.info.channels.alpha &&
         std::ranges::any_of(used, [](const Component& one) { return one.name() == "A"; });
}

/// Makes an image of a file the one image of its own.
void own_file(StoredTexture& texture) {
  texture.file = texture.name;
  texture.info.image.clear();
  texture.info.place = {};
  texture.info.head = true;
}

}  // namespace

void set_files(StoredTexture& texture, ImageKind kind) {
  if (kind_of(texture) == kind) return;
  // Only these two place levels and faces alike.
  const auto has_levels = [](ImageKind one) {
    return one == ImageKind::dds || one == ImageKind::ktx2;
  };
  if (!has_levels(kind) || !has_levels(kind_of(texture))) own_file(texture);
  texture.names.extension = std::ranges::find(kForms, kind, &Form::kind)->ending;
  std::set<std::string> unsaid;
  const auto remove = [&](const Attribute& attribute) {
    const bool field = is_head_field(attribute.name);
    if (field && !attribute.name.starts_with("exr:")) return true;
    if (!field && can_have(kind, attribute)) return false;
    unsaid.insert(attribute.name);
    return true;
  };
  Attributes& attributes = texture.info.attributes;
  if (kind != ImageKind::dds) describe(attributes, texture.info.desc);
  std::erase_if(attributes, remove);
  if (find_attribute(attributes, kTimeAttribute) == nullptr) texture.times.reset();
  for (FrameAttribute& change : texture.changes) {
    // An empty entry, since the frame would otherwise get the first frame's attribute.
    if (remove(change.attribute)) change.attribute = {change.attribute.name, "", ""};
  }
  for (const std::string& name : unsaid) {
    texture.unsaid += (texture.unsaid.empty() ? "" : ", ") + name;
  }
  const Record& record = texture.info.desc.record;
  if (kind == ImageKind::exr && record.components[0].type == ComponentType::opaque) {
    texture.unlike = "its compressed blocks become channels of numbers, which are no picture";
  }
  if (kind != ImageKind::exr && lacks_alpha(texture)) {
    texture.unlike =
        "its files get an alpha of 0, since their format has one and the EXR files none";
  }
}

/// Advice for EXR files of floats whose values all are 10-bit codes; else empty.
std::string float_advice(const StoredTexture& texture) {
  const SampleType type = texture.info.channels.types[0];
  const bool codes = texture.info.desc.record.components[0].bits == 10;
  if (!texture.made_of_files || !codes || type == SampleType::uint32) return "";
  return "; " + to_cure(Cure::as_floats,
                        type == SampleType::half ? "R16G16B16A16_SFLOAT" : "R32G32B32A32_SFLOAT");
}

void require_attributes(const StoredTexture& texture, const std::string& path) {
  if (kind_of(texture) != ImageKind::exr) return;
  const std::string where = fmt::format("{}: texture {}", path, texture.name);
  require_exr_attributes(texture.info.attributes, where);
  for (const FrameAttribute& change : texture.changes) {
    if (change.attribute.type.empty()) continue;
    require_exr_attributes({change.attribute}, fmt::format("{}, frame {}", where, change.frame));
  }
}

void require_format(const StoredTexture& texture, const std::string& path) {
  const Format format = texture.info.desc.record.format;
  const ImageKind kind = kind_of(texture);
  // DDS headers without DX10 describe some formats by masks.
  if (has_format(kind, format) || find_attribute(texture.info.attributes, kDdsHeader) != nullptr)
    return;
  std::string others;
  for (const Form& form : kForms) {
    if (has_format(form.kind, format))
      others += (others.empty() ? "" : ", ") + std::string(form.ending);
  }
  fail(Exit::bad_input, "{}: texture {} is of format {}, which {} files cannot have; {}", path,
       texture.name, find_format(format)->name, texture.names.extension,
       to_cure(Cure::other_files, others) + float_advice(texture));
}

}  // namespace gicodec::tools

// odd_containers: writes containers that "gicodec encode" does not write to the current folder.
//   probes.gic   a volume of probes
//   unknown.gic  a volume of an unknown kind before one of probes
//   alone.gic    nothing but a volume of an unknown kind
//   many.gic     256 volumes of the same name
//   names.gic    probes whose volume and textures have names that no file can have
#include "dump/error.h"
#include "tools/unknown_volume.h"

#include <gicodec/gicodec.h>

#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace gicodec;
using tools::check;
using tools::take;

const TextureDesc kProbe = probe_texture(Format::R16G16_SFLOAT, {2, 2, 2}, 8);

void add_probes(ContainerDescription& description, const std::string& name,
                const TextureDesc& desc) {
  const NamedTexture texture{"vis", desc, {}, {}};
  check(add_volume(description, name, take(probe_volume({&texture, 1}), name)), name);
}

void add_unknown(ContainerDescription& description) {
  test::add_unknown_volume(description, "skin", 77, {std::byte{1}});
}

/// Three frames of every texture; those of an unknown kind have packets of something.
void write(const std::string& path, const ContainerDescription& description) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) tools::fail(tools::Exit::io, "{}: cannot be opened", path);
  FileSink sink(file);
  auto writer = take(ContainerWriter::create(sink, description), path);
  std::vector<Encoder> encoders;
  for (unsigned frame = 0; frame < 3; ++frame) {
    for (std::size_t id = 0; id < description.textures.size(); ++id) {
      const TextureEntry& entry = description.textures[id];
      const TextureDesc& desc = is_known(entry) ? entry.desc : kProbe;
      EncoderOptions options;
      options.backend = "zstd";
      options.texture_id = static_cast<std::uint8_t>(id);
      if (frame == 0) encoders.push_back(take(Encoder::create(desc, options), entry.name));
      std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(desc)),
                                    std::byte{static_cast<unsigned char>(id % 100 + frame + 1)});
      check(writer.add(frame, take(encoders[id].encode(ConstTextureView(texels)), path)), path);
    }
  }
  check(writer.finish(), path);
  std::fclose(file);
}

}  // namespace

int main() {
  try {
    ContainerDescription probes, unknown, alone, many, names, great;
    add_probes(probes, "room", kProbe);
    write("probes.gic", probes);
    add_unknown(unknown);
    add_probes(unknown, "room", kProbe);
    write("unknown.gic", unknown);
    add_unknown(alone);
    write("alone.gic", alone);
    for (int i = 0; i < 256; ++i) {
      add_probes(many, "same", probe_texture(Format::R16G16_SFLOAT, {1, 1, 1}, 4));
    }
    write("many.gic", many);
    const TextureDesc color = probe_texture(Format::A2B10G10R10_UNORM_PACK32, {2, 2, 2}, 8);
    const NamedTexture odd[] = {{"sky/light,\"\n", color, {}, {}}, {"..", kProbe, {}, {}}};
    check(add_volume(names, "=a,\x1b[2J", take(probe_volume(odd), "names")), "names");
    write("names.gic", names);
    add_probes(great, "hall", probe_texture(Format::R16G16_SFLOAT, {32, 8, 32}, 2));
    write("great.gic", great);
  } catch (const tools::Error& error) {
    std::fprintf(stderr, "odd_containers: %s\n", error.what());
    return static_cast<int>(error.code());
  }
  return 0;
}

// Packs the textures of an engine into a container, from memory, and plays it back. Here they are
// RTXGI's; <gicodec/engines.h> has a function for each engine.
#include <gicodec/engines.h>
#include <gicodec/gicodec.h>

#include <cstdio>
#include <string>
#include <vector>

using namespace gicodec;

/// Where the engine reads its textures back: here bytes that change a little with each frame.
static void render(std::vector<std::byte>& texture, unsigned frame) {
  for (std::size_t i = frame; i < texture.size(); i += 997) texture[i] = std::byte(i + frame);
}

static Status pack(std::FILE* file, unsigned frames,
                   std::vector<std::vector<std::byte>>& textures) {
  const auto volume = rtxgi_volume({16, 4, 16});  // ProbeIrradiance, ProbeDistance, ProbeData
  if (!volume) return volume.status();
  ContainerDescription description;
  Status status = add_volume(description, "room", *volume);
  if (status != Status::ok) return status;

  FileSink sink(file);
  auto writer = ContainerWriter::create(sink, description);
  if (!writer) return writer.status();
  std::vector<Encoder> encoders;
  for (const TextureEntry& texture : description.textures) {
    EncoderOptions options;
    options.texture_id = static_cast<std::uint8_t>(encoders.size());  // its place in the list
    auto encoder = Encoder::create(texture.desc, options);
    if (!encoder) return encoder.status();
    encoders.push_back(*std::move(encoder));
    textures.emplace_back(texture_bytes(texture.desc));
  }

  for (unsigned frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < encoders.size(); ++i) {
      render(textures[i], frame);
      // Of mapped memory the view also has a row pitch and a slice pitch.
      const auto packet = encoders[i].encode(ConstTextureView(textures[i]));
      if (!packet) return packet.status();
      status = writer->add(frame, *packet);
      if (status != Status::ok) return status;
    }
  }
  return writer->finish();
}

/// Plays all frames and compares the last one.
static Result<bool> play(std::FILE* file, const std::vector<std::vector<std::byte>>& expected) {
  FileSource source(file);
  auto player = ContainerPlayer::open(source);
  if (!player) return player.status();
  Status status = Status::ok;
  while (status == Status::ok) status = player->next();
  if (status != Status::end) return status;
  bool equal = player->description().textures.size() == expected.size();
  for (std::uint8_t i = 0; equal && i < expected.size(); ++i) {
    std::vector<std::byte> texture(expected[i].size());
    status = player->read(i, TextureView{texture});
    if (status != Status::ok) return status;
    equal = texture == expected[i];
  }
  return equal;
}

int main(int argc, char** argv) {
  // A temporary file unless one is named.
  std::FILE* const file = argc > 1 ? std::fopen(argv[1], "w+b") : std::tmpfile();
  if (file == nullptr) return 1;
  std::vector<std::vector<std::byte>> textures;
  const Status packed = pack(file, 8, textures);
  const long bytes = std::ftell(file);
  std::rewind(file);
  const Result<bool> equal = packed == Status::ok ? play(file, textures) : Result<bool>(packed);
  std::fclose(file);
  if (!equal) {
    std::printf("%s\n", to_string(equal.status()).data());
    return 1;
  }
  std::printf("8 frames, %ld bytes, texels %s\n", bytes, *equal ? "equal" : "DIFFER");
  return *equal ? 0 : 1;
}

// Streams all textures of a volume, here batches of photons, from an encoder to a decoder.
#include <gicodec/gicodec.h>
#include <gicodec/photons.h>

#include <cstdio>
#include <iterator>
#include <vector>

int main() {
  using namespace gicodec;
  // 8 batches of up to 64 photons: how many there are of each, where they lie, and the photons.
  constexpr std::size_t kCounts = 0, kBatches = 1, kLight = 2, kCapacity = 64;
  const auto volume = photon_volume(8, kCapacity);
  if (!volume) return 1;
  auto encoder = VolumeEncoder::create(*volume);
  auto decoder = VolumeDecoder::create(*volume);
  if (!encoder || !decoder) return 1;
  // The same packets also go into a container.
  std::FILE* const file = std::tmpfile();
  ContainerDescription description;
  if (file == nullptr || add_volume(description, "batches", *volume) != Status::ok) return 1;
  FileSink sink(file);
  auto container = ContainerWriter::create(sink, description);
  if (!container) return 1;
  std::vector<std::byte> server[3], client[3];
  for (std::size_t t = 0; t < 3; ++t) {
    server[t].resize(texture_bytes(volume->groups[0].textures[t].desc));
    client[t].resize(server[t].size());
  }

  for (unsigned update = 0; update < 3; ++update) {
    // A batch is traced anew. The counts say which of its photons exist.
    const std::size_t count = 20 + update;
    const auto out = std::span(server[kLight]).subspan(update * kCapacity * kPhotonBytes);
    server[kCounts][2 * update] = std::byte(count);
    pack_photon_batch(
        {},
        std::span(server[kBatches]).subspan(update * kPhotonBatchBytes).first<kPhotonBatchBytes>());
    for (std::size_t i = 0; i < count * kPhotonBytes; ++i) out[i] = std::byte(i * (update + 3));

    const std::vector<ConstTextureView> views(std::begin(server), std::end(server));
    const auto packets = encoder->encode(views);  // Finds what changed; one packet a texture.
    if (!packets) return 1;
    Status status = decoder->decode(*packets);
    for (const Packet& packet : *packets) {
      if (status == Status::ok) status = container->add(update, packet);
    }
    for (std::uint8_t t = 0; t < 3 && status == Status::ok; ++t) {
      status = decoder->read(t, TextureView{client[t]}, decoder->changed(t));
    }
    if (status != Status::ok) {
      std::printf("update %u: %s\n", update, to_string(status).data());
      return 1;
    }
    std::printf("update %u: %zu batches, %zu bytes of photons, %s\n", update,
                decoder->changed(kLight).size(), (*packets)[kLight].size(),
                client[kLight] == server[kLight] ? "equal" : "DIFFERENT");
  }
  if (container->finish() != Status::ok) return 1;
  std::fclose(file);
  return client[kCounts] == server[kCounts] && client[kLight] == server[kLight] ? 0 : 1;
}

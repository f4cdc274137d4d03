#include "container_support.h"

#include "base/bytes.h"
#include "base/checksum.h"

namespace gicodec::test {

Sample make_sample(std::uint64_t seed, std::uint32_t frames, std::uint32_t gop) {
  Random random(seed);
  Sample sample;
  sample.description.textures = {
      {"color",
       {Format::A2B10G10R10_UNORM_PACK32, {2, 1, 2}, 2, 1, Tiling::atlas_xy_z},
       {{"role", "irradiance"}}},
      {"visibility", {Format::R16G16_SFLOAT, {2, 1, 2}, 3, 1, Tiling::slices_xz_y}, {}}};
  sample.description.metadata = {{"writer", "test"}, {"", ""}, {"writer", "again"}};
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, sample.description);

  std::vector<std::unique_ptr<Texture>> textures;
  std::vector<Encoder> encoders;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& desc = sample.description.textures[i].desc;
    textures.push_back(std::make_unique<Texture>(desc));
    EncoderOptions options;
    options.backend = i == 0 ? "lz4" : "zstd";
    options.gop = gop;
    options.texture_id = static_cast<std::uint8_t>(i);
    encoders.push_back(*Encoder::create(desc, options));
  }
  std::uint64_t frame = 0;
  for (std::uint32_t step = 0; step < frames; ++step) {
    frame += step == 0 ? 0 : pick(random, 1, 3);
    for (std::size_t i = 0; i < 2; ++i) {
      if (i == 1 && step % 3 == 1) continue;  // This texture has no packet in this frame.
      auto& texture = *textures[i];
      for (const auto probe : random_selection(random, probe_count(texture.desc()))) {
        texture.fill_core(probe, Fill::small, random);
        if (!chance(random, 4)) texture.fill_border(probe);
      }
      const auto packet = *encoders[i].encode(std::as_const(texture).view());
      const auto status = writer.add(frame, packet);
      if (status != Status::ok) return {};
      sample.packets.push_back(
          {frame, static_cast<std::uint8_t>(i), peek(packet)->keyframe, packet});
      sample.ends.push_back(writer.bytes_written());
    }
    sample.frames[frame] = {contents(encoders[0]), contents(encoders[1])};
  }
  sample.index_offset = writer.bytes_written();
  if (writer.finish() != Status::ok || writer.bytes_written() != sink.bytes.size()) return {};
  sample.bytes = std::move(sink.bytes);
  return sample;
}

Bytes record(std::uint8_t type, std::span<const std::byte> body) {
  Bytes out;
  ByteWriter writer(out);
  writer.fixed(type);
  writer.varint(body.size());
  writer.bytes(body);
  writer.fixed(checksum(out));
  return out;
}

Player::Player(const ContainerDescription& description) {
  for (const auto& texture : description.textures) {
    decoders_.push_back(*Decoder::create(texture.desc));
  }
}

Status Player::play(ContainerReader& reader, std::uint64_t last_frame, bool skip) {
  for (;;) {
    ContainerPacket packet;
    const Status more = reader.next(packet);
    if (more != Status::ok && more != Status::end) return more;
    if (more == Status::end || packet.frame > last_frame) return Status::ok;
    const Status status = decoders_.at(packet.texture_id).decode(packet.bytes);
    if (status != Status::ok && !(skip && status == Status::reference_missing)) return status;
    ++packets;
  }
}

std::vector<Bytes> Player::contents() const {
  std::vector<Bytes> all;
  for (const auto& decoder : decoders_) all.push_back(test::contents(decoder));
  return all;
}

}  // namespace gicodec::test

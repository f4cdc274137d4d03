// Streams a probe texture from an encoder to a decoder and compares the texels.
#include <gicodec/gicodec.h>

#include <cstdio>
#include <vector>

int main() {
  using namespace gicodec;
  // 16×8×16 probes of 8×8 texels with a guard band, as one 2D atlas.
  const auto desc = ddgi_irradiance({16, 8, 16}, Format::A2B10G10R10_UNORM_PACK32);
  std::vector<std::byte> server(texture_bytes(desc)), client(texture_bytes(desc));

  auto encoder = Encoder::create(desc);
  auto decoder = Decoder::create(desc);
  if (!encoder || !decoder) return 1;

  for (unsigned frame = 0; frame < 3; ++frame) {
    // The renderer updates some texels; a view of mapped GPU memory would have a row pitch.
    for (std::size_t i = frame; i < server.size(); i += 4001) server[i] = std::byte(i + frame);

    const auto packet = encoder->encode(ConstTextureView(server));  // Finds what changed.
    if (!packet) return 1;
    const Status status = decoder->decode(*packet, TextureView{client});
    if (status != Status::ok) {
      std::printf("frame %u: %s\n", frame, to_string(status).data());
      return 1;
    }
    std::printf("frame %u: %zu bytes, %zu probes, texels %s\n", frame, packet->size(),
                decoder->changed().size(), client == server ? "equal" : "DIFFER");
  }
  return client == server ? 0 : 1;
}

// The C interface in C99: packets of one texture, a server and a client of a volume, and a
// container in memory. Each compares the texels.
#include <gicodec/c/gicodec.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 3 };

#define TRY(call)                                                                       \
  do {                                                                                  \
    const gicodec_status status_ = (call);                                              \
    if (status_ != GICODEC_OK) {                                                        \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, gicodec_status_text(status_)); \
      return 0;                                                                         \
    }                                                                                   \
  } while (0)

/// A texture in memory, as a renderer has it.
typedef struct {
  gicodec_texture_desc desc;
  unsigned char* bytes;
  size_t size;
} texture;

static int make_texture(texture* out, const gicodec_texture_desc* desc) {
  gicodec_texture_info info = {.struct_size = sizeof info};
  out->desc = *desc;
  TRY(gicodec_texture_desc_info(desc, &info));
  out->size = (size_t)info.texture_bytes;
  out->bytes = calloc(1, out->size);
  return out->bytes != NULL;
}

static gicodec_view view_of(const texture* t) {
  const gicodec_view view = {.struct_size = sizeof view, .bytes = t->bytes, .size = t->size};
  return view;
}

static gicodec_const_view const_view_of(const texture* t) {
  const gicodec_const_view view = {.struct_size = sizeof view, .bytes = t->bytes, .size = t->size};
  return view;
}

/// The renderer updates some texels.
static void paint(texture* t, unsigned frame) {
  for (size_t i = frame; i < t->size; i += 4001) t->bytes[i] = (unsigned char)(i + frame);
}

static int same(const texture* a, const texture* b) {
  return a->size == b->size && memcmp(a->bytes, b->bytes, a->size) == 0;
}

/// An encoder and a decoder of one texture.
static int packets(texture* ours, texture* theirs) {
  gicodec_encoder* encoder = NULL;
  gicodec_decoder* decoder = NULL;
  TRY(gicodec_encoder_create(&ours->desc, NULL, &encoder));
  TRY(gicodec_decoder_create(&ours->desc, NULL, &decoder));
  const size_t bound = gicodec_encoder_bound(encoder, SIZE_MAX);
  void* packet = malloc(bound);
  int good = packet != NULL;
  for (unsigned frame = 0; good && frame < FRAMES; ++frame) {
    paint(ours, frame);
    const gicodec_const_view from = const_view_of(ours);
    const gicodec_view to = view_of(theirs);
    size_t size = 0, changed = 0;
    TRY(gicodec_encoder_encode(encoder, &from, GICODEC_SELECT_CHANGED, NULL, 0, packet, bound,
                               &size));
    TRY(gicodec_decoder_decode(decoder, packet, size, &to));
    (void)gicodec_decoder_changed(decoder, &changed);
    good = same(ours, theirs);
    printf("packet %u: %lu bytes, %lu probes, texels %s\n", frame, (unsigned long)size,
           (unsigned long)changed, good ? "equal" : "DIFFER");
  }
  free(packet);
  gicodec_decoder_destroy(decoder);
  gicodec_encoder_destroy(encoder);
  return good;
}

/// A server and a client, whose messages this program carries itself.
static int streaming(const gicodec_volume_desc* volume, texture* ours) {
  gicodec_geometry geometry = {.struct_size = sizeof geometry, .spacing = {1, 1, 1}};
  gicodec_server* server = NULL;
  gicodec_client* client = NULL;
  uint32_t id = 0, connection = 0;
  memcpy(geometry.grid, ours->desc.grid, sizeof geometry.grid);
  TRY(gicodec_server_create(NULL, &server));
  TRY(gicodec_server_add_volume(server, "room", volume, &geometry, NULL, 0, &id));
  TRY(gicodec_client_create(NULL, &client));
  TRY(gicodec_server_connect(server, 0, NULL, &connection));
  TRY(gicodec_client_hello(client));

  // A client learns a volume in steps: the first updates are small.
  int good = 0;
  for (unsigned tick = 1; tick <= 40 && !good; ++tick) {
    const double now = tick / 30.0;
    const uint8_t* message = NULL;
    size_t size = 0;
    while ((message = gicodec_client_message(client, &size)) != NULL) {
      TRY(gicodec_server_receive(server, connection, message, size, now));
    }
    const gicodec_const_view view = const_view_of(ours);
    TRY(gicodec_server_publish(server, id, 0, &view, NULL, 0));
    TRY(gicodec_server_update(server, now, now));
    while ((message = gicodec_server_message(server, connection, &size)) != NULL) {
      TRY(gicodec_client_receive(client, message, size));
    }
    const uint8_t* texels = gicodec_client_texels(client, id, 0, &size);
    good = texels != NULL && size == ours->size && memcmp(texels, ours->bytes, size) == 0;
    if (good) printf("client: texels equal after %u updates\n", tick);
  }
  gicodec_client_destroy(client);
  gicodec_server_destroy(server);
  return good;
}

/// A container in memory, written and played.
static int container(const gicodec_volume_desc* volume, texture* ours, texture* theirs) {
  gicodec_container* description = NULL;
  gicodec_volume_encoder* encoder = NULL;
  gicodec_writer* writer = NULL;
  gicodec_player* player = NULL;
  TRY(gicodec_container_create(&description));
  TRY(gicodec_container_add_volume(description, "room", volume));
  TRY(gicodec_writer_create(NULL, description, &writer));
  TRY(gicodec_volume_encoder_create(volume, NULL, &encoder));
  for (unsigned frame = 0; frame < FRAMES; ++frame) {
    paint(ours, frame);
    const gicodec_const_view view = const_view_of(ours);
    TRY(gicodec_volume_encoder_encode(encoder, &view, 1, GICODEC_SELECT_CHANGED, NULL, 0));
    for (uint32_t i = 0; i < gicodec_volume_encoder_packets(encoder); ++i) {
      size_t size = 0;
      const uint8_t* packet = gicodec_volume_encoder_packet(encoder, i, &size);
      TRY(gicodec_writer_add(writer, frame, packet, size));
    }
  }
  TRY(gicodec_writer_finish(writer));

  size_t size = 0;
  const uint8_t* bytes = gicodec_writer_bytes(writer, &size);
  const gicodec_view view = view_of(theirs);
  TRY(gicodec_player_open_memory(bytes, size, NULL, &player));
  TRY(gicodec_player_seek(player, FRAMES - 1));
  TRY(gicodec_player_next(player));
  TRY(gicodec_player_read(player, 0, &view));
  const int good = same(ours, theirs);
  printf("container: %lu bytes, last frame %s\n", (unsigned long)size, good ? "equal" : "DIFFERS");
  gicodec_player_destroy(player);
  gicodec_volume_encoder_destroy(encoder);
  gicodec_writer_destroy(writer);
  gicodec_container_destroy(description);
  return good;
}

int main(void) {
  // 16×8×16 probes of 8×8 texels with a guard band, as one 2D atlas.
  gicodec_texture_desc desc = {.struct_size = sizeof desc};
  gicodec_volume_desc* volume = NULL;
  texture ours, theirs;
  const uint32_t format = gicodec_format_from_name("A2B10G10R10_UNORM_PACK32");
  if (gicodec_ddgi_irradiance(16, 8, 16, format, &desc) != GICODEC_OK ||
      !make_texture(&ours, &desc) || !make_texture(&theirs, &desc) ||
      gicodec_volume_desc_create(1, &volume) != GICODEC_OK ||
      gicodec_volume_desc_add_texture(volume, "color", &desc) != GICODEC_OK) {
    return 1;
  }
  const int good =
      packets(&ours, &theirs) && streaming(volume, &ours) && container(volume, &ours, &theirs);
  gicodec_volume_desc_destroy(volume);
  free(ours.bytes);
  free(theirs.bytes);
  return good ? 0 : 1;
}

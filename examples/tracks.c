// Shared streams for receivers that the publisher does not know, in C99: a publisher, a store that
// keeps what a message broker would keep, and a viewer that comes late. In place of the store an
// engine has its broker: subjects, the last message of each, and those of the last seconds.
#include <gicodec/c/gicodec.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { UPDATES = 30, KEPT = 4096 };

#define TRY(call)                                                                       \
  do {                                                                                  \
    const gicodec_status status_ = (call);                                              \
    if (status_ != GICODEC_OK) {                                                        \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, gicodec_status_text(status_)); \
      return 0;                                                                         \
    }                                                                                   \
  } while (0)

/// The last message of each type, track and number.
typedef struct {
  gicodec_track_message messages[KEPT];  ///< with bytes of their own
  size_t count;
} store;

static gicodec_track_message* find(store* in, uint32_t type, const gicodec_track* track,
                                   uint32_t number) {
  for (size_t i = 0; i < in->count; ++i) {
    gicodec_track_message* m = &in->messages[i];
    if (m->type == type && m->number == number && memcmp(&m->track, track, sizeof *track) == 0)
      return m;
  }
  return NULL;
}

static int keep(store* in, const gicodec_track_message* message) {
  gicodec_track_message* place = find(in, message->type, &message->track, message->number);
  uint8_t* bytes = malloc(message->size);
  if (place == NULL && in->count < KEPT) {
    place = &in->messages[in->count++];
    place->bytes = NULL;
  }
  if (place == NULL || bytes == NULL) {
    free(bytes);
    return 0;
  }
  free((void*)place->bytes);
  *place = *message;
  place->bytes = memcpy(bytes, message->bytes, message->size);
  return 1;
}

/// What the receiver asks for; false if the store fails. What the store lacks is asked for again.
static int fetch(store* from, gicodec_track_receiver* receiver) {
  static const gicodec_track none = {0, 0, 0};
  const gicodec_track_object* objects = NULL;
  uint32_t list = 0;
  size_t count = 0;
  TRY(gicodec_track_receiver_requests(receiver, &list, &objects, &count));
  static const uint32_t last[] = {GICODEC_TRACKS_LIST, GICODEC_TRACKS_TICK};
  for (size_t i = 0; list != 0 && i < 2; ++i) {
    const gicodec_track_message* m = find(from, last[i], &none, 0);
    if (m != NULL) TRY(gicodec_track_receiver_receive(receiver, m->bytes, m->size));
  }
  for (size_t i = 0; i < count; ++i) {
    const gicodec_track_message* m =
        find(from, GICODEC_TRACKS_OBJECT, &objects[i].track, objects[i].number);
    if (m != NULL) TRY(gicodec_track_receiver_receive(receiver, m->bytes, m->size));
  }
  return 1;
}

/// Messages between the receiver and its client, both ways.
static int carry(gicodec_track_receiver* receiver, gicodec_client* client) {
  const uint8_t* message = NULL;
  size_t size = 0;
  while ((message = gicodec_track_receiver_message(receiver, &size)) != NULL)
    TRY(gicodec_client_receive(client, message, size));
  while ((message = gicodec_client_message(client, &size)) != NULL)
    TRY(gicodec_track_receiver_take(receiver, message, size));
  return 1;
}

/// Updates of a scene, in which some texels change.
static int publish(gicodec_server* server, gicodec_track_publisher* publisher, uint32_t volume,
                   uint8_t* texels, size_t size, store* to) {
  size_t published = 0;
  for (unsigned update = 0; update < UPDATES; ++update) {
    for (size_t i = update; i < size; i += 4001) texels[i] = (uint8_t)(i + update);
    const gicodec_const_view view = {.struct_size = sizeof view, .bytes = texels, .size = size};
    TRY(gicodec_server_publish(server, volume, 0, &view, NULL, 0));
    TRY(gicodec_track_publisher_update(publisher, update / 10.0, update / 10.0));
    gicodec_track_message message = {.struct_size = sizeof message};
    while (gicodec_track_publisher_message(publisher, &message) == GICODEC_OK) {
      if (!keep(to, &message)) return 0;
      published += message.size;
    }
  }
  printf("published %u updates in %lu bytes; kept %lu messages\n", UPDATES,
         (unsigned long)published, (unsigned long)to->count);
  return 1;
}

/// A viewer that knows nothing but the store.
static int view_late(gicodec_client* client, gicodec_track_receiver* receiver, store* from,
                     const uint8_t* texels, size_t size) {
  gicodec_track_receiver_state state = {.struct_size = sizeof state};
  unsigned trips = 0;
  TRY(gicodec_client_hello(client));
  if (!carry(receiver, client)) return 0;
  // The list, then snapshots and the updates behind them: a trip to the store each.
  while (!state.complete && trips < 8) {
    ++trips;
    if (!fetch(from, receiver) || !carry(receiver, client)) return 0;
    TRY(gicodec_track_receiver_get_state(receiver, &state));
  }
  size_t seen = 0;
  const uint8_t* shown = gicodec_client_texels(client, 0, 0, &seen);
  const int good = shown != NULL && seen == size && memcmp(shown, texels, size) == 0;
  printf("a late viewer asked for %lu objects in %u trips: texels %s\n",
         (unsigned long)state.requests, trips, good ? "equal" : "DIFFER");
  return good;
}

int main(void) {
  static store kept;
  gicodec_texture_desc desc = {.struct_size = sizeof desc};
  gicodec_texture_info info = {.struct_size = sizeof info};
  gicodec_geometry geometry = {.struct_size = sizeof geometry, .spacing = {1, 1, 1}};
  // Regions of 8×8×8 probes are tracks; an epoch is above those of publishers before.
  gicodec_server_options serving = {.struct_size = sizeof serving, .region = {8, 8, 8}, .epoch = 1};
  gicodec_client_options viewing = {.struct_size = sizeof viewing,
                                    .delivery = GICODEC_DELIVERY_SHARED};
  gicodec_volume_desc* volume = NULL;
  gicodec_server* server = NULL;
  gicodec_track_publisher* publisher = NULL;
  gicodec_client* client = NULL;
  gicodec_track_receiver* receiver = NULL;
  uint8_t* texels = NULL;
  uint32_t id = 0;
  const uint32_t format = gicodec_format_from_name("A2B10G10R10_UNORM_PACK32");
  int good = gicodec_ddgi_irradiance(16, 8, 16, format, &desc) == GICODEC_OK &&
             gicodec_texture_desc_info(&desc, &info) == GICODEC_OK &&
             (texels = calloc(1, (size_t)info.texture_bytes)) != NULL &&
             gicodec_volume_desc_create(1, &volume) == GICODEC_OK &&
             gicodec_volume_desc_add_texture(volume, "color", &desc) == GICODEC_OK;
  memcpy(geometry.grid, desc.grid, sizeof geometry.grid);
  good = good && gicodec_server_create(&serving, &server) == GICODEC_OK &&
         gicodec_track_publisher_create(server, NULL, &publisher) == GICODEC_OK &&
         gicodec_server_add_volume(server, "room", volume, &geometry, NULL, 0, &id) == GICODEC_OK &&
         publish(server, publisher, id, texels, (size_t)info.texture_bytes, &kept);
  good = good && gicodec_client_create(&viewing, &client) == GICODEC_OK &&
         gicodec_track_receiver_create(NULL, &receiver) == GICODEC_OK &&
         view_late(client, receiver, &kept, texels, (size_t)info.texture_bytes);

  gicodec_track_receiver_destroy(receiver);
  gicodec_client_destroy(client);
  gicodec_track_publisher_destroy(publisher);
  gicodec_server_destroy(server);
  gicodec_volume_desc_destroy(volume);
  for (size_t i = 0; i < kept.count; ++i) free((void*)kept.messages[i].bytes);
  free(texels);
  return good ? 0 : 1;
}

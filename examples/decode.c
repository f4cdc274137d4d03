// Decodes a container with the C interface and prints a hash of each texture in each frame:
//   decode FILE.gic
// It needs nothing but the decoder: it links a library that was built with GICODEC_DECODE_ONLY, too.
#include <gicodec/c/container.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static gicodec_status read_file(void *self, void *into, size_t bytes, size_t *got) {
  *got = fread(into, 1, bytes, self);
  return ferror((FILE *)self) != 0 ? GICODEC_IO_FAILED : GICODEC_OK;
}

static gicodec_status seek_file(void *self, uint64_t offset) {
  return fseek(self, (long)offset, SEEK_SET) == 0 ? GICODEC_OK : GICODEC_IO_FAILED;
}

static uint64_t size_of_file(void *self) {
  const long here = ftell(self);
  if (here < 0 || fseek(self, 0, SEEK_END) != 0) return 0;
  const long size = ftell(self);
  return size < 0 || fseek(self, here, SEEK_SET) != 0 ? 0 : (uint64_t)size;
}

/// FNV-1a of 64 bits.
static uint64_t hash_of(const unsigned char *bytes, size_t size) {
  uint64_t hash = 0xcbf29ce484222325U;
  for (size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3U;
  return hash;
}

/// Prints the hash of a texture as of the player's frame.
static gicodec_status print_texture(const gicodec_player *player, uint32_t texture) {
  const gicodec_container *container = gicodec_player_container(player);
  gicodec_texture_desc desc = {.struct_size = sizeof desc};
  gicodec_texture_info info = {.struct_size = sizeof info};
  gicodec_view view = {.struct_size = sizeof view};
  gicodec_status status = gicodec_container_texture(container, texture, &desc, NULL);
  if (status == GICODEC_OK) status = gicodec_texture_desc_info(&desc, &info);
  if (status != GICODEC_OK) return status;
  view.size = (size_t)info.texture_bytes;
  view.bytes = calloc(1, view.size);
  if (view.bytes == NULL) return GICODEC_OUT_OF_MEMORY;
  status = gicodec_player_read(player, texture, &view);
  if (status == GICODEC_OK) {
    printf("frame %" PRIu64 ", %s: %016" PRIx64 "\n", gicodec_player_frame(player),
           gicodec_container_texture_name(container, texture), hash_of(view.bytes, view.size));
  }
  free(view.bytes);
  return status;
}

int main(int argc, char **argv) {
  FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (file == NULL) {
    fprintf(stderr, "usage: decode FILE.gic\n");
    return 2;
  }
  const gicodec_source source = {.struct_size = sizeof source,
                                 .self = file,
                                 .read = read_file,
                                 .seek = seek_file,
                                 .size = size_of_file};
  gicodec_player *player = NULL;
  gicodec_status status = gicodec_player_open(&source, NULL, &player);
  while (status == GICODEC_OK && (status = gicodec_player_next(player)) == GICODEC_OK) {
    const uint32_t textures = gicodec_container_textures(gicodec_player_container(player));
    for (uint32_t t = 0; t < textures && status == GICODEC_OK; ++t) {
      status = print_texture(player, t);
    }
  }
  if (status != GICODEC_END) fprintf(stderr, "%s: %s\n", argv[1], gicodec_status_text(status));
  gicodec_player_destroy(player);
  fclose(file);
  return status == GICODEC_END ? 0 : 1;
}

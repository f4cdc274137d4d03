// Speed of decoding containers on one thread by an instruction set, in MB of texels per second, the
// best of some plays of each file:
//   decode_speeds SET PLAYS FILE.gic...
// script/wasm-speed compares it with what browsers and Node make of the same files.
#define _POSIX_C_SOURCE 199309L
#include <gicodec/c/container.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/// MB of all textures per frame.
static double megabytes(const gicodec_container *container) {
  double sum = 0;
  for (uint32_t t = 0; t < gicodec_container_textures(container); ++t) {
    gicodec_texture_desc desc = {.struct_size = sizeof desc};
    gicodec_texture_info info = {.struct_size = sizeof info};
    if (gicodec_container_texture(container, t, &desc, NULL) == GICODEC_OK &&
        gicodec_texture_desc_info(&desc, &info) == GICODEC_OK) {
      sum += 1e-6 * (double)info.texture_bytes;
    }
  }
  return sum;
}

/// MB per second of one play; negative if it fails.
static double play(const void *bytes, size_t size, const char *isa) {
  const gicodec_host host = {.struct_size = sizeof host, .isa = isa};
  const gicodec_player_options options = {.struct_size = sizeof options, .host = &host};
  gicodec_player *player = NULL;
  gicodec_status status = gicodec_player_open_memory(bytes, size, &options, &player);
  double frames = 0;
  const double start = now();
  while (status == GICODEC_OK && (status = gicodec_player_next(player)) == GICODEC_OK) ++frames;
  const double seconds = now() - start;
  const double speed = frames * megabytes(gicodec_player_container(player)) / seconds;
  gicodec_player_destroy(player);
  return status == GICODEC_END ? speed : -1;
}

int main(int argc, char **argv) {
  for (int i = 3; i < argc; ++i) {
    FILE *const file = fopen(argv[i], "rb");
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) return perror(argv[i]), 1;
    const size_t size = (size_t)ftell(file);
    void *const bytes = malloc(size);
    rewind(file);
    if (bytes == NULL || fread(bytes, 1, size, file) != size) return perror(argv[i]), 1;
    double best = 0;
    for (int n = 0; n < atoi(argv[2]); ++n) {
      const double speed = play(bytes, size, argv[1]);
      if (speed < 0) return fprintf(stderr, "%s: cannot be played\n", argv[i]), 1;
      if (speed > best) best = speed;
    }
    printf("%s %s %.1f\n", argv[1], argv[i], best);
    free(bytes);
    fclose(file);
  }
  return 0;
}

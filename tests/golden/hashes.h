// What each language makes of a golden container, as lines of hashes.txt: file, frame, texture and
// a hash of its texels, guard bands included; at last how it ends: file, "ends", status.
#pragma once

#include <gicodec/container.h>
#include <gicodec/player.h>

#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace gicodec::golden {

/// FNV-1a of 64 bits, in hexadecimal.
[[nodiscard]] inline std::string hash_of(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const std::byte byte : bytes) hash = (hash ^ std::uint64_t(byte)) * 0x100000001b3U;
  char text[17];
  (void)std::snprintf(text, sizeof text, "%016" PRIx64, hash);
  return text;
}

[[nodiscard]] inline std::string line_of(const std::string& file, std::uint64_t frame,
                                         std::size_t texture, std::span<const std::byte> texels) {
  return file + ' ' + std::to_string(frame) + ' ' + std::to_string(texture) + ' ' +
         hash_of(texels) + '\n';
}
[[nodiscard]] inline std::string end_of(const std::string& file, int status) {
  return file + " ends " + std::to_string(status) + '\n';
}

/// The lines of a file, by the C++ interface.
[[nodiscard]] inline std::string lines_of(const std::string& file,
                                          std::span<const std::byte> bytes) {
  MemorySource source(bytes);
  auto player = ContainerPlayer::open(source);
  if (!player) return end_of(file, static_cast<int>(player.status()));
  std::string lines;
  for (;;) {
    const Status status = player->next();
    if (status != Status::ok) return lines + end_of(file, static_cast<int>(status));
    const auto& textures = player->description().textures;
    for (std::size_t i = 0; i < textures.size(); ++i) {
      if (!is_known(textures[i])) continue;
      std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(textures[i].desc)));
      const Status read = player->read(static_cast<std::uint8_t>(i), TextureView{texels});
      lines += read == Status::ok ? line_of(file, player->frame(), i, texels)
                                  : end_of(file, static_cast<int>(read));
    }
  }
}

}  // namespace gicodec::golden

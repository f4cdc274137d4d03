// The C interface makes of golden containers what the C++ interface does: the lines of hashes.txt.
#include "c_support.h"
#include "golden/hashes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <utility>

namespace gicodec::test {
namespace {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string lines_of(const std::string& name, const std::string& bytes) {
  gicodec_player* opened = nullptr;
  gicodec_status status = gicodec_player_open_memory(bytes.data(), bytes.size(), nullptr, &opened);
  const OwnedPlayer player(opened);
  std::string lines;
  while (status == GICODEC_OK && (status = gicodec_player_next(opened)) == GICODEC_OK) {
    const gicodec_container* const container = gicodec_player_container(opened);
    for (std::uint32_t t = 0; t < gicodec_container_textures(container); ++t) {
      auto desc = sized<gicodec_texture_desc>();
      auto info = sized<gicodec_texture_info>();
      if (gicodec_container_texture(container, t, &desc, nullptr) == GICODEC_UNKNOWN_KIND) continue;
      EXPECT_EQ(gicodec_texture_desc_info(&desc, &info), GICODEC_OK) << name;
      std::vector<std::byte> texels(info.texture_bytes);
      auto view = sized<gicodec_view>();
      view.bytes = texels.data();
      view.size = texels.size();
      const gicodec_status read = gicodec_player_read(opened, t, &view);
      lines += read == GICODEC_OK ? golden::line_of(name, gicodec_player_frame(opened), t, texels)
                                  : golden::end_of(name, read);
    }
  }
  return lines + golden::end_of(name, status);
}

TEST(CGolden, ContainersHaveTheirHashes) {
  const std::filesystem::path folder = GICODEC_GOLDEN_DIR;
  const std::string expected = read_file(folder / "hashes.txt");
  std::size_t containers = 0;
  for (std::size_t at = 0; at < expected.size(); ++containers) {
    const std::string name = expected.substr(at, expected.find(' ', at) - at);
    const std::string found = lines_of(name, read_file(folder / name));
    ASSERT_EQ(found, expected.substr(at, found.size()));
    at += found.size();
  }
  EXPECT_GT(containers, 40U);
}

/// The updates of a recorded session, of which the server's messages are given to a client.
std::string session_lines(const std::string& name, const std::string& bytes) {
  auto options = sized<gicodec_client_options>();
  options.delivery =
      name.starts_with("unicast") ? GICODEC_DELIVERY_UNICAST : GICODEC_DELIVERY_SHARED;
  options.token = "token";
  const auto client =
      made<OwnedClient>([&](auto out) { return gicodec_client_create(&options, out); });
  EXPECT_EQ(gicodec_client_hello(client.get()), GICODEC_OK);
  std::string lines;
  std::uint64_t serial = 0;
  gicodec_status status = GICODEC_OK;
  for (std::size_t at = 0; at < bytes.size();) {
    const bool from_server = bytes[at] == 1;
    std::uint32_t size = 0;
    std::memcpy(&size, &bytes[at + 1], sizeof size);
    const char* const message = &bytes[at + 5];
    at += 5 + size;
    if (!from_server) continue;
    EXPECT_EQ(status, GICODEC_OK) << name;
    status = gicodec_client_receive(client.get(), message, size);
    auto state = sized<gicodec_client_state>();
    EXPECT_EQ(gicodec_client_get_state(client.get(), &state), GICODEC_OK);
    if (std::exchange(serial, state.serial) == state.serial) continue;
    std::uint32_t volume = 0;
    EXPECT_EQ(gicodec_client_volume(client.get(), 0, &volume, nullptr), GICODEC_OK);
    for (std::uint32_t t = 0; t < 2; ++t) {
      std::size_t texels_size = 0;
      const auto* const texels = gicodec_client_texels(client.get(), volume, t, &texels_size);
      lines +=
          golden::line_of(name, state.update, t, std::as_bytes(std::span(texels, texels_size)));
    }
  }
  EXPECT_EQ(status, GICODEC_END) << name;
  return lines;
}

TEST(CGolden, SessionsHaveTheirHashes) {
  const std::filesystem::path folder = GICODEC_SESSION_DIR;
  std::string lines;
  for (const char* name : {"shared_native.session", "shared_zstd.session", "unicast_native.session",
                           "unicast_raw.session"}) {
    lines += session_lines(name, read_file(folder / name));
  }
  EXPECT_EQ(lines, read_file(folder / "hashes.txt"));
}

TEST(CGolden, UnknownVersionsAreNamed) {
  const auto head = read_file(std::filesystem::path(GICODEC_GOLDEN_DIR) / "bad_major.gic");
  gicodec_player* player = nullptr;
  EXPECT_EQ(gicodec_player_open_memory(head.data(), head.size(), nullptr, &player),
            GICODEC_UNSUPPORTED_VERSION);
  std::uint32_t major = 0, minor = 99, readable = 0;
  ASSERT_EQ(gicodec_container_version(head.data(), 10, &major, &minor, &readable), GICODEC_OK);
  EXPECT_EQ(major, 3U);
  EXPECT_EQ(minor, 0U);
  EXPECT_EQ(readable, 1U);
  EXPECT_EQ(gicodec_container_version(head.data(), 9, &major, &minor, &readable),
            GICODEC_TRUNCATED);
  EXPECT_EQ(gicodec_container_version("\x89GIX", 4, &major, &minor, &readable),
            GICODEC_NOT_GICODEC);
}

}  // namespace
}  // namespace gicodec::test

// Recorded sessions: what a client made of them once it must make of them for ever.
#include "golden/hashes.h"
#include "session/golden/session_golden.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <set>

namespace gicodec {
namespace {

using namespace golden;
using namespace test;

/// The lines of hashes.txt about a session, as C, Python and JavaScript make them, too.
std::string expected_lines(const std::string& name) {
  std::ifstream file(std::string(GICODEC_SESSION_DIR) + "/hashes.txt");
  std::string lines;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(name + ' ')) lines += line + '\n';
  }
  return lines;
}

std::vector<Recorded> load(const std::string& name) {
  std::ifstream file(std::string(GICODEC_SESSION_DIR) + "/" + name, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_FALSE(bytes.empty()) << name;
  std::vector<Recorded> recorded;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + at + 1, sizeof size);
    const auto message = std::as_bytes(std::span(bytes)).subspan(at + 5, size);
    recorded.push_back({bytes[at] == 1, Message(message.begin(), message.end())});
    at += 5 + size;
  }
  return recorded;
}

class GoldenSession : public testing::TestWithParam<const char*> {};

TEST_P(GoldenSession, GivesTheTextures) {
  const std::string name = GetParam();
  ClientOptions options;
  options.delivery = name.starts_with("unicast") ? Delivery::unicast : Delivery::shared;
  options.token = "token";
  auto client = Client::create(options);
  ASSERT_TRUE(client.ok());
  ASSERT_TRUE(client->hello().ok());
  std::set<std::size_t> types;
  Status last = Status::ok;
  bool intra = false, snapshot = false;
  std::string lines;
  for (const Recorded& recorded : load(name)) {
    const auto message = read_message(recorded.message);
    ASSERT_TRUE(message.ok());
    types.insert(message->index());
    Message again;
    ASSERT_EQ(write_message(*message, again), Status::ok);
    EXPECT_EQ(again, recorded.message);
    if (!recorded.from_server) continue;
    ASSERT_EQ(last, Status::ok);
    last = client->receive(recorded.message);
    if (const auto* update = std::get_if<UpdateMessage>(&*message)) {
      for (const auto& part : update->parts) {
        intra = intra || is_intra(peek(part.packet)->type);
        snapshot = snapshot || peek(part.packet)->type == PacketType::snapshot;
      }
      ASSERT_TRUE(client->consistent());
      EXPECT_EQ(client->frame().time, static_cast<double>(update->update) * 0.5);
      for (std::size_t i = 0; i < 2; ++i) {
        Texture expected(session_textures()[i]);
        paint_session(expected, static_cast<int>(update->update));
        EXPECT_TRUE(std::ranges::equal(client->frame().volumes[0].textures[i].texels,
                                       std::as_const(expected).view().bytes))
            << name << " update " << update->update << " texture " << i;
        lines +=
            line_of(name, client->frame().update, i, client->frame().volumes[0].textures[i].texels);
      }
    }
  }
  EXPECT_EQ(last, Status::end);
  EXPECT_EQ(lines, expected_lines(name));
  EXPECT_EQ(client->goodbye().reason, Reason::shutdown);
  EXPECT_GT(client->statistics().proofs, 0U);
  EXPECT_EQ(client->statistics().failed_proofs, 0U);
  EXPECT_TRUE(intra);
  EXPECT_EQ(snapshot, name == "shared_zstd.session");
  EXPECT_EQ(types.size(), 7U);  // All but Resync.
}

INSTANTIATE_TEST_SUITE_P(All, GoldenSession,
                         testing::Values("unicast_raw.session", "unicast_native.session",
                                         "shared_zstd.session", "shared_native.session"));

}  // namespace
}  // namespace gicodec

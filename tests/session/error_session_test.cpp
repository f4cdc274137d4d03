// Servers with a bounded error: clients are within it, and hold what the server believes.
#include "server_fixture.h"

#include <gicodec/error_bound.h>

#include <limits>

namespace gicodec {
namespace {

using namespace test;

class ErrorSession : public ServerTest {
 protected:
  void make_bounded(float max_error) {
    ServerOptions options;
    options.proofs = true;
    auto server = Server::create(options);
    ASSERT_TRUE(server.ok());
    server_.emplace(*std::move(server));
    StreamedTexture streamed;
    streamed.texture = "color";
    streamed.max_error = max_error;
    ASSERT_TRUE(
        server_
            ->add_volume("volume", probes_of({{"color", texture_.desc()}}), {kGrid}, {&streamed, 1})
            .ok());
  }
};

TEST_F(ErrorSession, ClientsAreWithinTheBound) {
  make_bounded(3);
  Client client = make_client();
  const ConnectionId connection = join(client);
  for (int i = 0; i < 4; ++i) {
    update();
    exchange(connection, client);
    const Bytes& decoded = client.frame().volumes[0].textures[0].texels;
    const auto given = std::as_const(texture_).view().bytes;
    EXPECT_TRUE(within_error(texture_.desc().record, given, decoded, 3));
    EXPECT_FALSE(within_error(texture_.desc().record, given, decoded, 1));
  }
  EXPECT_EQ(client.statistics().failed_proofs, 0U);
  EXPECT_EQ(client.statistics().proofs, 4U);
  EXPECT_EQ(client.frame().volumes[0].textures[0].largest_error, 3);
  // What was published before is not sent again.
  const auto before = client.statistics().bytes;
  now_ += 0.1;
  ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
  ASSERT_EQ(server_->update(now_, now_), Status::ok);
  exchange(connection, client);
  EXPECT_LT(client.statistics().bytes - before, 200U);
}

TEST_F(ErrorSession, BoundsAreValidated) {
  const VolumeDesc volume = probes_of({{"color", texture_.desc()}});
  const auto status = [&](float threshold, float max_error) {
    auto server = Server::create();
    StreamedTexture streamed;
    streamed.texture = "color";
    streamed.threshold = threshold;
    streamed.max_error = max_error;
    return server->add_volume("volume", volume, {kGrid}, {&streamed, 1}).status();
  };
  EXPECT_EQ(status(0, 2), Status::ok);
  EXPECT_EQ(status(2, 0), Status::ok);
  EXPECT_EQ(status(2, 2), Status::invalid_bound);
  EXPECT_EQ(status(0, -1), Status::invalid_bound);
  EXPECT_EQ(status(0, std::numeric_limits<float>::infinity()), Status::invalid_bound);
}

}  // namespace
}  // namespace gicodec

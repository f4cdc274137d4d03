// A server with a volume, clients that say what a test likes, and honest clients beside them.
#pragma once

#include "../messages.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::test {

inline constexpr Grid kGrid{4, 2, 3};
inline constexpr std::uint32_t kBlocks = 24;

class ServerTest : public testing::Test {
 protected:
  void make(ServerOptions options = {}) {
    options.proofs = true;
    auto server = Server::create(options);
    ASSERT_TRUE(server.ok());
    server_.emplace(*std::move(server));
    ASSERT_TRUE(
        server_->add_volume("volume", probes_of({{"color", texture_.desc()}}), {kGrid}).ok());
  }

  /// A connection that has said nothing yet.
  ConnectionId connect() {
    const auto connection = server_->connect(now_);
    EXPECT_TRUE(connection.ok());
    return *connection;
  }

  void say(ConnectionId connection, const AnyMessage& message) {
    Message bytes;
    ASSERT_EQ(write_message(message, bytes), Status::ok);
    server_->receive(connection, bytes, now_);
  }

  ConnectionId join(Client& client) {
    const ConnectionId connection = connect();
    const auto hello = client.hello();
    EXPECT_TRUE(hello.ok());
    server_->receive(connection, *hello, now_);
    say(connection, Subscribe{1, 0, 0, BlockMask(kBlocks, 1)});
    return connection;
  }

  void update() {
    now_ += 0.1;
    texture_.fill(Fill::noise, random_);
    ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    ASSERT_EQ(server_->update(now_, now_), Status::ok);
  }

  void exchange(ConnectionId connection, Client& client) {
    for (const Message& message : joined(server_->take_messages(connection))) {
      ASSERT_EQ(client.receive(message), Status::ok);
    }
    for (const Message& reply : client.take_messages()) server_->receive(connection, reply, now_);
  }

  /// Why the client was dropped, if it was; its Goodbye must say the same.
  std::optional<Reason> dropped(ConnectionId connection) {
    std::optional<Reason> reason;
    for (const ServerEvent& event : server_->take_events()) {
      if (event.type == ServerEvent::Type::dropped && event.connection == connection)
        reason = event.reason;
    }
    if (!reason) return reason;
    const auto messages = joined(server_->take_messages(connection));
    EXPECT_EQ(messages.size(), *reason == Reason::left ? 0U : 1U);
    for (const Message& message : messages) {
      const auto read = read_message(message);
      EXPECT_TRUE(read.ok());
      const auto* goodbye = std::get_if<Goodbye>(&*read);
      EXPECT_TRUE(goodbye != nullptr);
      if (goodbye != nullptr) {
        EXPECT_EQ(goodbye->reason, *reason);
        EXPECT_EQ(goodbye->text, to_string(*reason));
      }
    }
    return reason;
  }

  static Client make_client(const ClientOptions& options = {}) {
    auto client = Client::create(options);
    EXPECT_TRUE(client.ok());
    return *std::move(client);
  }

  /// The client in question is gone; another one still gets everything.
  void expect_others_go_on(ConnectionId honest, Client& client) {
    const auto before = client.statistics().proofs;
    for (int i = 0; i < 3; ++i) {
      update();
      exchange(honest, client);
    }
    EXPECT_EQ(client.statistics().proofs, before + 3);
    EXPECT_EQ(client.statistics().failed_proofs, 0U);
    EXPECT_TRUE(std::ranges::equal(client.frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }

  double now_ = 0;
  Random random_{1};
  Texture texture_{ddgi_irradiance(kGrid)};
  std::optional<Server> server_;
};

}  // namespace gicodec::test

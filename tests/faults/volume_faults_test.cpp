// Whatever allocation fails in a session of a volume with everything that the model has: blocks
// that are there in part, textures that travel together, ranks, a group that names blocks of
// another.
#include "../messages.h"
#include "faults.h"
#include "payload_conformance.h"

#include <gtest/gtest.h>

#include <optional>

namespace gicodec {
namespace {

using namespace test;

class Scene {
  template <typename Call>
  auto insist(Call&& call) {
    auto result = fault_(call);
    const auto succeeded = [&] {
      if constexpr (requires { result.ok(); }) {
        return result.ok();
      } else {
        return result == Status::ok;
      }
    };
    if (succeeded()) return result;
    EXPECT_TRUE(fault_.failed());
    return call();
  }

 public:
  Scene(Fault& fault, Delivery delivery) : fault_(fault), delivery_(delivery) {
    ServerOptions options;
    options.backend = "raw";
    options.region = {4, 2, 1};
    options.kinds = {&kScenes};
    options.proofs = true;
    server_.emplace(*Server::create(options));
    const VolumeGeometry geometry{textures_of(volume_)[0]->desc.grid};
    EXPECT_TRUE(insist([&] { return server_->add_volume("volume", volume_, geometry); }).ok());
  }

  void run() {
    ClientOptions options;
    options.delivery = delivery_;
    options.kinds = {&kScenes};
    client_.emplace(*insist([&] { return Client::create(options); }));
    connect();
    for (int i = 0; i < 5; ++i) {
      change(volume_, contents_, random_);
      update();
      if (i == 2) connect();  // Comes back with what it holds.
    }
    fault_.end();  // And nothing changes any more.
    for (int i = 0; i < 4; ++i) update();
    EXPECT_TRUE(client_->consistent());
    EXPECT_EQ(client_->statistics().failed_proofs, 0U);
    EXPECT_EQ(compare(volume_, contents_, client_->frame().volumes[0]), "");
  }

 private:
  void connect() {
    if (connection_) server_->disconnect(*connection_, now_);
    connection_ = *insist([&] { return server_->connect(now_); });
    const auto hello = insist([&] { return client_->hello(); });
    ASSERT_TRUE(hello.ok());
    tell(*hello);
    for (std::uint8_t group = 0; group < volume_.groups.size(); ++group) {
      Message subscribe;
      BlockMask all(block_count(volume_.groups[group].textures[0].desc), 1);
      ASSERT_EQ(write_message(Subscribe{1, 0, group, std::move(all)}, subscribe), Status::ok);
      tell(subscribe);
    }
  }

  void tell(const Message& message) {
    fault_([&] {
      server_->receive(*connection_, message, now_);
      return 0;
    });
  }

  void update() {
    now_ += 0.1;
    for (std::uint8_t t = 0; t < contents_.size(); ++t) {
      const std::span<const std::byte> bytes = contents_[t];
      ASSERT_EQ(insist([&] { return server_->publish(0, t, bytes); }), Status::ok);
    }
    const Status status = fault_([&] { return server_->update(now_, now_); });
    EXPECT_TRUE(status == Status::ok || fault_.failed());
    const bool here = exchange();
    bool dropped = false;
    for (const ServerEvent& event : server_->take_events()) {
      dropped =
          dropped || (event.type == ServerEvent::Type::dropped && event.connection == *connection_);
    }
    EXPECT_TRUE((here && !dropped) || fault_.failed());
    if (!here || dropped) connect();
  }

  /// False if the client could not take a message.
  bool exchange() {
    for (const Message& message :
         joined(fault_([&] { return server_->take_messages(*connection_); }))) {
      if (fault_([&] { return client_->receive(message); }) != Status::ok) return false;
    }
    for (const Message& reply : fault_([&] { return client_->take_messages(); })) tell(reply);
    return true;
  }

  Fault& fault_;
  Delivery delivery_;
  const VolumeDesc volume_ = scene_volume(6);
  Contents contents_ = blank(volume_);
  Generator random_{1};
  double now_ = 0;
  std::optional<Server> server_;
  std::optional<Client> client_;
  std::optional<ConnectionId> connection_;
};

TEST(VolumeFaults, LeaveUnicastClientsRight) {
  const auto faults = with_every_fault([](Fault& fault) { Scene(fault, Delivery::unicast).run(); });
  EXPECT_GT(faults, 500U);
}

TEST(VolumeFaults, LeaveClientsOfRegionsRight) {
  const auto faults = with_every_fault([](Fault& fault) { Scene(fault, Delivery::shared).run(); });
  EXPECT_GT(faults, 500U);
}

/// With clients of both deliveries there: a volume is added whole or not at all, and what could not
/// be told of it costs a connection.
TEST(VolumeFaults, VolumesComeWholeOrNotAtAll) {
  const VolumeDesc scene = scene_volume(6);
  const VolumeGeometry geometry{textures_of(scene)[0]->desc.grid};
  const auto faults = with_every_fault([&](Fault& fault) {
    ServerOptions options;
    options.backend = "raw";
    options.region = {4, 2, 1};
    options.kinds = {&kScenes};
    options.proofs = true;
    Server server = *Server::create(options);
    std::vector<Client> clients;
    std::vector<ConnectionId> connections;
    for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
      ClientOptions of_client;
      of_client.kinds = {&kScenes};
      of_client.delivery = delivery;
      clients.push_back(*Client::create(of_client));
      connections.push_back(*server.connect(0));
      server.receive(connections.back(), *clients.back().hello(), 0);
    }
    Contents contents = blank(scene);
    Generator random{1};
    double now = 0;
    for (int turn = 0; turn < 2; ++turn) {
      const auto add = [&] { return server.add_volume("level", scene, geometry); };
      auto id = fault(add);
      if (!id) {
        EXPECT_TRUE(fault.failed());
        EXPECT_EQ(server.volumes(), 0U);
        EXPECT_EQ(server.geometry(0).status(), Status::unknown_volume);
        id = add();
      }
      ASSERT_TRUE(id.ok());
      EXPECT_EQ(*id, 0U);
      change(scene, contents, random);
      for (std::uint8_t t = 0; t < contents.size(); ++t) {
        ASSERT_EQ(server.publish(*id, t, std::span<const std::byte>(contents[t])), Status::ok);
      }
      now += 0.1;
      ASSERT_EQ(server.update(now, now), Status::ok);
      std::size_t there = 0;
      for (std::size_t i = 0; i < clients.size(); ++i) {
        if (!server.client(connections[i])) continue;
        ++there;
        for (const Message& message : joined(server.take_messages(connections[i]))) {
          ASSERT_EQ(clients[i].receive(message), Status::ok);
        }
        for (const Message& reply : clients[i].take_messages()) {
          server.receive(connections[i], reply, now);
        }
        EXPECT_TRUE(clients[i].consistent());
        EXPECT_EQ(clients[i].statistics().failed_proofs, 0U);
        EXPECT_EQ(compare(scene, contents, clients[i].frame().volumes[0]), "");
      }
      EXPECT_TRUE(there == clients.size() || fault.failed());
      EXPECT_EQ(fault([&] { return server.remove_volume(*id); }), Status::ok);
      EXPECT_EQ(server.volumes(), 0U);
    }
  });
  EXPECT_GT(faults, 100U);
}

}  // namespace
}  // namespace gicodec

// Volumes that are added and removed while clients are there: level streaming.
#include "../messages.h"
#include "session/server_fixture.h"

#include <thread>

namespace gicodec {
namespace {

using namespace test;

class ComeAndGo : public ServerTest {
 protected:
  std::uint16_t add(const std::string& name, const Texture& texture) {
    const auto id =
        server_->add_volume(name, probes_of({{"color", texture.desc()}}), {texture.desc().grid});
    EXPECT_EQ(id.status(), Status::ok);
    return id ? *id : std::uint16_t{0xFFFF};
  }
  Status publish(std::uint16_t id, Texture& texture) {
    texture.fill(Fill::noise, random_);
    return server_->publish(id, 0, std::as_const(texture).view());
  }
  /// An update of the fixture's volume, 0, and of what was published besides.
  void update_all(ConnectionId connection, Client& client) {
    update();
    exchange(connection, client);
    EXPECT_TRUE(client.consistent());
    EXPECT_EQ(client.statistics().failed_proofs, 0U);
    EXPECT_EQ(client.statistics().gaps, 0U);
  }
  static bool holds(const Client& client, std::uint16_t id, const Texture& texture) {
    const ClientVolume* const volume = client.frame().find(id);
    return volume != nullptr &&
           std::ranges::equal(volume->textures[0].texels, texture.view().bytes);
  }
};

TEST_F(ComeAndGo, ClientsFollow) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    make();
    Client client = make_client({.delivery = delivery});
    const ConnectionId connection = connect();
    server_->receive(connection, *client.hello(), now_);
    update_all(connection, client);
    const std::uint64_t keyframes = client.statistics().packets;
    Texture cellar(ddgi_irradiance({2, 3, 2})), attic(ddgi_irradiance({5, 1, 1}));
    const std::uint16_t first = add("cellar", cellar);
    EXPECT_EQ(first, 1U);
    ASSERT_EQ(publish(first, cellar), Status::ok);
    update_all(connection, client);
    EXPECT_TRUE(holds(client, first, cellar));
    EXPECT_TRUE(holds(client, 0, texture_));
    EXPECT_EQ(client.frame().find(first)->name, "cellar");
    EXPECT_EQ(client.frame().began, 1U);
    // What it held of the volume that stays was kept.
    EXPECT_GT(client.statistics().packets, keyframes);

    ASSERT_EQ(server_->remove_volume(first), Status::ok);
    EXPECT_EQ(server_->publish(first, 0, std::as_const(cellar).view()), Status::unknown_volume);
    const std::uint16_t second = add("attic", attic);
    EXPECT_EQ(second, first);  // Its number is free again, and its contents are not the former's.
    EXPECT_EQ(server_->volumes(), 2U);
    ASSERT_EQ(publish(second, attic), Status::ok);
    update_all(connection, client);
    EXPECT_EQ(client.frame().volumes.size(), 2U);
    EXPECT_EQ(client.frame().find(second)->name, "attic");
    EXPECT_TRUE(holds(client, second, attic));
    ASSERT_EQ(server_->remove_volume(0), Status::ok);
    EXPECT_EQ(server_->remove_volume(0), Status::unknown_volume);
    ASSERT_EQ(server_->update(now_ + 1, 0), Status::ok);
    exchange(connection, client);
    EXPECT_EQ(client.frame().find(0), nullptr);
    EXPECT_TRUE(holds(client, second, attic));
  }
}

/// Who comes back finds what is there now, and keeps what is still there.
TEST_F(ComeAndGo, ReturnsMissNothing) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    make();
    Client client = make_client({.delivery = delivery});
    ConnectionId connection = connect();
    server_->receive(connection, *client.hello(), now_);
    Texture cellar(ddgi_irradiance({2, 3, 2})), attic(ddgi_irradiance({2, 3, 2}));
    const std::uint16_t first = add("cellar", cellar);
    ASSERT_EQ(publish(first, cellar), Status::ok);
    update_all(connection, client);
    server_->disconnect(connection, now_);
    ASSERT_EQ(server_->remove_volume(first), Status::ok);
    const std::uint16_t second = add("attic", attic);
    ASSERT_EQ(second, first);
    ASSERT_EQ(publish(second, attic), Status::ok);
    connection = connect();
    server_->receive(connection, *client.hello(), now_);
    update_all(connection, client);
    EXPECT_TRUE(client.resumed());
    EXPECT_TRUE(holds(client, second, attic));
    EXPECT_TRUE(holds(client, 0, texture_));
  }
}

/// What a client says of a volume that has gone meanwhile means nothing; nor does it cost it its
/// place.
TEST_F(ComeAndGo, WhatIsSaidTooLateIsIgnored) {
  make();
  Client client = make_client();
  const ConnectionId connection = connect();
  server_->receive(connection, *client.hello(), now_);
  Texture cellar(ddgi_irradiance({2, 3, 2})), attic(ddgi_irradiance({5, 1, 1}));
  const std::uint16_t first = add("cellar", cellar);
  ASSERT_EQ(publish(first, cellar), Status::ok);
  update_all(connection, client);
  const BlockMask of_cellar(12, 1);
  ASSERT_EQ(client.subscribe(first, of_cellar), Status::ok);
  const auto late = client.take_messages();
  ASSERT_EQ(server_->remove_volume(first), Status::ok);
  for (const Message& message : late) server_->receive(connection, message, now_);
  EXPECT_EQ(dropped(connection), std::nullopt);
  ASSERT_EQ(add("attic", attic), first);
  for (const Message& message : late) server_->receive(connection, message, now_);
  EXPECT_EQ(dropped(connection), std::nullopt);
  ASSERT_EQ(publish(first, attic), Status::ok);
  update_all(connection, client);
  EXPECT_TRUE(holds(client, first, attic));
  EXPECT_EQ(client.subscribe(first, of_cellar), Status::mask_mismatch);
  // Of one that is there now the mask has to be its own, and no other number will do.
  say(connection, Subscribe{4, first, 0, of_cellar});
  EXPECT_EQ(dropped(connection), Reason::malformed);
  Client other = make_client();
  const ConnectionId stranger = connect();
  server_->receive(stranger, *other.hello(), now_);
  update_all(stranger, other);
  say(stranger, Subscribe{4, static_cast<std::uint16_t>(first + 1), 0, of_cellar});
  EXPECT_EQ(dropped(stranger), Reason::unknown_volume);
}

/// A list that got lost is asked for.
TEST_F(ComeAndGo, AListThatIsMissingIsSentAgain) {
  make();
  Client client = make_client();
  const ConnectionId connection = connect();
  server_->receive(connection, *client.hello(), now_);
  update_all(connection, client);
  Texture cellar(ddgi_irradiance({2, 3, 2}));
  const std::uint16_t first = add("cellar", cellar);
  ASSERT_EQ(publish(first, cellar), Status::ok);
  EXPECT_EQ(joined(server_->take_messages(connection)).size(), 1U);  // Lost.
  update();
  exchange(connection, client);
  EXPECT_FALSE(client.consistent());
  EXPECT_EQ(client.statistics().gaps, 1U);
  update();
  exchange(connection, client);
  EXPECT_TRUE(client.consistent());
  EXPECT_TRUE(holds(client, first, cellar));
}

/// Frames that are handed over have the volumes of their update, and no others.
TEST_F(ComeAndGo, FramesFollow) {
  make();
  auto thread = ClientThread::start(make_client());
  ASSERT_TRUE(thread.ok());
  const ConnectionId connection = connect();
  server_->receive(connection, *thread->hello(), now_);
  std::vector<std::unique_ptr<Texture>> textures;
  std::vector<std::uint16_t> ids;
  for (int step = 0; step < 40; ++step) {
    if (step % 3 == 0) {
      textures.push_back(std::make_unique<Texture>(
          ddgi_irradiance({1 + static_cast<std::uint32_t>(step) % 4, 2, 1})));
      ids.push_back(add("level" + std::to_string(step), *textures.back()));
    }
    if (step % 4 == 3) {
      ASSERT_EQ(server_->remove_volume(ids.front()), Status::ok);
      ids.erase(ids.begin());
      textures.erase(textures.begin());
    }
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ASSERT_EQ(publish(ids[i], *textures[i]), Status::ok);
    }
    update();
    for (Message& message : joined(server_->take_messages(connection))) {
      ASSERT_EQ(thread->push(std::move(message)), Status::ok);
    }
    while (!thread->idle()) std::this_thread::yield();
    ASSERT_EQ(thread->status(), Status::ok);
    for (const Message& message : thread->take_messages())
      server_->receive(connection, message, now_);
    if (step % 2 == 0) continue;  // A renderer that is slower than the updates.
    const ClientFrame& frame = thread->latest();
    ASSERT_EQ(frame.volumes.size(), ids.size() + 1);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const ClientVolume* const volume = frame.find(ids[i]);
      ASSERT_NE(volume, nullptr);
      EXPECT_TRUE(
          std::ranges::equal(volume->textures[0].texels, std::as_const(*textures[i]).view().bytes));
    }
  }
}

/// A server that says of a volume which goes on that it is another one lies.
TEST_F(ComeAndGo, ListsThatContradictThemselvesAreCorrupt) {
  make();
  Client client = make_client();
  const ConnectionId connection = connect();
  server_->receive(connection, *client.hello(), now_);
  const auto messages = joined(server_->take_messages(connection));
  ASSERT_EQ(messages.size(), 1U);
  ASSERT_EQ(client.receive(messages[0]), Status::ok);
  const auto read = *read_message(messages[0]);
  const auto& welcome = std::get<Welcome>(read);
  const auto said = [&](auto change) {
    Volumes volumes{welcome.generation + 1, welcome.volumes};
    change(volumes);
    Message bytes;
    EXPECT_EQ(write_message(volumes, bytes), Status::ok);
    return client.receive(bytes);
  };
  EXPECT_EQ(said([](Volumes& v) { v.volumes[0].name = "another"; }), Status::corrupt);
  EXPECT_EQ(said([](Volumes& v) { v.volumes[0].region.x = 9; }), Status::corrupt);
  EXPECT_EQ(said([](Volumes& v) { v.volumes[0].geometry.origin[0] = 1; }), Status::corrupt);
  EXPECT_EQ(said([](Volumes& v) { v.generation -= 1; }), Status::ok);  // Known already.
  EXPECT_EQ(said([](Volumes& v) { v.volumes[0].added = v.generation; }), Status::ok);
  EXPECT_EQ(client.frame().volumes.size(), 1U);
}

}  // namespace
}  // namespace gicodec

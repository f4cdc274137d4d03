// A host with a volume, peers that say what a test likes, and honest clients beside them.
#pragma once

#include "../messages.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/host.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::test {

inline constexpr Grid kGrid{4, 2, 3};
inline constexpr std::uint32_t kBlocks = 24;

class HostTest : public testing::Test {
 protected:
  void make(HostOptions options = {}) {
    options.proofs = true;
    auto host = Host::create(options);
    ASSERT_TRUE(host.ok());
    host_.emplace(*std::move(host));
    ASSERT_TRUE(host_->add_volume("volume", probes_of({{"color", texture_.desc()}}), {kGrid}).ok());
  }

  /// A connection that has said nothing yet.
  PeerId connect() {
    const auto peer = host_->connect(now_);
    EXPECT_TRUE(peer.ok());
    return *peer;
  }

  void say(PeerId peer, const AnyMessage& message) {
    Message bytes;
    ASSERT_EQ(write_message(message, bytes), Status::ok);
    host_->receive(peer, bytes, now_);
  }

  PeerId join(Client& client) {
    const PeerId peer = connect();
    const auto hello = client.hello();
    EXPECT_TRUE(hello.ok());
    host_->receive(peer, *hello, now_);
    say(peer, Subscribe{1, 0, 0, BlockMask(kBlocks, 1)});
    return peer;
  }

  void update() {
    now_ += 0.1;
    texture_.fill(Fill::noise, random_);
    ASSERT_EQ(host_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    ASSERT_EQ(host_->update(now_, now_), Status::ok);
  }

  void exchange(PeerId peer, Client& client) {
    for (const Message& message : joined(host_->take_messages(peer))) {
      ASSERT_EQ(client.receive(message), Status::ok);
    }
    for (const Message& reply : client.take_messages()) host_->receive(peer, reply, now_);
  }

  /// Why the peer was dropped, if it was; its Goodbye must say the same.
  std::optional<Reason> dropped(PeerId peer) {
    std::optional<Reason> reason;
    for (const HostEvent& event : host_->take_events()) {
      if (event.kind == HostEvent::Kind::dropped && event.peer == peer) reason = event.reason;
    }
    if (!reason) return reason;
    const auto messages = joined(host_->take_messages(peer));
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

  /// The peer in question is gone; another one still gets everything.
  void expect_others_go_on(PeerId honest, Client& client) {
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
  std::optional<Host> host_;
};

}  // namespace gicodec::test

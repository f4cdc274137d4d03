// Whatever allocation fails in a call of a publisher or a receiver of tracks: the call says so and
// changes nothing, or the next update makes up for it, and in the end the client holds what was
// published.
#include "../messages.h"
#include "faults.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/track_publisher.h>
#include <gicodec/track_receiver.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kTrackGrid{4, 2, 2};
constexpr std::uint32_t kTrackBlocks = 16;
const TextureDesc kTrackColor = probe_texture(Format::R16_SFLOAT, kTrackGrid, 2);
const VolumeDesc kTrackVolume = probes_of({{"color", kTrackColor}});

class TrackWorld {
 public:
  explicit TrackWorld(Fault& fault) : fault_(fault) {
    texture_.fill(Fill::noise, random_);
    publish_anew();
    client_.emplace(*Client::create({.delivery = Delivery::shared}));
    receiver_.emplace(*TrackReceiver::create());
    say(*client_->hello());
  }

  void run() {
    for (int i = 0; i < 3; ++i) update({});
    join();
    for (int i = 0; i < 3; ++i) update({static_cast<std::uint32_t>(i), 5, 11});
    BlockMask some(kTrackBlocks, 0);
    some[2] = some[7] = 1;
    ASSERT_EQ(client_->subscribe(0, some, 0), Status::ok);
    update({2, 3});
    ASSERT_EQ(client_->subscribe(0, BlockMask(kTrackBlocks, 1), 0), Status::ok);
    update({2, 3});
    publish_anew();
    for (int i = 0; i < 4; ++i) update({static_cast<std::uint32_t>(i)});
    fault_.end();
    for (int i = 0; i < 20; ++i) update({});
    EXPECT_TRUE(receiver_->complete());
    EXPECT_TRUE(client_->consistent());
    EXPECT_EQ(client_->statistics().failed_proofs, 0U);
    ASSERT_EQ(client_->frame().volumes.size(), 1U);
    EXPECT_TRUE(std::ranges::equal(client_->frame().volumes[0].textures[0].texels,
                                   std::as_const(texture_).view().bytes));
  }

 private:
  /// The result of a call that is repeated if it fails.
  template <typename Call>
  auto insist(const Call& call) {
    auto result = fault_(call);
    if (!fault_.failed()) return result;
    const bool ok = [&] {
      if constexpr (std::is_same_v<decltype(result), Status>) {
        return result == Status::ok;
      } else {
        return result.ok();
      }
    }();
    return ok ? std::move(result) : call();
  }

  void publish_anew() {
    publisher_.reset();
    ServerOptions options;
    options.backend = "raw";
    options.region = {2, 2, 2};
    options.proofs = true;
    options.epoch = ++epoch_;
    server_.emplace(*Server::create(options));
    ASSERT_TRUE(server_->add_volume("volume", kTrackVolume, {kTrackGrid}).ok());
    publisher_.emplace(*TrackPublisher::create(*server_, {.snapshot_seconds = 0.5}));
    kept_.clear();
  }

  void update(const std::vector<std::uint32_t>& blocks) {
    for (const std::uint32_t block : blocks) {
      texture_.fill_block(block, Fill::noise, random_);
      texture_.fill_band(block);
    }
    now_ += 0.1;
    ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    static_cast<void>(fault_([&] { return publisher_->update(now_, now_); }));
    for (const TrackMessage& message : publisher_->messages()) {
      const auto key = std::tuple(message.type, message.stream, message.number);
      kept_[key] = message.bytes;
      const auto wanted = receiver_->wanted();
      if (message.type != TrackMessage::Type::object ||
          std::ranges::find(wanted, message.stream) != wanted.end())
        receive(message.bytes);
    }
    join();
  }

  /// What the receiver asks for comes at once.
  void join() {
    for (int trip = 0; trip < 3; ++trip) {
      if (receiver_->wants_hello()) say(*client_->hello());
      const auto messages = insist([&] { return receiver_->take_messages(); });
      ASSERT_TRUE(messages.ok());
      for (const Message& message : *messages) ASSERT_EQ(client_->receive(message), Status::ok);
      for (const Message& message : client_->take_messages()) say(message);
      const auto requests = insist([&] { return receiver_->take_requests(); });
      ASSERT_TRUE(requests.ok());
      if (requests->list) {
        fetch({TrackMessage::Type::list, StreamId{}, 0});
        fetch({TrackMessage::Type::tick, StreamId{}, 0});
      }
      for (const auto& [stream, number] : requests->objects)
        fetch({TrackMessage::Type::object, stream, number});
    }
  }

  using Key = std::tuple<TrackMessage::Type, StreamId, std::uint32_t>;
  void fetch(const Key& key) {
    if (const auto found = kept_.find(key); found != kept_.end()) receive(found->second);
  }
  void receive(const Message& message) {
    ASSERT_EQ(insist([&] { return receiver_->receive(message); }), Status::ok);
  }
  void say(const Message& message) {
    ASSERT_EQ(insist([&] { return receiver_->take(message); }), Status::ok);
  }

  Fault& fault_;
  Random random_{1};
  Texture texture_{kTrackColor};
  double now_ = 0;
  std::uint64_t epoch_ = 0;
  std::optional<Server> server_;
  std::optional<TrackPublisher> publisher_;
  std::map<Key, Message> kept_;
  std::optional<Client> client_;
  std::optional<TrackReceiver> receiver_;
};

TEST(TrackFaults, LeaveReceiversRight) {
  const std::size_t faults = with_every_fault([](Fault& fault) { TrackWorld(fault).run(); });
  EXPECT_GT(faults, 500U);
}

}  // namespace
}  // namespace gicodec

// What clients record: whole from the first frame on, whenever the recording begins, and in a file
// for each list of volumes. The simulation of sessions records, too.
#include "../messages.h"
#include "session/recording_check.h"
#include "session/server_fixture.h"

namespace gicodec {
namespace {

using namespace test;

/// Frames and packets of a finished container.
struct Played {
  std::vector<std::uint64_t> frames;
  std::size_t keyframes = 0, updates = 0, snapshots = 0;
  Bytes texels;  ///< of the first texture, at the end
};
Played play(const Bytes& container) {
  Played played;
  MemorySource source(container);
  auto player = ContainerPlayer::open(source);
  EXPECT_TRUE(player.ok() && player->finished());
  Status status = Status::ok;
  while ((status = player->next()) == Status::ok) {
    played.frames.push_back(player->frame());
    for (const ContainerPacket& packet : player->packets()) {
      ++(packet.keyframe ? played.keyframes : played.updates);
      played.snapshots += peek(packet.bytes)->type == PacketType::snapshot ? 1 : 0;
    }
  }
  EXPECT_EQ(status, Status::end);
  played.texels.resize(
      static_cast<std::size_t>(texture_bytes(player->description().textures[0].desc)));
  EXPECT_EQ(player->read(0, TextureView{played.texels}), Status::ok);
  return played;
}

/// Hands on to another listener once there is one.
struct Switch final : ClientListener {
  void updated(const Client& client,
               std::span<const UpdateMessage::Part> packets) noexcept override {
    all += packets.size();
    if (to != nullptr) to->updated(client, packets);
  }
  ClientListener* to = nullptr;
  std::size_t all = 0;
};

class Recorder : public ServerTest {
 protected:
  void step(ConnectionId connection, Client& client) {
    update();
    exchange(connection, client);
    EXPECT_TRUE(client.consistent());
  }
  bool ends_as_published(const Played& played) {
    return std::ranges::equal(played.texels, std::as_const(texture_).view().bytes);
  }
};

TEST_F(Recorder, PacketsAreKeptAsTheyCame) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    make({.region = {2, 2, 2}});
    RecordingCheck recording;
    Client client = make_client({.delivery = delivery, .listener = &recording});
    const ConnectionId connection = join(client);
    for (int i = 0; i < 5; ++i) step(connection, client);
    recording.finish();
    ASSERT_EQ(recording.containers.size(), 1U);
    const Played played = play(recording.containers[0]);
    EXPECT_EQ(played.keyframes + played.updates, client.statistics().packets);
    EXPECT_EQ(played.snapshots, 0U);
    EXPECT_EQ(played.frames.back(), client.frame().update);
    EXPECT_EQ(played.frames.size(), recording.updates);
    EXPECT_TRUE(ends_as_published(played));
  }
}

TEST_F(Recorder, BeginsAtAnyTime) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    make({.region = {2, 2, 2}});
    RecordingCheck recording;
    Switch listener;
    Client client = make_client({.delivery = delivery, .listener = &listener});
    const ConnectionId connection = join(client);
    for (int i = 0; i < 4; ++i) step(connection, client);
    listener.to = &recording;
    for (int i = 0; i < 3; ++i) step(connection, client);
    recording.finish();
    const Played played = play(recording.containers.at(0));
    EXPECT_EQ(played.frames.size(), 3U);
    const std::size_t streams = delivery == Delivery::unicast ? 1 : 4;
    EXPECT_EQ(played.snapshots, streams);
    EXPECT_EQ(played.updates, 2 * streams);
    EXPECT_TRUE(ends_as_published(played));
    EXPECT_EQ(recording.compared, 3U);
  }
}

/// What continues in another container is whole from its first frame on, though no keyframe came.
TEST_F(Recorder, AContainerForEachListOfVolumes) {
  make();
  RecordingCheck recording;
  Client client = make_client({.listener = &recording});
  const ConnectionId connection = join(client);
  step(connection, client);
  step(connection, client);
  Texture cellar(ddgi_irradiance({2, 3, 2}));
  ASSERT_TRUE(
      server_->add_volume("cellar", probes_of({{"color", cellar.desc()}}), {cellar.desc().grid})
          .ok());
  cellar.fill(Fill::noise, random_);
  ASSERT_EQ(server_->publish(1, 0, std::as_const(cellar).view()), Status::ok);
  step(connection, client);
  say(connection, Subscribe{2, 1, 0, BlockMask(12, 1)});
  step(connection, client);
  ASSERT_EQ(server_->remove_volume(1), Status::ok);
  step(connection, client);
  recording.finish();
  ASSERT_EQ(recording.containers.size(), 3U);
  EXPECT_EQ(play(recording.containers[0]).frames, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(play(recording.containers[1]).frames, (std::vector<std::uint64_t>{3, 4}));
  const Played last = play(recording.containers[2]);
  EXPECT_EQ(last.frames, std::vector<std::uint64_t>{5});
  EXPECT_EQ(last.snapshots, 1U);
  EXPECT_TRUE(ends_as_published(last));
  EXPECT_EQ(recording.compared, 2U + 4U + 1U);
}

/// A session that goes on over another connection goes on in its container, another one does not.
TEST_F(Recorder, AContainerForEachSession) {
  make();
  RecordingCheck recording;
  Client client = make_client({.listener = &recording});
  ConnectionId connection = join(client);
  step(connection, client);
  server_->disconnect(connection, now_);
  update();
  connection = join(client);
  step(connection, client);
  EXPECT_TRUE(client.resumed());
  EXPECT_TRUE(recording.containers.empty());
  make();  // Another server.
  connection = join(client);
  step(connection, client);
  EXPECT_FALSE(client.resumed());
  EXPECT_EQ(recording.containers.size(), 1U);
  recording.finish();
  ASSERT_EQ(recording.containers.size(), 2U);
  EXPECT_EQ(play(recording.containers[0]).snapshots, 0U);
  EXPECT_TRUE(ends_as_published(play(recording.containers[1])));
}

/// Updates that are lost are not in it, and what comes in their place is.
TEST_F(Recorder, GapsAreNotRecorded) {
  make();
  RecordingCheck recording;
  Client client = make_client({.listener = &recording});
  const ConnectionId connection = join(client);
  step(connection, client);
  update();
  static_cast<void>(server_->take_messages(connection));  // Lost.
  update();
  exchange(connection, client);
  EXPECT_FALSE(client.consistent());
  const std::size_t before = recording.frames.size();
  for (int i = 0; i < 4 && recording.frames.size() == before; ++i) step(connection, client);
  recording.finish();
  const Played played = play(recording.containers.at(0));
  ASSERT_EQ(played.frames.size(), 2U);
  EXPECT_GT(played.frames[1], 3U);
  EXPECT_EQ(played.snapshots, 0U);
  EXPECT_TRUE(ends_as_published(played));
  EXPECT_EQ(client.statistics().gaps, 1U);
}

TEST_F(Recorder, BlocksThatScrollInTakeAFrameMore) {
  make();
  RecordingCheck recording;
  Client client = make_client({.listener = &recording});
  const ConnectionId connection = join(client);
  step(connection, client);
  ASSERT_EQ(server_->scroll(0, {1, 0, 0}), Status::ok);
  step(connection, client);
  step(connection, client);
  recording.finish();
  const Played played = play(recording.containers.at(0));
  EXPECT_EQ(played.frames, (std::vector<std::uint64_t>{1, 2, 3, 4}));
  EXPECT_TRUE(ends_as_published(played));
}

/// The room is for a part of it: what was added is whole, and so is the container.
TEST_F(Recorder, AFullSinkIsToldAndLeavesWhatWasThere) {
  make();
  Switch listener;
  Client client = make_client({.listener = &listener});
  const ConnectionId connection = join(client);
  MemorySink sink;
  std::optional<ClientRecorder> recorder;
  Status status = Status::ok;
  struct Add final : ClientListener {
    void updated(const Client& from,
                 std::span<const UpdateMessage::Part> packets) noexcept override {
      if (!*to) to->emplace(*ClientRecorder::begin(*sink, from, *ClientRecorder::describe(from)));
      *status = (*to)->add(from, packets);
    }
    std::optional<ClientRecorder>* to = nullptr;
    MemorySink* sink = nullptr;
    Status* status = nullptr;
  } add;
  add.to = &recorder;
  add.sink = &sink;
  add.status = &status;
  listener.to = &add;
  step(connection, client);
  ASSERT_EQ(status, Status::ok);
  const auto shown = std::as_const(texture_).view().bytes;
  const Bytes before(shown.begin(), shown.end());
  sink.room = sink.bytes.size() + 100;
  step(connection, client);
  EXPECT_EQ(status, Status::io_failed);
  ASSERT_EQ(recorder->finish(), Status::ok);
  EXPECT_EQ(play(sink.bytes).texels, before);
  EXPECT_EQ(recorder->finish(), Status::out_of_order);
}

TEST_F(Recorder, MisuseIsNamed) {
  make();
  Client client = make_client();
  EXPECT_EQ(ClientRecorder::describe(client).status(), Status::out_of_order);
  const ConnectionId connection = join(client);
  step(connection, client);
  auto description = ClientRecorder::describe(client);
  ASSERT_TRUE(description.ok());
  MemorySink sink;
  auto recorder = ClientRecorder::begin(sink, client, *description);
  ASSERT_TRUE(recorder.ok());
  Client other = make_client();
  EXPECT_FALSE(recorder->fits(other));
  EXPECT_EQ(recorder->add(other, {}), Status::out_of_order);
  const UpdateMessage::Part foreign[] = {{{9, 0}, 0, {}}};
  EXPECT_EQ(recorder->add(client, foreign), Status::unknown_texture);
  description->volumes.push_back(description->volumes[0]);
  EXPECT_EQ(ClientRecorder::begin(sink, client, *description).status(), Status::invalid_argument);
}

}  // namespace
}  // namespace gicodec

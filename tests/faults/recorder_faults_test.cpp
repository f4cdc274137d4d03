// Whatever allocation fails in a call of a ClientRecorder: the call says so, and the next one makes
// up for it, so that in the end the container plays as what the client holds.
#include "../messages.h"
#include "faults.h"
#include "memory_sink.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/player.h>
#include <gicodec/recorder.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kRecordedGrid{3, 2, 2};

class Recording final : public ClientListener {
 public:
  explicit Recording(Fault& fault) : fault_(fault) {}

  void updated(const Client& client,
               std::span<const UpdateMessage::Part> packets) noexcept override {
    if (++updates_ < 3) return;  // Begins with snapshots.
    if (!recorder_) begin(client);
    if (!recorder_) return;
    const Status added = fault_([&] { return recorder_->add(client, packets); });
    if (added == Status::ok) return;
    EXPECT_EQ(added, Status::out_of_memory);
    EXPECT_TRUE(fault_.failed());
  }
  Status finish() {
    const Status status = fault_([&] { return recorder_->finish(); });
    return status == Status::ok ? status : recorder_->finish();
  }
  MemorySink sink;

 private:
  void begin(const Client& client) {
    auto description = fault_([&] { return ClientRecorder::describe(client); });
    if (!description) description = ClientRecorder::describe(client);
    auto recorder = fault_([&] { return ClientRecorder::begin(sink, client, *description); });
    if (!recorder) {
      sink.bytes.clear();
      recorder = ClientRecorder::begin(sink, client, *description);
    }
    ASSERT_TRUE(recorder.ok());
    recorder_.emplace(*std::move(recorder));
  }

  Fault& fault_;
  std::optional<ClientRecorder> recorder_;
  int updates_ = 0;
};

void run(Fault& fault, Delivery delivery) {
  auto server = *Server::create({.backend = "raw", .region = {2, 2, 2}});
  Texture texture(probe_texture(Format::R16_SFLOAT, kRecordedGrid, 2));
  Random random(1);
  ASSERT_TRUE(
      server.add_volume("volume", probes_of({{"color", texture.desc()}}), {kRecordedGrid}).ok());
  Recording recording(fault);
  auto client = *Client::create({.delivery = delivery, .listener = &recording});
  const ConnectionId connection = *server.connect(0);
  server.receive(connection, *client.hello(), 0);
  ASSERT_EQ(server.set_visible(connection, 0, BlockMask(12, 1)), Status::ok);
  for (int update = 1; update < 9; ++update) {
    for (std::uint32_t block = 0; block < (update == 1 ? 12U : 3U); ++block)
      texture.fill_block((block * 5 + static_cast<std::uint32_t>(update)) % 12, Fill::noise,
                         random);
    const std::int32_t scrolled = update < 5 ? 0 : 1;
    ASSERT_EQ(server.scroll(0, {scrolled, 0, 0}), Status::ok);
    ASSERT_EQ(server.publish(0, 0, std::as_const(texture).view()), Status::ok);
    ASSERT_EQ(server.update(0.1 * update, 0), Status::ok);
    for (const Message& message : joined(server.take_messages(connection)))
      ASSERT_EQ(client.receive(message), Status::ok);
    for (const Message& reply : client.take_messages())
      server.receive(connection, reply, 0.1 * update);
    if (update == 6) fault.end();
  }
  ASSERT_EQ(recording.finish(), Status::ok);
  MemorySource source(recording.sink.bytes);
  auto player = ContainerPlayer::open(source);
  ASSERT_TRUE(player.ok());
  Status status = Status::ok;
  while ((status = player->next()) == Status::ok) continue;
  EXPECT_EQ(status, Status::end);
  const auto& held = client.frame().volumes[0].textures[0].texels;
  std::vector<std::byte> played(held.size());
  ASSERT_EQ(player->read(0, TextureView{played}), Status::ok);
  EXPECT_TRUE(played == held);
}

TEST(RecorderFaults, AreMadeUpFor) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    const std::size_t faults = with_every_fault([&](Fault& fault) { run(fault, delivery); });
    EXPECT_GT(faults, 100U);
  }
}

}  // namespace
}  // namespace gicodec

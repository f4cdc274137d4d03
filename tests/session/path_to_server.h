// A server, the noise that it publishes, and honest clients behind a modelled path, in virtual
// time.
#pragma once

#include "../messages.h"
#include "modelled_link.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::test {

struct Viewer {
  std::optional<Client> client;
  ConnectionId connection = 0;
  std::size_t flow = 0;
  bool dropped = false;
  std::uint64_t bytes = 0, updates = 0, filled = 0;
  std::vector<double> latencies;
};

/// What was measured of some clients over a while.
struct Measured {
  double goodput = 0;            ///< bytes per second
  double typical = 0, late = 0;  ///< seconds, the median and the 95th percentile
  double fairness = 0;           ///< fewest bytes of a client, of the average
  std::uint64_t dropped = 0, gaps = 0, failed_proofs = 0;
  std::uint64_t filled = 0;   ///< updates in which there was anything
  double fewest_updates = 0;  ///< of a client, per update of the server
};

class PathToServer {
 public:
  static constexpr Grid kGrid{16, 8, 16};
  static constexpr std::uint32_t kBlocks = 2048;
  static constexpr double kInterval = 0.1, kTick = 0.002;

  /// `rate`: bytes per second of the bottleneck.
  explicit PathToServer(double rate,
                        ServerOptions options = {.limits = {.max_waiting = 1000,
                                                            .max_unicast = 1000}},
                        std::uint32_t max_clients = 1000, std::string_view backend = "raw")
      : rate_(rate) {
    options.limits.max_clients = max_clients;
    options.backend = backend;
    options.region = {4, 4, 4};
    auto server = Server::create(options);
    EXPECT_TRUE(server.ok());
    server_.emplace(*std::move(server));
    EXPECT_TRUE(
        server_->add_volume("volume", probes_of({{"color", texture_.desc()}}), {kGrid}).ok());
  }
  PathToServer(const PathToServer&) = delete;
  PathToServer& operator=(const PathToServer&) = delete;
  virtual ~PathToServer() = default;

  /// Bytes per second that a client would get who gets everything.
  [[nodiscard]] static double demand() {
    return static_cast<double>(block_bytes(ddgi_irradiance(kGrid))) * kBlocks / kInterval;
  }

  /// Clients that want everything. `delay`: seconds in each direction; `own_rate`: bytes per second
  /// of a link of their own. `discard`: texels are not looked at.
  void join(std::size_t clients, Delivery delivery, double delay, double own_rate = 1e18,
            bool discard = true) {
    for (std::size_t i = 0; i < clients; ++i) {
      Viewer viewer;
      ClientOptions options;
      options.delivery = delivery;
      options.discard = discard;
      auto client = Client::create(options);
      ASSERT_TRUE(client.ok());
      viewer.client.emplace(*std::move(client));
      const auto connection = server_->connect(now_);
      ASSERT_TRUE(connection.ok());
      viewer.connection = *connection;
      viewer.flow = add_flow(delay, own_rate);
      Flow& flow = flows_.back();
      const auto hello = viewer.client->hello();
      ASSERT_TRUE(hello.ok());
      flow.up.emplace_back(now_ + delay, *hello);
      Message all;
      ASSERT_EQ(write_message(Subscribe{1, 0, 0, BlockMask(kBlocks, 1)}, all), Status::ok);
      flow.up.emplace_back(now_ + delay, all);
      viewers_.push_back(std::move(viewer));
    }
  }

  void run(double seconds) {
    for (const double end = now_ + seconds; now_ < end && !testing::Test::HasFatalFailure();) {
      if (now_ >= due_) update();
      now_ += kTick;
      serve(flows_, rate_, kTick, now_);
      for (Viewer& viewer : viewers_) exchange(viewer, flows_[viewer.flow]);
      tick();
    }
  }

  void set_rate(double rate) { rate_ = rate; }

  /// Runs for a while and tells what arrived in it.
  Measured measure(double seconds) {
    begin();
    run(seconds);
    return measured(seconds, 0, viewers_.size());
  }

  void begin() {
    for (Viewer& viewer : viewers_) {
      viewer.bytes = viewer.updates = viewer.filled = 0;
      viewer.latencies.clear();
    }
    before_ = server_->updates();
  }

  /// What arrived since begin(), at these clients.
  [[nodiscard]] Measured measured(double seconds, std::size_t first, std::size_t count) {
    Measured all;
    std::vector<double> latencies;
    double fewest = 1e300, total = 0, fewest_updates = 1e300;
    for (const Viewer& viewer : std::span(viewers_).subspan(first, count)) {
      const auto bytes = static_cast<double>(viewer.bytes);
      fewest = std::min(fewest, bytes);
      fewest_updates = std::min(fewest_updates, static_cast<double>(viewer.updates));
      total += bytes;
      latencies.insert(latencies.end(), viewer.latencies.begin(), viewer.latencies.end());
      all.filled += viewer.filled;
      all.dropped += viewer.dropped;
      all.gaps += viewer.client->statistics().gaps;
      all.failed_proofs += viewer.client->statistics().failed_proofs;
    }
    std::ranges::sort(latencies);
    EXPECT_FALSE(latencies.empty());
    all.goodput = total / seconds;
    all.typical = latencies[latencies.size() / 2];
    all.late = latencies[latencies.size() * 95 / 100];
    all.fairness = fewest / (total / static_cast<double>(count));
    all.fewest_updates = fewest_updates / static_cast<double>(server_->updates() - before_);
    return all;
  }

 protected:
  virtual void paint(Texture& texture, Random& random) { texture.fill_fast(random); }
  virtual void after_update() {}
  virtual void tick() {}
  [[nodiscard]] Server& server() { return *server_; }
  [[nodiscard]] const Viewer& viewer(std::size_t i) const { return viewers_[i]; }
  [[nodiscard]] double now() const { return now_; }
  void advance(double seconds) { now_ += seconds; }
  [[nodiscard]] Flow& flow(std::size_t i) { return flows_[i]; }
  std::size_t add_flow(double delay, double own_rate = 1e18) {
    Flow flow;
    flow.delay = delay;
    flow.rate = own_rate;
    flows_.push_back(std::move(flow));
    return flows_.size() - 1;
  }
  [[nodiscard]] std::size_t unsent() const {
    std::size_t bytes = 0;
    for (const Flow& flow : flows_) bytes += flow.unsent();
    return bytes;
  }

 private:
  void update() {
    paint(texture_, random_);
    ASSERT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    ASSERT_EQ(server_->update(now_, now_), Status::ok);
    due_ += kInterval;
    for (Viewer& viewer : viewers_) {
      for (const float latency : server_->take_latencies(viewer.connection)) {
        viewer.latencies.push_back(latency);
      }
    }
    after_update();
  }

  void exchange(Viewer& viewer, Flow& flow) {
    while (const auto message = arrived(flow.up, now_)) {
      server_->receive(viewer.connection, *message, now_);
    }
    for (Message& message : joined(server_->take_messages(viewer.connection)))
      send(flow, std::move(message));
    while (const auto message = arrived(flow.down, now_)) {
      const std::uint64_t before = viewer.client->frame().serial,
                          packets = viewer.client->statistics().packets;
      if (viewer.client->receive(*message) != Status::ok) {
        viewer.dropped = true;
        return;
      }
      viewer.bytes += message->size();
      viewer.updates += viewer.client->frame().serial - before;
      viewer.filled += viewer.client->statistics().packets > packets ? 1 : 0;
      for (Message& reply : viewer.client->take_messages()) {
        flow.up.emplace_back(now_ + flow.delay, std::move(reply));
      }
    }
  }

  double rate_;
  std::uint64_t before_ = 0;  ///< updates of the server
  double now_ = 0, due_ = 0;
  Random random_{9};
  Texture texture_{ddgi_irradiance(kGrid)};
  std::optional<Server> server_;
  std::vector<Viewer> viewers_;
  std::vector<Flow> flows_;
};

}  // namespace gicodec::test

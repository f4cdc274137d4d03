#include "simulate.h"

#include "client_link.h"
#include "clock.h"
#include "common/program.h"
#include "ddgi/scene_id.h"
#include "dump/error.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <thread>

namespace gicodec::streaming {
namespace {

constexpr double kSpread = 16;  ///< seconds of the camera's path over which clients are spread
constexpr double kAgain = 0.5;  ///< seconds before a lost client connects again
constexpr std::chrono::milliseconds kIdle{1};
constexpr std::size_t kMax = 1U << 20;  ///< samples kept

void keep(std::vector<float>& samples, double value) {
  if (samples.size() < kMax) samples.push_back(static_cast<float>(value));
}

struct Simulated {
  Simulated(const SimulateOptions& options, Net& network, std::uint32_t place)
      : client(tools::take(Client::create(options.client), "client")),
        net(network),
        number(place),
        offset(kSpread * place / options.clients) {}

  Client client;
  Net& net;
  std::uint32_t number = 0;
  double offset = 0;  ///< on the camera's path
  Link link;
  double connect_at = 0;
  double updated = -1;  ///< when the last update came
  bool open = false, done = false, subscribed = false, was_welcome = false;
};

class LoadTest {
 public:
  LoadTest(const SimulateOptions& options, const CameraPath& path)
      : options_(options), path_(path) {
    // One ENet socket per client: otherwise they would share the kernel's buffer, which clients on
    // different machines do not.
    const bool enet = options.server.via == Via::enet;
    NetOptions net = options.net;
    if (!enet) net.links = options.clients;
    for (std::uint32_t i = 0; i < options.clients; ++i) {
      if (enet || i == 0) nets_.emplace_back(options.server.via, net);
      clients_.emplace_back(options, nets_.back(), i);
    }
  }

  SimulateResult run() {
    const double begin = now();
    double heard = begin;
    while (!tools::interrupted()) {
      const double at = now();
      bool all_done = true, any_open = false;
      for (Simulated& c : clients_) {
        all_done &= c.done;
        any_open |= c.open;
        if (c.done || c.link || at < c.connect_at) continue;
        c.link = c.net.connect(options_.server);
        Net::set_tag(c.link, c.number);
      }
      if (any_open) heard = at;
      if (all_done || (options_.seconds > 0 && at - begin > options_.seconds)) break;
      if (at - heard > options_.patience) {
        if (result_.updates > 0) {
          result_.unanswered = true;
          break;
        }
        tools::fail(tools::Exit::io, "{}", no_answer(options_.server, why_));
      }
      if (!look_around()) std::this_thread::sleep_for(kIdle);
    }
    leave();
    return finish();
  }

 private:
  /// Handles the events of all clients, each for a turn; false if there are none.
  bool look_around() {
    constexpr double kTurn = 0.005, kInattentive = 0.1;  // seconds
    NetEvent event;
    bool any = false;
    for (Net& net : nets_) {
      const double begin = now();
      if (begin - attended_ > kInattentive) {
        for (Net& each : nets_) each.attend();
        attended_ = begin;
      }
      while (now() - begin < kTurn && net.next(event, 0)) {
        handle(clients_[Net::tag(event.link)], event);
        any = true;
      }
    }
    return any;
  }

  void handle(Simulated& c, NetEvent& event) {
    if (event.type == NetEvent::Type::opened || event.type == NetEvent::Type::renewed) {
      c.open = true;
      const auto hello = c.client.hello();
      if (hello) c.net.send(c.link, {*hello});
      if (path_.known()) look(c, 0);
    } else if (event.type == NetEvent::Type::received) {
      receive(c, event.message);
    } else {
      if (event.final) tools::fail(tools::Exit::io, "{}", refused(options_.server, event.why));
      why_ = event.why;
      if (!c.done) ++result_.lost;
      c.open = false;
      c.link = {};
      c.connect_at = now() + kAgain;
    }
  }

  void receive(Simulated& c, const Message& message) {
    if (c.done) return;
    const std::uint64_t before = c.client.frame().serial;
    const double start = now();
    const Status status = c.client.receive(message);
    const double end = now();
    send(c);
    if (status == Status::end && c.client.goodbye().reason == Reason::silent) {
      return;  // Its Hello was too late; it tries again once the server has closed.
    }
    if (status != Status::ok) {
      if (status == Status::end) {
        result_.reason = c.client.goodbye().reason;
      } else {
        result_.unusable = unusable(status);
      }
      return done(c);
    }
    if (c.client.is_connected() && !c.was_welcome) {
      const auto refused =
          options_.scene ? ddgi::refusal(*options_.scene, c.client.frame().scene) : std::nullopt;
      if (refused) tools::fail(tools::Exit::bad_input, "{}", *refused);
      c.was_welcome = true;
      ++result_.connected;
    }
    if (c.client.is_connected() && !c.subscribed && !path_.known()) subscribe(c);
    if (c.client.frame().serial == before) return;
    keep(result_.decode_seconds, end - start);
    if (c.updated >= 0) keep(result_.intervals, end - c.updated);
    c.updated = end;
    if (first_ < 0) first_ = end;
    last_ = end;
    ++result_.updates;
    keep(result_.round_trips, Net::round_trip_ms(c.link) * 1e-3);
    if (options_.updates > 0 && c.client.frame().serial >= options_.updates) return done(c);
    if (path_.known()) look(c, c.client.frame().time);
  }

  static void send(Simulated& c) {
    for (Message& message : c.client.take_messages()) c.net.send(c.link, {std::move(message)});
  }

  void look(Simulated& c, double time) {
    // Without memory the server keeps the last viewpoint.
    static_cast<void>(
        c.client.set_viewpoint(viewpoint(path_.at(time + c.offset), 16.0F / 9, time)));
    send(c);
  }

  static void subscribe(Simulated& c) {
    const auto& volumes = c.client.frame().volumes;
    for (std::uint16_t v = 0; v < volumes.size(); ++v) {
      const auto& groups = volumes[v].desc.groups;
      for (std::uint8_t group = 0; group < groups.size(); ++group) {
        const BlockMask all(block_count(groups[group].textures.front().desc), 1);
        static_cast<void>(c.client.subscribe(v, all, group));
      }
    }
    send(c);
    c.subscribed = true;
  }

  static void done(Simulated& c) {
    c.done = true;
    if (c.open && c.client.disconnect() == Status::ok) send(c);
  }

  /// The server closes: see ClientLink::leave().
  void leave() {
    for (Simulated& c : clients_) {
      if (!c.done) done(c);
    }
    const double end = now() + kGoodbye;
    const auto open = [](const Simulated& c) { return c.open; };
    while (now() < end && std::any_of(clients_.begin(), clients_.end(), open)) {
      if (!look_around()) std::this_thread::sleep_for(kIdle);
    }
    for (Simulated& c : clients_) {
      if (c.open) c.net.abandon(c.link);
    }
  }

  SimulateResult finish() {
    result_.fewest_updates = UINT64_MAX;
    for (const Simulated& c : clients_) {
      const ClientStatistics& s = c.client.statistics();
      result_.fewest_updates = std::min(result_.fewest_updates, c.client.frame().serial);
      result_.served += c.client.frame().serial > 0 ? 1 : 0;
      result_.bytes += s.bytes;
      result_.blocks += s.blocks;
      result_.gaps += s.gaps;
      result_.proofs += s.proofs;
      result_.failed_proofs += s.failed_proofs;
    }
    result_.seconds = last_ - first_;
    return std::move(result_);
  }

  const SimulateOptions& options_;
  const CameraPath& path_;
  std::deque<Net> nets_;
  std::deque<Simulated> clients_;
  std::string why_;  ///< why the last connection ended, if known
  SimulateResult result_;
  double first_ = -1, last_ = -1, attended_ = 0;
};

}  // namespace

SimulateResult simulate(const SimulateOptions& options, const CameraPath& path) {
  return LoadTest(options, path).run();
}

}  // namespace gicodec::streaming

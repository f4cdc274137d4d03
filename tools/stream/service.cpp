#include "service.h"

#include "clock.h"
#include "common/program.h"
#include "common/volume_words.h"
#include "dump/dump.h"
#include "dump/error.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace gicodec::streaming {
namespace {

constexpr double kSettleSeconds = 10;  ///< for the last updates to be acknowledged
constexpr double kPoll = 1e-3;
constexpr double kLogBurst = 500, kLogRate = 10;  ///< lines, and lines per second
constexpr std::uintptr_t kNoConnection = 0;

}  // namespace

void Service::log_text(const std::string& text) {
  if (options_.quiet || !log_limit_.pass(now())) return;
  if (isatty(STDERR_FILENO) != 0) clear_status();
  if (const std::uint64_t lines = log_limit_.left_out(); lines > 0)
    log_line("{} gi-server: {} left out: clients come and go too fast", utc_time(),
             lines == 1 ? "1 line is" : fmt::format("{} lines are", lines));
  log_line("{} gi-server: {}", utc_time(), text);
}

Service::Service(const ServiceOptions& options, Server server, std::shared_ptr<Access> access,
                 const Feed& feed, std::unique_ptr<Views> views,
                 const std::vector<std::vector<StreamedTexture>>& textures,
                 std::unique_ptr<NatsPublisher> nats)
    : options_(options),
      server_(std::move(server)),
      access_(std::move(access)),
      volumes_(feed.volumes),
      remarks_(feed.remarks),
      played_(feed.played),
      views_(std::move(views)),
      net_(options.listen, options.web, options.net),
      control_(options.control.empty() ? std::optional<Control>()
                                       : std::optional<Control>(std::in_place, options.control)),
      statistics_(options.statistics, feed.volumes),
      log_limit_(kLogBurst, kLogRate),
      nats_(std::move(nats)),
      tracer_(feed.next),
      updater_([this](double now) {
        return tracks_ ? tracks_->update(now, time_) : server_.update(now, time_);
      }) {
  for (std::size_t v = 0; v < volumes_.size(); ++v) {
    const FeedVolume& volume = volumes_[v];
    const auto id = server_.add_volume(volume.name, volume.desc, volume.geometry, textures[v]);
    tools::check(id.status(), "volume " + volume.name);
    const bool voxels = volume.desc.kind == kKindVoxels;
    const BlockShape block = volume.desc.groups.front().textures.back().desc.block;
    viewed_.push_back({volume.geometry, voxels ? block.y : std::uint8_t{0}});
  }
  begin_tracks();
  if (views_) {
    viewer_.emplace([this](const ViewRequest& request) { return views_->look(request); });
  }
}

/// Traces the first frame, before clients may connect.
void Service::begin() {
  request_frame();
  while (!fresh_) {
    if (const auto frame = tracer_.take()) publish(*frame);
    serve_control();
    show();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  for (const std::string& remark : remarks_) log("{}", remark);
  std::vector<std::uint16_t> ports = net_.ports();
  write_ports(options_.port_file, ports);
  std::string where, page;
  for (const Address* address : {options_.listen ? &*options_.listen : nullptr,
                                 options_.web ? &options_.web->address : nullptr}) {
    if (address == nullptr) continue;
    const Address at{address->host, ports.front(), address->via};
    where += (where.empty() ? "" : " and ") + to_string(at);
    if (at.via != Via::enet && !options_.web->page.empty()) {
      page = fmt::format("http{}://{}/?server{}", at.via == Via::web ? "s" : "",
                         to_string(Address{at.host, at.port, Via::enet}),
                         options_.web->scene.empty() ? "" : "&scene=scene.glb");
    }
    ports.erase(ports.begin());
  }
  std::string what;
  for (const FeedVolume& volume : volumes_) {
    what += what.empty() ? "" : ", ";
    if (is_probes(volume)) {
      what += fmt::format("{} probes", tools::to_string(volume.geometry.grid));
      continue;
    }
    std::uint64_t blocks = 0;
    for (const TextureGroup& group : volume.desc.groups)
      blocks += block_count(group.textures[0].desc);
    what += fmt::format("{}: {}", tools::kind_text(volume.desc.kind), count(blocks, "block"));
  }
  if (is_probes(volumes_[0])) what += fmt::format(", {} active", active_);
  log("{}; listening on {}", what, where);
  if (!page.empty()) log("to look at it in a browser: {}", page);
}

void Service::update() {
  const auto begin = now();
  // An error concerns single clients, which were dropped or have blocks pending: go on.
  updater_.submit(begin);
  const Status status = update_and_listen();
  if (status != Status::ok) log("update {} is not complete: {}", made_ + 1, to_string(status));
  publish_tracks();
  ++made_;
  const double seconds = now() - begin;
  // In lockstep frames may take any time.
  if (!options_.lockstep) server_.report_update_time(seconds, 1 / options_.rate);
  statistics_.updated(server_,
                      {made_, time_, fresh_ ? trace_seconds_ : -1, seconds, active_, begin});
  fresh_ = false;
}

/// Reads the network while an update is made, so that nothing is lost there. The server gets the
/// messages afterwards.
Status Service::update_and_listen() {
  constexpr std::size_t kMaxBytes = 16 << 20;
  std::vector<NetEvent> arrived;
  std::size_t bytes = 0;
  std::optional<Status> status;
  try {
    while (bytes < kMaxBytes && !(status = updater_.take())) {
      NetEvent event;
      if (!net_.next(event, 1)) continue;
      bytes += sizeof event + event.message.size();
      arrived.push_back(std::move(event));
      // The link must not be reused before the server knows.
      if (arrived.back().type == NetEvent::Type::closed) break;
    }
  } catch (...) {
    if (!updater_.idle()) static_cast<void>(updater_.wait());  // The shutdown uses the server.
    throw;
  }
  if (!status) status = updater_.wait();
  for (NetEvent& event : arrived) handle(event);
  return *status;
}

void Service::open(Link link) {
  const auto id = server_.connect(now(), Net::host_of(link));
  if (!id) {
    Message message;
    if (write_message(Goodbye{Reason::full, std::string(to_string(Reason::full))}, message) ==
        Status::ok) {
      net_.send(link, {message});
    }
    ++dropped_[Reason::full];
    log("{} turned away: {} (--max-clients)", Net::address_of(link), to_string(Reason::full));
    return net_.close(link);
  }
  Net::set_tag(link, *id);
  Connection& connection = connections_[*id];
  connection.link = link;
  connection.address = Net::address_of(link);
  access_->opened(*id, Net::host_of(link));
  statistics_.opened(*id, connection.address);
}

void Service::handle(NetEvent& event) {
  if (event.type == NetEvent::Type::opened) return open(event.link);
  const std::uintptr_t tag = Net::tag(event.link);
  if (tag == kNoConnection) return;
  const auto id = static_cast<ConnectionId>(tag);
  if (event.type == NetEvent::Type::received) {
    server_.receive(id, event.message, now());
    take_events();
    send(id);
    return;
  }
  if (event.type == NetEvent::Type::broken) {
    server_.drop(id, event.reason);
    return take_events();
  }
  const auto it = connections_.find(id);
  if (it == connections_.end()) return;
  if (!it->second.closing) {
    log("{} lost {}", it->second.address, account(id, false));
  }
  statistics_.closed(server_, id);
  access_->closed(id);
  server_.disconnect(id, now());
  connections_.erase(it);
  take_events();
}

/// Sends a connection's messages; returns their bytes.
std::size_t Service::send(ConnectionId id) {
  const auto it = connections_.find(id);
  if (it == connections_.end()) return 0;
  std::size_t bytes = 0;
  for (const OutgoingMessage& message : server_.take_messages(id)) {
    bytes += message.size();
    net_.send(it->second.link, message);
  }
  return bytes;
}

/// Sends all messages, and reads the network in between, because every client answers. Begins with
/// another client each time.
void Service::send_all() {
  constexpr std::size_t kAtOnce = 512 << 10;
  std::vector<ConnectionId> ids;
  for (const auto& [id, connection] : connections_) ids.push_back(id);
  if (!ids.empty()) {
    constexpr std::uint64_t kGolden = 0x9E3779B9;
    const auto first = static_cast<std::ptrdiff_t>((made_ * kGolden >> 8) % ids.size());
    std::rotate(ids.begin(), ids.begin() + first, ids.end());
  }
  std::size_t bytes = 0;
  NetEvent event;
  for (const ConnectionId id : ids) {
    bytes += send(id);
    if (bytes < kAtOnce) continue;
    while (net_.next(event, 0)) handle(event);
    bytes = 0;
  }
  net_.flush();
}

bool Service::may_update() {
  if (options_.updates > 0 && made_ >= options_.updates) return false;
  if (made_ == 0 && server_.connections().value_or({}).size() < options_.wait) return false;
  return fresh_ || !(played_ || options_.lockstep);
}

bool Service::all_taken() {
  if (nats_ && nats_->unanswered() > 0) return false;
  for (const ConnectionId id : server_.connections().value_or({})) {
    const auto statistics = server_.statistics(id);
    if (statistics && statistics->in_flight > 0) return false;
  }
  return true;
}

void Service::run() {
  try {
    begin();
    serve();
  } catch (const ddgi::Cancelled&) {
    // Interrupted while tracing.
  } catch (...) {
    say_goodbye();  // There is no frame: clients must not wait for it.
    throw;
  }
  say_goodbye();
  statistics_.check_written();
}

void Service::serve() {
  const double period = 1 / options_.rate;
  double due = now(), finished = -1;
  NetEvent event;
  while (!tools::interrupted()) {
    // If only the frame is missing, polls for it.
    const double left = std::max(due - now(), may_update() ? 0 : kPoll);
    const auto wait = static_cast<unsigned>(std::clamp(std::ceil(left * 1e3), 0.0, 5.0));
    // Takes events before the next update, for a limited time.
    for (bool more = net_.next(event, wait); more; more = net_.next(event, 0)) {
      handle(event);
      if (now() >= due + period) break;
    }
    serve_control();
    attend_tracks();
    if (replaced_) break;
    take_background();
    const double at = now();
    statistics_.tick(server_, at);
    if (const std::string trouble = statistics_.trouble(); !trouble.empty()) log("{}", trouble);
    show();
    if (options_.updates > 0 && made_ >= options_.updates) {
      if (finished < 0) finished = at;
      if (all_taken() || at - finished > kSettleSeconds) break;
    }
    if (at < due) continue;
    server_.tick(at);
    take_events();
    if (!may_update()) {
      request_frame();
      continue;
    }
    request_frame();
    request_views();
    update();
    take_events();
    send_all();
    due += period;
    if (due < now() - period) {
      statistics_.late();
      due = now();
    }
  }
}

void Service::say_goodbye() {
  statistics_.finish(server_, now());
  std::vector<ConnectionId> ids;
  for (const auto& [id, connection] : connections_) {
    if (!connection.closing) ids.push_back(id);
  }
  for (const ConnectionId id : ids) server_.drop(id, Reason::shutdown);
  take_events();
  net_.flush();
  const double end = now() + kGoodbye;
  NetEvent event;
  while (!connections_.empty() && now() < end) {
    if (net_.next(event, 10) && event.type == NetEvent::Type::closed) handle(event);
  }
}

}  // namespace gicodec::streaming

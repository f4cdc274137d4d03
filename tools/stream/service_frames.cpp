// The frames of a service's feed, and which blocks clients see.
#include "service.h"

#include "dump/dump.h"
#include "dump/error.h"
#include "programs/kind_table.h"

#include <algorithm>

namespace gicodec::streaming {

void Service::publish(const FeedFrame& frame) {
  for (const std::string& remark : frame.remarks) log("{}", remark);
  for (std::uint16_t v = 0; v < frame.volumes.size(); ++v) {
    const FeedFrame::Volume& volume = frame.volumes[v];
    tools::check(server_.scroll(v, volume.scroll), "scrolling " + volumes_[v].name);
    tools::check(server_.set_active(v, volume.active), "volume " + volumes_[v].name);
    const auto textures = textures_of(volumes_[v].desc);
    if (viewer_ && volumes_[v].desc.kind == kKindVoxels) {
      const auto& bricks = volume.textures.front();
      viewed_[v].bricks = std::make_shared<const std::vector<std::byte>>(bricks);
      viewed_[v].changed.add(bricks, voxels::BrickShape{viewed_[v].brick_side});
    }
    for (std::uint8_t t = 0; t < volume.textures.size(); ++t) {
      const Status status = server_.publish(v, t, ConstTextureView{volume.textures[t]});
      // Clients keep what they hold until there is memory.
      if (status == Status::out_of_memory) {
        log("texture {}: {}", textures[t]->name, to_string(status));
        continue;
      }
      tools::check(status, "texture " + textures[t]->name);
    }
  }
  active_ = 0;
  for (const std::uint8_t active : frame.volumes.front().active) active_ += active != 0 ? 1 : 0;
  if (frame.volumes.front().active.empty())
    active_ = block_count(volumes_.front().desc.groups.front().textures.front().desc);
  time_ = frame.time;
  trace_seconds_ = frame.seconds;
  fresh_ = true;
  if (!played_ && !options_.lockstep) tell_pace();
}

/// Warns once if frames keep taking longer than updates.
void Service::tell_pace() {
  constexpr unsigned kFrames = 3;  // The first frame traces much that later ones reuse.
  const double period = 1 / options_.rate;
  const bool remarked = slow_frames_ == kFrames;
  if (remarked) return;
  slow_frames_ = trace_seconds_ > period ? slow_frames_ + 1 : 0;
  if (slow_frames_ < kFrames) return;
  log("a frame takes {:.2g} s to trace, and updates come every {:.2g} s: light changes as frames "
      "are done; --rate {:.2g}, or less to trace, makes it even",
      trace_seconds_, period, std::min(options_.rate, 0.8 / trace_seconds_));
}

/// Requests the frame for the next update from a live feed, the next in order from others.
void Service::request_frame() {
  if (!tracer_.idle()) return;
  if (options_.updates > 0 && requested_ >= options_.updates && (played_ || options_.lockstep))
    return;
  const std::uint64_t number = options_.lockstep ? requested_ : made_ + (requested_ > 0 ? 1 : 0);
  FeedRequest request{options_.start + static_cast<double>(number) / options_.rate};
  for (const ConnectionId id : server_.connections().value_or({})) {
    const auto view = server_.viewpoint(id);
    if (view) request.viewers.push_back(*view);
    request.all = request.all || !view;
  }
  request.all = request.all || nats_;
  ++requested_;
  tracer_.submit(request);
}

void Service::request_views() {
  if (!viewer_ || !viewer_->idle()) return;
  for (std::uint16_t v = 0; v < volumes_.size(); ++v) viewed_[v].geometry = *server_.geometry(v);
  ViewRequest request{time_, viewed_, {}};
  for (const auto& [id, connection] : connections_) {
    const auto view = server_.viewpoint(id);
    if (view && !connection.chooses) request.viewers.emplace_back(id, *view);
  }
  if (!request.viewers.empty()) viewer_->submit(std::move(request));
}

void Service::take_background() {
  // Where frames have an order, a frame must be in an update before the next replaces it.
  if (!fresh_ || !(played_ || options_.lockstep)) {
    if (const auto frame = tracer_.take()) publish(*frame);
  }
  if (!viewer_) return;
  const auto result = viewer_->take();
  if (!result) return;
  statistics_.viewed(result->seconds);
  for (const ViewResult::Seen& seen : result->seen) {
    const auto it = connections_.find(seen.connection);
    if (it == connections_.end() || it->second.chooses || !server_.client(seen.connection))
      continue;
    for (std::uint16_t v = 0; v < seen.volumes.size(); ++v) {
      // Clients see all blocks of other volumes.
      const auto& groups = volumes_[v].desc.groups;
      const bool culled = kinds::is_culled(volumes_[v]);
      if (culled) set_visible(seen.connection, v, seen.volumes[v], 0);
      for (std::uint8_t group = culled ? 1 : 0; group < groups.size(); ++group) {
        const BlockMask all(block_count(groups[group].textures.front().desc), 1);
        set_visible(seen.connection, v, all, group);
      }
    }
  }
}

/// Hides everything from a client until its view is known.
void Service::show_nothing(ConnectionId id) {
  for (std::uint16_t v = 0; v < volumes_.size(); ++v) {
    for (std::uint8_t group = 0; group < volumes_[v].desc.groups.size(); ++group)
      set_visible(id, v, {}, group);
  }
}

/// Ignores clients that are gone or for which there is no memory.
void Service::set_visible(ConnectionId id, std::uint16_t volume,
                          std::span<const std::uint8_t> blocks, std::uint8_t group) {
  const Status status = server_.set_visible(id, volume, blocks, group);
  if (status != Status::ok && status != Status::unknown_connection)
    log("what is seen of {}: {}", volumes_[volume].name, to_string(status));
}

}  // namespace gicodec::streaming

#include "viewer.h"

#include "clock.h"
#include "common/program.h"
#include "common/volume_words.h"
#include "ddgi/scene_id.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "log.h"

#include <gicodec/probes.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

namespace gicodec::streaming {
namespace {

constexpr double kSettle = 5;   ///< seconds to decode what has arrived
constexpr double kHaste = 0.2;  ///< the same after an interrupt

/// "color of villa: off by at most 2", for each texture that is not lossless.
std::vector<std::string> lossy_textures(const ClientFrame& frame) {
  std::vector<std::string> lossy;
  for (const ClientVolume& volume : frame.volumes) {
    for (const ClientTexture& texture : volume.textures) {
      const std::string error = tools::error_text(texture.largest_error);
      if (!error.empty())
        lossy.push_back(fmt::format("{} of {}: {}", texture.name, volume.name, error));
    }
  }
  return lossy;
}

class Viewer {
 public:
  Viewer(const ViewerOptions& options, const CameraPath& path, Renderer* renderer)
      : options_(options),
        path_(path),
        renderer_(renderer),
        client_(tools::take(
            ClientThread::start(tools::take(Client::create(options.client), "client")), "client")),
        link_(options.link, client_) {}

  ViewerResult run() {
    if (path_.known()) look(0);
    while (!tools::interrupted()) {
      const double at = now();
      // Reads the state first: updates that came before the end still count.
      const bool ended =
          link_.state() == ClientLink::State::ended || link_.state() == ClientLink::State::failed;
      if (result_.connect_seconds == 0 && link_.connections() > 0)
        result_.connect_seconds = at - begin_;
      const ClientFrame& frame = client_.latest();
      if (frame.serial != seen_) take(frame, at);
      if (options_.seconds > 0 && at - begin_ > options_.seconds) break;
      if (enough(frame)) break;
      if (renderer_ != nullptr && result_.frames < options_.frames && frame.serial > 0 &&
          at >= next_picture_) {
        if (holds_light(frame)) {
          draw(frame, at);
          continue;
        }
        say_waiting();
      }
      if (ended) break;
      if (options_.status) status(frame, at);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return finish();
  }

 private:
  [[nodiscard]] bool enough(const ClientFrame& frame) const {
    if (options_.updates == 0 && options_.frames == 0) return false;
    return frame.serial >= options_.updates && result_.frames >= options_.frames;
  }

  /// True if a picture can be drawn. Probes need irradiance and visibility; of other kinds one
  /// texture with contents suffices.
  [[nodiscard]] static bool holds_light(const ClientFrame& frame) {
    if (frame.volumes.empty()) return false;
    const ClientVolume& first = frame.volumes.front();
    const auto any = [](const ClientTexture& texture) {
      return std::ranges::any_of(texture.changed, [](std::uint64_t serial) { return serial > 0; });
    };
    return first.desc.kind == kKindProbes ? std::ranges::all_of(first.textures, any)
                                          : std::ranges::any_of(first.textures, any);
  }

  void say_waiting() {
    if (!std::exchange(said_waiting_, true) && !options_.link.quiet) {
      log_line("gi-client: pictures begin when light has come");
    }
  }

  void take(const ClientFrame& frame, double at) {
    const auto refused =
        options_.scene ? ddgi::refusal(*options_.scene, frame.scene) : std::nullopt;
    if (refused) tools::fail(tools::Exit::bad_input, "{}", *refused);
    if (seen_ != 0) result_.longest_pause = std::max(result_.longest_pause, at - last_);
    if (seen_ == 0) {
      first_ = next_picture_ = at;
      began_ = frame.began;
    }
    if (frame.began != subscribed_) subscribe(frame);
    subscribed_ = frame.began;
    seen_ = frame.serial;
    last_ = at;
    if (path_.known()) look(frame.time);
  }

  void look(double time) { link_.set_viewpoint(viewpoint(path_.at(time), options_.aspect, time)); }

  void subscribe(const ClientFrame& frame) {
    if (!options_.subscribe_all && !options_.subscribe) return;
    for (std::uint16_t v = 0; v < frame.volumes.size(); ++v) {
      const auto& groups = frame.volumes[v].desc.groups;
      for (std::uint8_t group = 0; group < groups.size(); ++group) {
        const TextureDesc& desc = groups[group].textures.front().desc;
        BlockMask mask(block_count(desc), options_.subscribe_all ? 1 : 0);
        if (options_.subscribe && v == 0 && group == 0) mark(*options_.subscribe, desc.grid, mask);
        link_.subscribe(v, group, mask);
      }
    }
  }

  static void mark(const tools::BlockBox& box, Grid g, BlockMask& mask) {
    if (box.last[0] >= g.x || box.last[1] >= g.y || box.last[2] >= g.z)
      tools::fail(tools::Exit::bad_input, "--subscribe: the server's grid is {}",
                  tools::to_string(g));
    for (std::uint32_t probe = 0; probe < mask.size(); ++probe) {
      const std::array at{probe % g.x, probe / g.x % g.y, probe / (g.x * g.y)};
      bool in = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        in = in && at[axis] >= box.first[axis] && at[axis] <= box.last[axis];
      }
      mask[probe] = in ? 1 : 0;
    }
  }

  void draw(const ClientFrame& frame, double at) {
    const ddgi::Camera camera = path_.known() ? path_.at(frame.time) : ddgi::Camera{};
    try {
      result_.render_seconds += renderer_->draw(frame, camera, result_.frames);
      ++result_.frames;
    } catch (const ddgi::Cancelled&) {
      return;  // Interrupted.
    }
    next_picture_ = std::max(next_picture_ + 1 / options_.fps, at);
  }

  void status(const ClientFrame& frame, double at) {
    if (at - shown_ < 0.5) return;
    shown_ = at;
    const ClientStatistics s = client_.statistics();
    show_status("update {}, {:.2f} MB received, {} drawn{}", frame.update,
                static_cast<double>(s.bytes) * 1e-6, count(result_.frames, "frame"),
                link_.state() == ClientLink::State::open ? "" : ", connecting");
  }

  ViewerResult finish() {
    if (shown_ > 0) clear_status();
    const double end = now() + (tools::interrupted() ? kHaste : kSettle);
    while (!client_.idle() && now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    result_.round_trip_ms = link_.round_trip_ms();
    link_.close();
    result_.state = link_.state();
    result_.message = link_.message();
    const Status status = client_.status();
    result_.unusable = status != Status::ok && status != Status::end;
    result_.statistics = client_.statistics();
    result_.updates = client_.latest().serial;
    for (const ClientVolume& volume : client_.latest().volumes) {
      for (const ClientTexture& texture : volume.textures) {
        result_.blocks += texture.changed.size();
        result_.held += texture.changed.size() - static_cast<std::uint64_t>(std::ranges::count(
                                                     texture.changed, std::uint64_t{0}));
      }
    }
    result_.lossy = lossy_textures(client_.latest());
    result_.connections = link_.connections();
    result_.resumed = client_.latest().began == began_;
    result_.seconds = last_ - first_;
    result_.first_seconds = std::max(first_ - begin_, 0.0);
    result_.all_seconds = now() - begin_;
    return std::move(result_);
  }

  const ViewerOptions& options_;
  const CameraPath& path_;
  Renderer* renderer_;
  ClientThread client_;
  ClientLink link_;
  ViewerResult result_;
  std::uint64_t seen_ = 0, began_ = 0, subscribed_ = 0;
  double begin_ = now(), first_ = 0, last_ = 0, next_picture_ = 0, shown_ = 0;
  bool said_waiting_ = false;
};

}  // namespace

ViewerResult watch(const ViewerOptions& options, const CameraPath& path, Renderer* renderer) {
  return Viewer(options, path, renderer).run();
}

}  // namespace gicodec::streaming

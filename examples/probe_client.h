// What a renderer does to draw with probes that are streamed to it.
#pragma once

#include <gicodec/streaming.h>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

class ProbeClient {
 public:
  using Send = std::function<void(const gicodec::Message&)>;  ///< the engine's: to the server

  static gicodec::Result<ProbeClient> create(const std::string& token, Send send) {
    using namespace gicodec;
    auto client = Client::create({.delivery = Delivery::unicast, .token = token});
    if (!client) return client.status();
    auto thread = ClientThread::start(*std::move(client));
    if (!thread) return thread.status();
    return ProbeClient(*std::move(thread), std::move(send));
  }

  // Network thread. After a loss: connect again; the Hello brings the ticket of the session.
  gicodec::Status connected() {
    const auto hello = thread_.hello();
    if (hello) send_(*hello);
    return hello.status();
  }
  gicodec::Status received(gicodec::Message message) { return thread_.push(std::move(message)); }
  /// Now and then. Anything but ok ends the connection; Status::end: the server said goodbye().
  gicodec::Status answer() {
    for (const auto& reply : thread_.take_messages()) send_(reply);
    return thread_.status();
  }
  /// Whenever it moves, up to some tens of times a second.
  gicodec::Status look_from(const gicodec::Viewpoint& view) { return thread_.set_viewpoint(view); }

  /// Render thread, each frame: never waits, takes no lock. `upload` is the engine's.
  template <typename Upload>
  const gicodec::ClientFrame& draw(const Upload& upload) {
    const gicodec::ClientFrame& frame = thread_.latest();
    for (const gicodec::ClientVolume& volume : frame.volumes) {
      for (const gicodec::ClientTexture& texture : volume.textures) {
        for (std::uint32_t block = 0; block < texture.changed.size(); ++block) {
          if (texture.changed[block] > uploaded_) upload(texture, block);
        }
      }
    }
    uploaded_ = frame.serial;
    return frame;
  }

 private:
  ProbeClient(gicodec::ClientThread&& thread, Send send)
      : thread_(std::move(thread)), send_(std::move(send)) {}

  gicodec::ClientThread thread_;
  Send send_;
  std::uint64_t uploaded_ = 0;  ///< serial of the last frame drawn
};

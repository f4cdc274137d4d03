// The publisher of tracks.
#include <gicodec/track_publisher.h>

#include "c/server.h"
#include "c/track_name.h"

#include <gicodec/c/tracks.h>

#include <optional>

using namespace gicodec;

struct gicodec_track_publisher : c::Handle {
  TrackOptions options;
  std::optional<TrackPublisher> publisher;
  std::size_t told = 0;  ///< messages of the last update
  c::TrackTexts texts;
};

extern "C" {

gicodec_status gicodec_track_publisher_create(gicodec_server* server,
                                              const gicodec_track_publisher_options* options,
                                              gicodec_track_publisher** out) {
  return c::create(
      options, out,
      [&](gicodec_track_publisher& handle, const gicodec_track_publisher_options& given) -> Status {
        if (server == nullptr || !server->has_epoch) return Status::invalid_argument;
        c::set(handle.options.snapshot_seconds, given.snapshot_seconds);
        c::set(handle.options.snapshot_share, given.snapshot_share);
        return c::keep(TrackPublisher::create(*server->server, handle.options), handle.publisher);
      });
}

void gicodec_track_publisher_destroy(gicodec_track_publisher* publisher) { c::destroy(publisher); }

gicodec_status gicodec_track_publisher_update(gicodec_track_publisher* publisher, double now,
                                              double time) {
  return c::call(publisher, [&] {
    const Status status = publisher->publisher->update(now, time);
    publisher->told = 0;
    return status;
  });
}

gicodec_status gicodec_track_publisher_message(gicodec_track_publisher* publisher,
                                               gicodec_track_message* out) {
  return c::call(publisher, [&] {
    const auto messages = publisher->publisher->messages();
    if (publisher->told >= messages.size()) return Status::end;
    const TrackMessage& message = messages[publisher->told];
    gicodec_track_message given{};
    given.type = static_cast<uint32_t>(message.type);
    if (message.type == TrackMessage::Type::object) given.track = c::track_of(message.stream);
    given.number = message.number;
    given.bytes = c::point(message.bytes, &given.size);
    const Status status = c::give(given, out);
    if (status == Status::ok) ++publisher->told;
    return status;
  });
}

gicodec_status gicodec_track_publisher_name(gicodec_track_publisher* publisher,
                                            const gicodec_track* track, gicodec_track_name* out) {
  return c::call(publisher,
                 [&] { return c::give_name(*publisher->publisher, track, publisher->texts, out); });
}

double gicodec_track_publisher_kept_seconds(const gicodec_track_publisher* publisher) {
  return publisher == nullptr ? 0 : kept_seconds(publisher->options);
}

gicodec_status gicodec_track_publisher_repeat_snapshots(gicodec_track_publisher* publisher) {
  return c::call(publisher, [&] {
    publisher->publisher->repeat_snapshots();
    return Status::ok;
  });
}

}  // extern "C"

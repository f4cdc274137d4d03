// The receiver of tracks.
#include <gicodec/track_receiver.h>

#include "c/track_name.h"

#include <gicodec/c/tracks.h>

#include <optional>
#include <utility>
#include <vector>

using namespace gicodec;

struct gicodec_track_receiver : c::Handle {
  std::optional<TrackReceiver> receiver;
  std::vector<Message> messages;  ///< for the client
  std::size_t told = 0;           ///< of these
  std::vector<gicodec_track> wanted;
  TrackRequests taken;  ///< that the caller has not got
  std::vector<gicodec_track_object> requests;
  c::TrackTexts texts;
};

extern "C" {

gicodec_status gicodec_track_receiver_create(const gicodec_track_receiver_options* options,
                                             gicodec_track_receiver** out) {
  return c::create(
      options, out,
      [&](gicodec_track_receiver& handle, const gicodec_track_receiver_options& given) -> Status {
        TrackReceiverOptions settings;
        settings.reach = given.reach;
        settings.subscribed_only = given.subscribed_only != 0;
        c::set(settings.max_tracks, given.max_tracks);
        if (given.max_waiting_bytes > SIZE_MAX) return Status::invalid_argument;
        c::set(settings.max_waiting_bytes, static_cast<std::size_t>(given.max_waiting_bytes));
        return c::keep(TrackReceiver::create(settings), handle.receiver);
      });
}

void gicodec_track_receiver_destroy(gicodec_track_receiver* receiver) { c::destroy(receiver); }

gicodec_status gicodec_track_receiver_receive(gicodec_track_receiver* receiver, const void* message,
                                              size_t size) {
  return c::call(receiver, [&] {
    if (c::is_missing(message, size)) return Status::invalid_argument;
    return receiver->receiver->receive(c::bytes(message, size));
  });
}

gicodec_status gicodec_track_receiver_take(gicodec_track_receiver* receiver, const void* message,
                                           size_t size) {
  return c::call(receiver, [&] {
    if (c::is_missing(message, size)) return Status::invalid_argument;
    return receiver->receiver->take(c::bytes(message, size));
  });
}

const uint8_t* gicodec_track_receiver_message(gicodec_track_receiver* receiver, size_t* size) {
  std::span<const std::byte> found;
  (void)c::call(receiver, [&]() -> Status {
    if (receiver->told == receiver->messages.size()) {
      receiver->messages.clear();
      receiver->told = 0;
      const Status status = c::keep(receiver->receiver->take_messages(), receiver->messages);
      if (status != Status::ok) return status;
    }
    if (receiver->told < receiver->messages.size()) found = receiver->messages[receiver->told++];
    return Status::ok;
  });
  return c::point(found, size);
}

gicodec_status gicodec_track_receiver_wanted(gicodec_track_receiver* receiver,
                                             const gicodec_track** tracks, size_t* count) {
  return c::call(receiver, [&] {
    if (tracks == nullptr || count == nullptr) return Status::invalid_argument;
    receiver->wanted.clear();
    for (const StreamId stream : receiver->receiver->wanted())
      receiver->wanted.push_back(c::track_of(stream));
    *tracks = c::point(std::span<const gicodec_track>(receiver->wanted), count);
    return Status::ok;
  });
}

gicodec_status gicodec_track_receiver_requests(gicodec_track_receiver* receiver, uint32_t* list,
                                               const gicodec_track_object** objects,
                                               size_t* count) {
  return c::call(receiver, [&] {
    if (list == nullptr || objects == nullptr || count == nullptr) return Status::invalid_argument;
    TrackRequests& taken = receiver->taken;
    if (!taken.list && taken.objects.empty()) {
      const Status status = c::keep(receiver->receiver->take_requests(), taken);
      if (status != Status::ok) return status;
    }
    receiver->requests.clear();
    for (const auto& [stream, number] : taken.objects)
      receiver->requests.push_back({c::track_of(stream), number});
    *list = taken.list ? 1 : 0;
    taken = {};
    *objects = c::point(std::span<const gicodec_track_object>(receiver->requests), count);
    return Status::ok;
  });
}

gicodec_status gicodec_track_receiver_name(gicodec_track_receiver* receiver,
                                           const gicodec_track* track, gicodec_track_name* out) {
  return c::call(receiver,
                 [&] { return c::give_name(*receiver->receiver, track, receiver->texts, out); });
}

gicodec_status gicodec_track_receiver_get_state(const gicodec_track_receiver* receiver,
                                                gicodec_track_receiver_state* out) {
  return c::call(receiver, [&] {
    const TrackReceiver& from = *receiver->receiver;
    const TrackReceiverStatistics& statistics = from.statistics();
    gicodec_track_receiver_state state{};
    state.wants_hello = from.wants_hello() ? 1 : 0;
    state.complete = from.complete() ? 1 : 0;
    state.wanted_changes = from.wanted_changes();
    state.ticks = statistics.ticks;
    state.objects = statistics.objects;
    state.repeated = statistics.repeated;
    state.earlier = statistics.earlier;
    state.damaged = statistics.damaged;
    state.requests = statistics.requests;
    return c::give(state, out);
  });
}

}  // extern "C"

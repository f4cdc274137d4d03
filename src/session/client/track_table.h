// The tracks of a list: what is held of each, what has come of it, and which are wanted.
#pragma once

#include <gicodec/protocol.h>
#include <gicodec/track_receiver.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gicodec {

/// An object that waits for those before it. `object` refers to `bytes`.
struct WaitingObject {
  Message bytes;
  TrackObject object;
};

struct Track {
  StreamId stream = {};
  std::uint64_t at = 0;         ///< update of the last object that the client got; 0: none
  std::uint32_t number = 0;     ///< of that object
  std::uint64_t confirmed = 0;  ///< a tick as of which `last` was the last object; 0: none
  std::uint64_t last = 0;       ///< its update
  std::uint64_t snapshot = 0;   ///< update of the last one, by the list; 0: there is none
  bool asks = false;            ///< objects are to be requested
  HeldState sent = {};          ///< that the client holds after that object
  std::optional<WaitingObject> newest_snapshot;
  std::map<std::uint64_t, WaitingObject> updates;  ///< by their updates

  void forget_held() noexcept { at = confirmed = 0, number = 0, sent = {}; }
  void forget_waiting() noexcept { newest_snapshot.reset(), updates.clear(); }
};

/// Tracks that the client must get together: those of a bundled group's textures in a region, or
/// of all groups whose blocks depend on others.
struct TrackUnit {
  std::uint16_t volume = 0;  ///< in TrackTable::volumes
  std::uint8_t group = 0;
  std::uint32_t region = 0;
  bool whole = false;  ///< all of the volume
  bool wanted = false;
  float distance = 0;        ///< from the viewpoint
  std::uint32_t behind = 0;  ///< ticks since something was missing
  std::vector<Track> tracks = {};
};

/// What the client wishes to see.
struct TrackInterest {
  std::map<std::pair<std::uint16_t, std::uint8_t>, BlockMask> blocks;  ///< by volume and group
  std::optional<Viewpoint> viewpoint;
  float reach = 0;
  bool subscribed_only = false;
};

class TrackTable {
 public:
  /// The tracks of these volumes. unknown_kind, limit_exceeded, corrupt, out_of_memory.
  [[nodiscard]] static Result<TrackTable> create(TrackList list, const TrackReceiverOptions&);
  /// Takes the snapshots of a later list; the volumes are the same. corrupt changes nothing.
  Status take(TrackList list);
  /// Chooses the wanted units, and brings the nearest first into wanted(). True if that changed.
  bool choose(const TrackInterest& interest);

  [[nodiscard]] const TrackList& list() const noexcept { return list_; }
  [[nodiscard]] std::vector<TrackUnit>& units() noexcept { return units_; }
  [[nodiscard]] std::span<const StreamId> wanted() const noexcept { return wanted_; }
  /// Null for a stream that does not exist.
  [[nodiscard]] std::pair<TrackUnit*, Track*> find(StreamId stream) noexcept;
  [[nodiscard]] std::optional<TrackName> name(StreamId stream) const noexcept;
  /// The index in its unit of the track that has the presence of this one's records; nullopt: none
  /// has.
  [[nodiscard]] std::optional<std::uint32_t> presence_of(StreamId stream) const noexcept;
  /// The index in list().volumes; nullopt if there is none of that number.
  [[nodiscard]] std::optional<std::size_t> volume(std::uint16_t id) const noexcept;
  [[nodiscard]] std::uint32_t blocks(std::size_t volume, std::uint8_t group) const noexcept;
  [[nodiscard]] std::size_t groups(std::size_t volume) const noexcept {
    return volumes_[volume].groups.size();
  }
  /// Sets the places of the volumes, for choose().
  void scroll(std::span<const Scroll> scrolls) noexcept;

 private:
  [[nodiscard]] bool has_tracks_of(const TrackList& list) const noexcept;
  void take_snapshots() noexcept;
  Status add_volume(std::uint16_t volume, std::uint32_t max_tracks);
  [[nodiscard]] float distance(const TrackUnit& unit, const Position& eye) const noexcept;
  [[nodiscard]] bool is_chosen(const TrackUnit& unit, const TrackInterest& interest) const;

  TrackList list_;
  std::vector<VolumeDesc> volumes_;  ///< as list().volumes
  std::vector<TrackUnit> units_;
  std::map<StreamId, std::pair<std::uint32_t, std::uint32_t>> places_;  ///< unit, track in it
  std::vector<StreamId> wanted_;
};

}  // namespace gicodec

// The state of a Client.
#pragma once

#include <gicodec/client.h>
#include <gicodec/decoder.h>

#include "session/client/interest.h"

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gicodec {

/// One chain of packets, and the places of its blocks in the volume.
struct Chain {
  Decoder decoder;
  std::vector<std::uint32_t> blocks;  ///< of the volume, by block; empty for the whole volume
  /// A packet since the last keyframe may depend on more than the mirror.
  bool stateful = false;
};

struct Client::State {
  Status take(const Welcome& welcome);
  Status take(const Volumes& volumes);
  Status take(const UpdateMessage& update);
  Status check(const UpdateMessage& update) const;
  void scroll(const UpdateMessage& update);
  Status apply(const UpdateMessage::Part& part);
  [[nodiscard]] bool proven(const UpdateMessage::Proof& proof);
  Status ask_again();
  Status reply(const AnyMessage& message);
  [[nodiscard]] Result<Chain*> chain(StreamId id);
  [[nodiscard]] std::vector<HeldState> held() const;
  [[nodiscard]] bool exists(StreamId id) const noexcept;
  [[nodiscard]] bool has_texels() const noexcept { return options.texels && !options.discard; }
  [[nodiscard]] bool describes(std::span<const DescribedVolume> said) const;
  Status ask();
  Status begin(const Welcome& welcome);
  Status follow(std::span<const DescribedVolume> said);
  /// The stream that holds the presence of this one, if any.
  [[nodiscard]] std::optional<StreamId> presence_of(StreamId id) const;
  [[nodiscard]] Status set_presence(StreamId id, Decoder& decoder);
  [[nodiscard]] bool presence_holds(const StreamId& stream, std::uint32_t block) const;

  ClientOptions options;
  Ticket ticket = {};
  std::uint32_t sync = 0;         ///< of the last Hello or Resync
  std::uint32_t last_number = 0;  ///< of the last update applied since this sync point
  std::uint32_t unanswered = 0;   ///< messages of earlier sync points since the last request
  bool welcome = false, resumed = false, consistent = false, requested = false, left = false;
  Interest interest;
  std::uint32_t generation = 0;            ///< of the volumes
  std::vector<DescribedVolume> described;  ///< of the session, as frame.volumes
  std::uint64_t instances = 0;             ///< volumes so far, see ClientVolume::instance
  ClientFrame frame;
  unsigned frames = 1;  ///< copies of the frame that the program holds, itself included
  std::map<StreamId, Chain> chains;
  std::shared_ptr<DecoderScratch> decoding;
  std::vector<std::uint32_t> places;  ///< in the volume, of blocks that a packet changed
  struct {
    std::vector<std::uint32_t> replaced, places;  ///< blocks of a chain, and places in the volume
  } read_lists;                                   ///< scratch of read()
  /// Blocks of presence in the update that is being applied.
  std::vector<std::pair<StreamId, std::uint32_t>> told_presence;
  std::vector<Message> replies;
  std::uint64_t asked = 0, heard = 0;  ///< bytes of Resyncs, and received, over this connection
  Goodbye goodbye;
  ClientStatistics statistics;
};

}  // namespace gicodec

// Records what a Client receives as a container, packet by packet as it came.
#pragma once

#include <gicodec/api.h>
#include <gicodec/client.h>
#include <gicodec/container.h>
#include <gicodec/io.h>
#include <gicodec/protocol.h>
#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace GICODEC_API gicodec {

/// One container, of one session and one list of volumes. To be called by a ClientListener:
///
///     if (recorder && !recorder->fits(client)) { recorder->finish(); ... another sink ... }
///     recorder->add(client, packets);
///
/// What a client holds already when the recording begins comes first, in snapshots that are made
/// here, of one stream after the other. Nothing else is coded; only the number of a texture in the
/// heads of packets is another one if there are several volumes.
class ClientRecorder {
 public:
  /// The client's volumes as they are, for begin(). Metadata is the caller's to add.
  /// limit_exceeded if a container has no room for so many; out_of_order before there are any.
  [[nodiscard]] static Result<ContainerDescription> describe(const Client& client);
  /// Writes the container's head. `description`: describe()'s. `sink` must outlive the recorder.
  [[nodiscard]] static Result<ClientRecorder> begin(Sink& sink, const Client& client,
                                                    const ContainerDescription& description);
  ClientRecorder(ClientRecorder&&) noexcept;
  ClientRecorder& operator=(ClientRecorder&&) noexcept;
  ~ClientRecorder();

  /// False once the session, or the list of its volumes, is another one: finish() then.
  [[nodiscard]] bool fits(const Client& client) const noexcept;
  /// Adds an update as the frame of its number (ClientFrame::update), after which the container
  /// decodes to what the client holds; without packets there is none. Blocks of a volume that
  /// scrolls come in a second packet of their stream, which takes a frame more: the numbers of
  /// those that follow are higher then, until updates without packets make up for it.
  /// out_of_order unless it fits(); unknown_texture. After another error its frame may not be
  /// whole; the next call makes up for it, or finish() ends the container with what is there.
  Status add(const Client& client, std::span<const UpdateMessage::Part> packets);
  /// Streams that the client holds and the recording does not, until their next keyframe: their
  /// backend remembers more than records, as HEVC does, or so much was lost that snapshots took
  /// more than 16 times what was received, and 64 MiB.
  [[nodiscard]] std::size_t waiting() const noexcept;
  [[nodiscard]] std::uint64_t bytes_written() const noexcept;
  /// Writes the container's end.
  Status finish();

 private:
  struct GICODEC_LOCAL State;
  explicit ClientRecorder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec

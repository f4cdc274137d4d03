// Recorder: the packets that a Client receives in, a container out.
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

/// Writes one container, of one session and one list of volumes. A ClientListener calls it:
///
///     if (recorder && !recorder->fits(client)) { recorder->finish(); ... another sink ... }
///     recorder->add(client, packets);
///
/// The container begins with snapshots of all streams that the client holds, which the recorder
/// encodes. All other packets are copied; with several volumes only the texture number in their
/// headers changes.
class ClientRecorder {
 public:
  /// Describes the client's present volumes, for begin(). The caller may add metadata.
  /// limit_exceeded if they are too many for a container; out_of_order before the first Welcome.
  [[nodiscard]] static Result<ContainerDescription> describe(const Client& client);
  /// Writes the container's header. `description`: that of describe(). `sink` must outlive the
  /// recorder.
  [[nodiscard]] static Result<ClientRecorder> begin(Sink& sink, const Client& client,
                                                    const ContainerDescription& description);
  ClientRecorder(ClientRecorder&&) noexcept;
  ClientRecorder& operator=(ClientRecorder&&) noexcept;
  ~ClientRecorder();

  /// False once the client has another session or list of volumes: finish() then.
  [[nodiscard]] bool fits(const Client& client) const noexcept;
  /// Adds an update as the frame of its number (ClientFrame::update); the container then decodes to
  /// what the client holds. An update without packets adds no frame. A scrolling volume may bring
  /// a second packet of a stream, which takes a further frame; later frames then have higher
  /// numbers, until updates without packets make up for it. out_of_order unless fits();
  /// unknown_texture. After another error the frame may be incomplete; the next add() repairs it,
  /// or finish() ends the container as it stands.
  Status add(const Client& client, std::span<const UpdateMessage::Part> packets);
  /// The number of streams that the client holds and the container lacks until their next keyframe.
  /// Either their backend is_stateful(), or so many packets were lost that repeated snapshots
  /// exceeded 64 MiB plus 16 times the bytes received.
  [[nodiscard]] std::size_t waiting() const noexcept;
  [[nodiscard]] std::uint64_t bytes_written() const noexcept;
  /// Writes the index and end mark.
  Status finish();

 private:
  struct GICODEC_LOCAL State;
  explicit ClientRecorder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec

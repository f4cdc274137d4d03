// gi-client --record: writes the received packets as containers.
#pragma once

#include "dump/error.h"
#include "dump/file.h"

#include <gicodec/io.h>
#include <gicodec/recorder.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gicodec::streaming {

/// Throws tools::Error if the recording's first files would overwrite a file that must stay.
void check_recording(const std::string& path, const tools::InputFiles& inputs,
                     tools::Existing existing);

struct RecordingOptions {
  std::string path;
  tools::Existing existing = tools::Existing::refuse;
  std::uint64_t max_bytes = 0;  ///< of all files, after which the recording ends; 0: no limit
  bool quiet = false;
};

/// Writes a file for each session and each list of volumes in it: x.gic, x.2.gic and so on. A
/// growing file is FILE.partial and has all packets so far. If a file cannot be written, or the
/// server causes far more bytes than it sends, the recording ends; the client continues.
class ClientRecording final : public ClientListener {
 public:
  /// Opens the first file; throws tools::Error.
  explicit ClientRecording(RecordingOptions options);
  ClientRecording(const ClientRecording&) = delete;
  ClientRecording& operator=(const ClientRecording&) = delete;
  /// Calls finish() if the caller has not.
  ~ClientRecording() override;

  void updated(const Client& client,
               std::span<const UpdateMessage::Part> packets) noexcept override;
  /// Gives the last file its name. Call it once the client has ended.
  void finish() noexcept;
  /// The files that are not empty.
  [[nodiscard]] const std::vector<std::string>& files() const noexcept { return files_; }
  /// The files that could not get their names and remain FILE.partial.
  [[nodiscard]] const std::vector<std::string>& left() const noexcept { return left_; }
  /// Bytes of all these files.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// Exit::ok unless the recording failed or is incomplete; a message has said so.
  [[nodiscard]] tools::Exit exit() const noexcept { return exit_; }

 private:
  void open_file();
  void begin(const Client& client);
  void end_file();
  void name_file(std::uint64_t bytes);
  void check_limits(const Client& client);
  void finish_early(tools::Exit exit, const std::string& why);
  void fail(tools::Exit exit, const std::string& message, const char* what_follows) noexcept;
  void require(Status status) const;

  RecordingOptions options_;
  std::string name_, partial_;  ///< of the present file; a device has no partial one
  std::uint32_t number_ = 0;    ///< of the present file
  std::unique_ptr<tools::AtomicFile> file_;
  std::optional<FileSink> sink_;
  std::optional<ClientRecorder> recorder_;  ///< from the first packet on
  std::vector<std::string> files_, left_;
  std::uint64_t written_ = 0, bytes_ = 0;  ///< of finished files; of files that are kept
  bool over_ = false;
  tools::Exit exit_ = tools::Exit::ok;
};

}  // namespace gicodec::streaming

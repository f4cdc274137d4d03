// gi-client --record: what the client receives, as containers.
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

/// Throws tools::Error unless the files that a recording begins with destroy nothing.
void check_recording(const std::string& path, const tools::InputFiles& inputs,
                     tools::Existing existing);

struct RecordingOptions {
  std::string path;
  tools::Existing existing = tools::Existing::refuse;
  std::uint64_t max_bytes = 0;  ///< of all files, after which the recording ends; 0: no limit
  bool quiet = false;
};

/// A file for each session and each list of volumes in it: x.gic, x.2.gic and so on. While it grows
/// a file is FILE.partial, with all that came in it. A file that cannot be written ends the
/// recording, not the client; so does a server that makes it write far more than it sends.
class ClientRecording final : public ClientListener {
 public:
  /// Opens the first file; throws tools::Error.
  explicit ClientRecording(RecordingOptions options);
  ClientRecording(const ClientRecording&) = delete;
  ClientRecording& operator=(const ClientRecording&) = delete;
  /// finish() if that was not done.
  ~ClientRecording() override;

  void updated(const Client& client,
               std::span<const UpdateMessage::Part> packets) noexcept override;
  /// Gives the last file its name. Once the client has ended.
  void finish() noexcept;
  /// Those that are there, with something in them.
  [[nodiscard]] const std::vector<std::string>& files() const noexcept { return files_; }
  /// Those that could not have their names, and are FILE.partial.
  [[nodiscard]] const std::vector<std::string>& left() const noexcept { return left_; }
  /// Of all of these.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// Exit::ok unless the recording failed or is not whole, which has been said.
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
  std::string name_, partial_;  ///< of the present file; none beside a device
  std::uint32_t number_ = 0;    ///< of the present file
  std::unique_ptr<tools::AtomicFile> file_;
  std::optional<FileSink> sink_;
  std::optional<ClientRecorder> recorder_;  ///< once there is something to record
  std::vector<std::string> files_, left_;
  std::uint64_t written_ = 0, bytes_ = 0;  ///< to files that are finished; of those that are there
  bool over_ = false;
  tools::Exit exit_ = tools::Exit::ok;
};

}  // namespace gicodec::streaming

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

/// A file for each session and each list of volumes in it: x.gic, x.2.gic and so on. While it grows
/// a file is FILE.partial, with all that came in it. A file that cannot be written ends the
/// recording, not the client.
class ClientRecording final : public ClientListener {
 public:
  /// Opens the first file; throws tools::Error.
  ClientRecording(std::string path, tools::Existing existing, bool quiet);
  ClientRecording(const ClientRecording&) = delete;
  ClientRecording& operator=(const ClientRecording&) = delete;
  /// finish() if that was not done.
  ~ClientRecording() override;

  void updated(const Client& client,
               std::span<const UpdateMessage::Part> packets) noexcept override;
  /// Gives the last file its name. Once the client has ended.
  void finish() noexcept;
  /// Those that have something in them.
  [[nodiscard]] const std::vector<std::string>& files() const noexcept { return files_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// Exit::ok unless the recording failed, which has been said.
  [[nodiscard]] tools::Exit exit() const noexcept { return exit_; }

 private:
  void open_file();
  void begin(const Client& client);
  void end_file();
  void name_file();
  void fail(tools::Exit exit, const std::string& message) noexcept;
  void require(Status status) const;

  std::string path_, name_;  ///< as given, and of the present file
  tools::Existing existing_;
  bool quiet_;
  std::uint32_t number_ = 0;  ///< of the present file
  std::unique_ptr<tools::AtomicFile> file_;
  std::optional<FileSink> sink_;
  std::optional<ClientRecorder> recorder_;  ///< once there is something to record
  std::vector<std::string> files_;
  std::uint64_t bytes_ = 0;
  tools::Exit exit_ = tools::Exit::ok;
};

}  // namespace gicodec::streaming

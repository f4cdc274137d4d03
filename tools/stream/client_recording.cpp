#include "client_recording.h"

#include "dump/dump.h"
#include "log.h"

#include <gicodec/version.h>

#include <fmt/format.h>

#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace gicodec::streaming {
namespace {

/// Limits the files that a server causes by changing its volumes all the time.
constexpr std::uint32_t kMaxFiles = 1000;
/// Limits the snapshots that a server causes by changing volumes or sessions.
constexpr std::uint64_t kMaxGrowth = 64, kFreeGrowth = std::uint64_t{1} << 30;

/// The end of each message.
constexpr const char* kGoesOn = "; the recording ends here, the client goes on";

/// x.gic, x.2.gic, x.3.gic, ...
std::string numbered(const std::string& path, std::uint32_t number) {
  if (number == 1) return path;
  const std::filesystem::path given(path);
  const bool named = given.extension() == ".gic";
  const std::string base = named ? path.substr(0, path.size() - 4) : path;
  return fmt::format("{}.{}{}", base, number, named ? ".gic" : "");
}

/// The path of a growing file; empty if it is written directly.
std::string partial_of(const std::string& path) {
  std::error_code error;
  std::string target = path;
  if (std::filesystem::is_symlink(path, error))
    target = std::filesystem::weakly_canonical(path, error).string();
  target += ".partial";
  return std::filesystem::exists(target, error) ? target : "";
}

/// True if the path names this open file.
bool names(const std::string& path, std::FILE* file) {
  struct stat opened {
  }, named{};
  return file != nullptr && fstat(fileno(file), &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/// Adds the metadata that "gicodec encode" adds for dumps: layout and geometry.
void note_dumps(ContainerDescription& description) {
  for (TextureEntry& texture : description.textures) {
    Metadata& metadata = texture.metadata;
    const Layout& layout = texture.desc.layout;
    if (layout.slots != Grid{}) metadata.emplace_back("slots", tools::to_string(layout.slots));
    if (layout.pad_before != 0 || layout.pad_after != 0)
      metadata.emplace_back("padding", fmt::format("{} {}", layout.pad_before, layout.pad_after));
    const auto attribute = [&](const char* name, const std::string& value) {
      metadata.emplace_back(fmt::format("attribute:{}", name), value);
    };
    const VolumeGeometry& place = *description.volumes[texture.volume].geometry;
    if (texture.desc.grid == place.grid && place.scroll == Scroll{}) {
      attribute(tools::kOriginAttribute, fmt::format("v3f {}", fmt::join(place.origin, " ")));
      attribute(tools::kSpacingAttribute, fmt::format("v3f {}", fmt::join(place.spacing, " ")));
    }
    if (!description.scene.name.empty())
      attribute(tools::kSceneAttribute, "string " + description.scene.name);
  }
}

}  // namespace

void check_recording(const std::string& path, const tools::InputFiles& inputs,
                     tools::Existing existing) {
  if (path == "-" || path.empty())
    tools::fail(tools::Exit::usage, "--record: expected a file such as x.gic, not \"{}\"", path);
  tools::check_output(path, inputs, existing);
  tools::check_output(numbered(path, 2), inputs, existing);
}

ClientRecording::ClientRecording(RecordingOptions options) : options_(std::move(options)) {
  open_file();
}

ClientRecording::~ClientRecording() { finish(); }

void ClientRecording::require(Status status) const {
  if (status == Status::io_failed)
    tools::fail(tools::Exit::io, "{}: cannot be written: {}", name_, std::strerror(errno));
  tools::check(status, name_);
}

void ClientRecording::open_file() {
  std::error_code error;
  do {
    name_ = numbered(options_.path, ++number_);
  } while (number_ > 1 && number_ <= kMaxFiles && options_.existing == tools::Existing::refuse &&
           std::filesystem::exists(name_, error));
  if (number_ > kMaxFiles)
    tools::fail(tools::Exit::io,
                "{}: the recording has come to {} files, one for each session and each change of "
                "volumes; record to another name",
                options_.path, kMaxFiles);
  file_ = std::make_unique<tools::AtomicFile>(name_, options_.existing,
                                              tools::AtomicFile::Temporary::partial);
  partial_ = partial_of(name_);
  sink_.emplace(file_->stream());
}

void ClientRecording::begin(const Client& client) {
  if (file_ == nullptr) open_file();
  auto described = ClientRecorder::describe(client);
  if (described.status() == Status::limit_exceeded) {
    tools::fail(tools::Exit::bad_input,
                "{}: the server's volumes are more than a container has room for, which is 256 of "
                "256 textures in all",
                name_);
  }
  ContainerDescription description = tools::take(std::move(described), name_);
  note_dumps(description);
  description.metadata.emplace_back("creator", fmt::format("gi-client {}", kVersionString));
  auto recorder = ClientRecorder::begin(*sink_, client, description);
  require(recorder.status());
  recorder_.emplace(*std::move(recorder));
  if (number_ > 1 && !options_.quiet)
    log_line("gi-client: {}: the recording goes on here, with other volumes or another session",
             name_);
}

void ClientRecording::end_file() {
  if (!recorder_) return;
  const std::size_t waiting = recorder_->waiting();
  if (waiting > 0 && !options_.quiet) {
    log_line("gi-client: {}: {} not in it, for want of a keyframe since it began", name_,
             waiting == 1 ? "1 stream is" : fmt::format("{} streams are", waiting));
  }
  require(recorder_->finish());
  const std::uint64_t bytes = recorder_->bytes_written();
  recorder_.reset();
  name_file(bytes);
}

/// Renames the file; keeps it as it is if the name is not available.
void ClientRecording::name_file(std::uint64_t bytes) {
  written_ += bytes;
  const std::unique_ptr<tools::AtomicFile> file = std::move(file_);
  std::error_code error;
  if (!partial_.empty() && !std::filesystem::exists(partial_, error)) {
    tools::fail(tools::Exit::io,
                "{}: was removed or renamed while it was written, so that there is no {}; leave it "
                "until the client has ended",
                partial_, name_);
  }
  try {
    file->commit();
    files_.push_back(name_);
    bytes_ += bytes;
  } catch (const tools::Error& problem) {
    const std::string left = file->leave();
    if (partial_.empty() || !names(partial_, file->stream())) throw;
    left_.push_back(partial_);
    bytes_ += bytes;
    if (left.empty()) throw;  // Its message says so.
    tools::fail(problem.code(), "{}; {} holds what was recorded", problem.what(), left);
  }
}

/// Ends the recording if the server causes far more bytes than it sends.
void ClientRecording::check_limits(const Client& client) {
  const std::uint64_t bytes = written_ + (recorder_ ? recorder_->bytes_written() : 0);
  const std::uint64_t received = client.statistics().bytes;
  if (options_.max_bytes > 0 && bytes >= options_.max_bytes) {
    return finish_early(tools::Exit::ok,
                        fmt::format("the {} MiB of --max-record-mb are full; a larger one, or 0 "
                                    "for no limit, records more",
                                    options_.max_bytes >> 20));
  }
  if (bytes > kFreeGrowth && (bytes - kFreeGrowth) / kMaxGrowth > received) {
    finish_early(
        tools::Exit::different,
        fmt::format("{:.0f} MB are recorded of {:.2f} MB that came, as of a server that "
                    "wants to fill the disk; do not record what it sends",
                    static_cast<double>(bytes) * 1e-6, static_cast<double>(received) * 1e-6));
  }
}

void ClientRecording::finish_early(tools::Exit exit, const std::string& why) {
  end_file();
  over_ = true;
  exit_ = exit;
  log_line("gi-client: {}: {}{}", options_.path, why, kGoesOn);
}

void ClientRecording::fail(tools::Exit exit, const std::string& message,
                           const char* what_follows) noexcept {
  over_ = true;
  exit_ = exit;
  log_line("gi-client: {}{}", message, what_follows);
  if (recorder_) {
    const std::uint64_t bytes = recorder_->bytes_written();
    static_cast<void>(recorder_->finish());
    recorder_.reset();
    try {
      name_file(bytes);
    } catch (const std::exception& error) {
      log_line("gi-client: {}", error.what());
    }
  }
  file_.reset();
}

void ClientRecording::updated(const Client& client,
                              std::span<const UpdateMessage::Part> packets) noexcept {
  if (over_) return;
  try {
    if (recorder_ && !recorder_->fits(client)) end_file();
    if (!recorder_ && packets.empty()) return;
    if (!recorder_) begin(client);
    require(recorder_->add(client, packets));
    check_limits(client);
  } catch (const tools::Error& error) {
    fail(error.code(), error.what(), kGoesOn);
  } catch (const std::exception& error) {
    fail(tools::Exit::internal, error.what(), kGoesOn);
  }
}

void ClientRecording::finish() noexcept {
  if (over_) return;
  over_ = true;
  try {
    end_file();
  } catch (const tools::Error& error) {
    fail(error.code(), error.what(), "");
  } catch (const std::exception& error) {
    fail(tools::Exit::internal, error.what(), "");
  }
  file_.reset();
}

}  // namespace gicodec::streaming

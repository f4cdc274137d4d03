#include "client_recording.h"

#include "ddgi/dump_folder.h"
#include "dump/dump.h"
#include "log.h"

#include <gicodec/version.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace gicodec::streaming {
namespace {

/// A server that changes its volumes all the time does not fill a folder.
constexpr std::uint32_t kMostFiles = 1000;

/// x.gic, x.2.gic, x.3.gic, ...
std::string numbered(const std::string& path, std::uint32_t number) {
  if (number == 1) return path;
  const std::filesystem::path given(path);
  const bool named = given.extension() == ".gic";
  const std::string base = named ? path.substr(0, path.size() - 4) : path;
  return fmt::format("{}.{}{}", base, number, named ? ".gic" : "");
}

/// What "gicodec encode" notes of dumps: where blocks stand in memory and in the world.
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
      attribute(ddgi::kSceneAttribute, "string " + description.scene.name);
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

ClientRecording::ClientRecording(std::string path, tools::Existing existing, bool quiet)
    : path_(std::move(path)), existing_(existing), quiet_(quiet) {
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
    name_ = numbered(path_, ++number_);
  } while (number_ > 1 && number_ <= kMostFiles && existing_ == tools::Existing::refuse &&
           std::filesystem::exists(name_, error));
  if (number_ > kMostFiles)
    tools::fail(tools::Exit::io,
                "{}: the recording has come to {} files, one for each session and each change of "
                "volumes; record to another name",
                path_, kMostFiles);
  file_ =
      std::make_unique<tools::AtomicFile>(name_, existing_, tools::AtomicFile::Temporary::partial);
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
  files_.push_back(name_);
  if (number_ > 1 && !quiet_)
    log_line("gi-client: {}: the recording goes on here, with other volumes or another session",
             name_);
}

void ClientRecording::end_file() {
  if (!recorder_) return;
  const std::size_t waiting = recorder_->waiting();
  if (waiting > 0 && !quiet_) {
    log_line("gi-client: {}: {} streams are not in it, for want of a keyframe since it began",
             name_, waiting);
  }
  require(recorder_->finish());
  bytes_ += recorder_->bytes_written();
  recorder_.reset();
  name_file();
}

/// Where the name cannot be had, what was recorded is kept without.
void ClientRecording::name_file() {
  const std::unique_ptr<tools::AtomicFile> file = std::move(file_);
  try {
    file->commit();
  } catch (const tools::Error& error) {
    const std::string left = file->leave();
    if (left.empty()) throw;
    tools::fail(error.code(), "{}; {} holds what was recorded", error.what(), left);
  }
}

void ClientRecording::fail(tools::Exit exit, const std::string& message) noexcept {
  exit_ = exit;
  log_line("gi-client: {}; the recording ends here, the client goes on", message);
  if (recorder_) {
    bytes_ += recorder_->bytes_written();
    static_cast<void>(recorder_->finish());
    recorder_.reset();
    try {
      name_file();
    } catch (const std::exception& error) {
      log_line("gi-client: {}", error.what());
    }
  }
  file_.reset();
}

void ClientRecording::updated(const Client& client,
                              std::span<const UpdateMessage::Part> packets) noexcept {
  if (exit_ != tools::Exit::ok) return;
  try {
    if (recorder_ && !recorder_->fits(client)) end_file();
    if (!recorder_ && packets.empty()) return;
    if (!recorder_) begin(client);
    require(recorder_->add(client, packets));
  } catch (const tools::Error& error) {
    fail(error.code(), error.what());
  } catch (const std::exception& error) {
    fail(tools::Exit::internal, error.what());
  }
}

void ClientRecording::finish() noexcept {
  if (exit_ != tools::Exit::ok) return;
  try {
    end_file();
  } catch (const tools::Error& error) {
    fail(error.code(), error.what());
  } catch (const std::exception& error) {
    fail(tools::Exit::internal, error.what());
  }
  file_.reset();
}

}  // namespace gicodec::streaming

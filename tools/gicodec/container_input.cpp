#include "container_input.h"

#include "backend_flags.h"
#include "cli.h"
#include "dump/error.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace gicodec::tools {
namespace {

/// Rounded up.
std::uint64_t mebibytes(std::uint64_t bytes) { return (bytes >> 20) + 1; }

}  // namespace

ContainerInput::ContainerInput(const std::string& path)
    : path_(path == "-" ? "standard input" : path),
      file_(path == "-" ? stdin : std::fopen(path.c_str(), "rb")) {
  if (!file_) fail(Exit::io, "{}: cannot be opened: {}", path_, std::strerror(errno));
  std::error_code error;
  if (path != "-" && std::filesystem::is_directory(path, error))
    fail(Exit::io, "{}: is a directory, not a container", path_);
  source_ = std::make_unique<FileSource>(file_.get());
  open();
  for (const TextureEntry& entry : description().textures) {
    textures_.push_back(from_entry(entry, path_));
    const StoredTexture& last = textures_.back();
    for (std::size_t i = 0; i + 1 < textures_.size(); ++i) {
      if (textures_[i].file_name(UINT64_MAX) != last.file_name(UINT64_MAX)) continue;
      fail(Exit::bad_input, "{}: textures {} and {} have files of the same names", path_,
           textures_[i].name, last.name);
    }
  }
  if (source_->size() && !reader_->seekable()) find_missing();
}

void ContainerInput::open() {
  auto reader = ContainerReader::open(*source_);
  if (reader.status() == Status::not_gicodec) {
    fail(Exit::bad_input, "{}: is not a .gic container", path_);
  }
  reader_.emplace(take(std::move(reader), path_));
}

void ContainerInput::find_missing() {
  std::uint64_t frame = 0;
  std::vector<ContainerPacket> packets;
  try {
    while (next_frame(frame, packets)) continue;
  } catch (const Error&) {
    missing_.clear();  // Damage, which the reading to come reports at its place.
  }
  check(source_->seek(0), path_);
  open();
  ahead_.reset();
  first_frame_.reset();
  last_frame_.reset();
  failure_ = Status::ok;
  started_ = false;
}

void ContainerInput::seek(std::uint64_t frame) {
  if (reader_->seekable()) (void)reader_->seek(frame);  // Else all frames are read in order.
}

void ContainerInput::read_ahead() {
  ContainerPacket packet;
  switch (const Status status = reader_->next(packet)) {
    case Status::ok:
      ahead_ = std::move(packet);
      break;
    case Status::end:
      break;
    case Status::truncated:
      missing_ = "its end is missing";
      break;
    default:
      failure_ = status;
  }
}

bool ContainerInput::next_frame(std::uint64_t& frame, std::vector<ContainerPacket>& packets) {
  packets.clear();
  if (!std::exchange(started_, true)) read_ahead();
  if (!ahead_) {
    if (failure_ == Status::ok) {
      if (cut_off()) describe_cut();
      return false;
    }
    const std::string where = last_frame_ ? fmt::format("after frame {}", *last_frame_)
                                          : std::string("before the first frame");
    check(failure_, fmt::format("{}: {}", path_, where));
  }
  frame = ahead_->frame;
  if (!first_frame_) first_frame_ = frame;
  last_frame_ = frame;
  last_textures_.clear();
  while (ahead_ && ahead_->frame == frame) {
    for (const ContainerPacket& other : packets) {
      if (other.texture_id != ahead_->texture_id) continue;
      fail(Exit::bad_input, "{}: frame {} has two packets of texture {}", path_, frame,
           textures_[other.texture_id].name);
    }
    last_textures_.push_back(ahead_->texture_id);
    packets.push_back(*std::exchange(ahead_, std::nullopt));
    read_ahead();
  }
  return true;
}

void ContainerInput::describe_cut() {
  const std::string* all = find_metadata(description().metadata, "frames");
  const std::string planned = all == nullptr ? "" : fmt::format(" of frames {}", *all);
  if (!first_frame_) {
    missing_ = fmt::format("its end is missing: it holds none{}",
                           planned.empty() ? " of its frames" : planned);
    return;
  }
  missing_ = fmt::format("its end is missing: it holds frames {}-{}{}", *first_frame_, *last_frame_,
                         planned);
  if (last_textures_.size() == textures_.size()) return;
  std::string found;
  for (const std::uint8_t id : last_textures_) {
    found += (found.empty() ? "" : ", ") + textures_[id].name;
  }
  missing_ += fmt::format(", and of frame {} only {}", *last_frame_, found);
}

std::string require_complete(const ContainerInput& input, bool allowed) {
  if (!input.cut_off()) return "";
  if (allowed) return fmt::format("{}: {}", input.path(), input.missing());
  fail(Exit::bad_input, "{}: {}; --allow-incomplete goes on with what is there", input.path(),
       input.missing());
}

Exit report_cut_off(const ContainerInput& input, std::size_t frames, bool allowed) {
  if (!input.cut_off()) return Exit::ok;
  remark(fmt::format("{}: {}; {} frame{} before the cut {} recovered", input.path(),
                     input.missing(), frames, frames == 1 ? "" : "s",
                     frames == 1 ? "was" : "were"));
  return allowed ? Exit::ok : Exit::bad_input;
}

TextureStates::TextureStates(const ContainerInput& input, const DecoderFlags& flags)
    : input_(input), flags_(flags), states_(input.textures().size()) {}

TextureStates::State& TextureStates::open(std::size_t texture) {
  State& state = states_[texture];
  if (state.decoder) return state;
  const TextureEntry& entry = input_.description().textures[texture];
  const std::string where = fmt::format("{}: texture {}", input_.path(), entry.name);
  const std::uint64_t limit = flags_.memory << 20;
  const std::uint64_t wanted = memory_ +=
      texture_bytes(entry.desc) + decoder_memory(entry.desc, flags_.threads);
  if (wanted > limit) {
    fail(Exit::bad_input,
         "{}: decoding takes {} MiB with the textures before it, and {} are allowed; "
         "--max-memory {} allows it",
         where, mebibytes(wanted), flags_.memory, mebibytes(wanted));
  }
  state.texels.resize(static_cast<std::size_t>(texture_bytes(entry.desc)));
  state.decoder = make_decoder(entry.desc, flags_, where);
  return state;
}

void TextureStates::apply(const ContainerPacket& packet) {
  const auto where = [&] {
    return fmt::format("{}: frame {}, texture {}", input_.path(), packet.frame,
                       input_.textures()[packet.texture_id].name);
  };
  const auto info = peek(packet.bytes);
  State& state = open(packet.texture_id);
  if (info) load_backend(info->backend);
  const Status status = state.decoder->decode(packet.bytes, TextureView{state.texels});
  if (status == Status::ok) return;
  if (status == Status::backend_missing) {
    const std::string_view name = info ? backend_name(info->backend) : "";
    if (name.empty()) fail(Exit::bad_input, "{}: its backend is unknown here", where());
    fail(Exit::internal, "{}: backend {} is not in this build", where(), name);
  }
  check(status, where());
}

}  // namespace gicodec::tools

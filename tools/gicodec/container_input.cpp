#include "container_input.h"

#include "backend_flags.h"
#include "cli.h"
#include "dump/error.h"

#include <cerrno>
#include <cstring>
#include <utility>

namespace gicodec::tools {

ContainerInput::ContainerInput(const std::string& path)
    : path_(path == "-" ? "standard input" : path),
      file_(path == "-" ? stdin : std::fopen(path.c_str(), "rb")) {
  if (!file_) fail(Exit::io, "{}: cannot be opened: {}", path_, std::strerror(errno));
  source_ = std::make_unique<FileSource>(file_.get());
  auto reader = ContainerReader::open(*source_);
  if (reader.status() == Status::not_gicodec) {
    fail(Exit::bad_input, "{}: is not a .gic container", path_);
  }
  reader_.emplace(take(std::move(reader), path_));
  for (const TextureEntry& entry : description().textures) {
    textures_.push_back(from_entry(entry, path_));
  }
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
      cut_off_ = true;
      break;
    default:
      failure_ = status;
  }
}

bool ContainerInput::next_frame(std::uint64_t& frame, std::vector<ContainerPacket>& packets) {
  packets.clear();
  if (!std::exchange(started_, true)) read_ahead();
  if (!ahead_) {
    if (failure_ == Status::ok) return false;
    const std::string where = last_frame_ ? fmt::format("after frame {}", *last_frame_)
                                          : std::string("before the first frame");
    check(failure_, fmt::format("{}: {}", path_, where));
  }
  frame = ahead_->frame;
  last_frame_ = frame;
  while (ahead_ && ahead_->frame == frame) {
    for (const ContainerPacket& other : packets) {
      if (other.texture_id != ahead_->texture_id) continue;
      fail(Exit::bad_input, "{}: frame {} has two packets of texture {}", path_, frame,
           textures_[other.texture_id].name);
    }
    packets.push_back(*std::exchange(ahead_, std::nullopt));
    read_ahead();
  }
  return true;
}

Exit report_cut_off(const ContainerInput& input, std::size_t frames, bool allowed) {
  if (!input.cut_off()) return Exit::ok;
  remark(fmt::format("{}: its end is missing; {} frame{} before the cut {} recovered", input.path(),
                     frames, frames == 1 ? "" : "s", frames == 1 ? "was" : "were"));
  return allowed ? Exit::ok : Exit::bad_input;
}

TextureStates::TextureStates(const ContainerInput& input, const DecoderFlags& flags)
    : path_(input.path()) {
  for (const TextureEntry& entry : input.description().textures) {
    states_.push_back(
        {make_decoder(entry.desc, flags, fmt::format("{}: texture {}", path_, entry.name)),
         std::vector<std::byte>(static_cast<std::size_t>(texture_bytes(entry.desc))), entry.name});
  }
}

void TextureStates::apply(const ContainerPacket& packet) {
  State& state = states_[packet.texture_id];
  const auto info = peek(packet.bytes);
  if (info) load_backend(info->backend);
  const Status status = state.decoder.decode(packet.bytes, TextureView{state.texels});
  if (status == Status::ok) return;
  const std::string where =
      fmt::format("{}: frame {}, texture {}", path_, packet.frame, state.name);
  if (status == Status::backend_missing) {
    fail(Exit::internal, "{}: backend {} is not in this build", where,
         info ? backend_name(info->backend) : "?");
  }
  check(status, where);
}

}  // namespace gicodec::tools

#include "container_input.h"

#include "cli.h"
#include "dump/error.h"
#include "volume_words.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <numeric>
#include <utility>

namespace gicodec::tools {
namespace {

constexpr const char* kNoEnd = "its end is missing (cut off, or still being written)";
/// More are not worth naming: what is read besides is passed over.
constexpr std::uint64_t kMaxSelected = 1U << 16;

}  // namespace

ContainerInput::ContainerInput(const std::string& path)
    : path_(path == "-" ? "standard input" : path),
      file_(path == "-" ? stdin : std::fopen(path.c_str(), "rb")) {
  if (!file_) fail(Exit::io, "{}: cannot be opened: {}", path_, std::strerror(errno));
  std::error_code error;
  if (path != "-" && std::filesystem::is_directory(path, error))
    fail(Exit::io, "{}: is a directory, not a container", path_);
  source_ = std::make_unique<CountingSource>(file_.get());
  open();
  for (const TextureEntry& entry : description().textures) {
    std::string why_not = no_dump(description(), entry);
    if (why_not.empty()) {
      textures_.push_back(from_entry(entry, path_));
      continue;
    }
    StoredTexture& texture = textures_.emplace_back();
    texture.name = entry.name;
    texture.info.desc = entry.desc;
    texture.lossy = error_text(entry.largest_error);
    texture.no_dump = std::move(why_not);
  }
  selected_.assign(textures_.size(), true);
  if (source_->size() && !reader_->finished()) find_missing();
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
  rewind();
}

void ContainerInput::rewind() {
  check(source_->seek(0), path_);
  open();
  ahead_.reset();
  first_frame_.reset();
  last_frame_.reset();
  failure_ = Status::ok;
  started_ = false;
}

void ContainerInput::select(const std::vector<std::size_t>& textures) {
  selected_.assign(textures_.size(), false);
  std::vector<TextureRegion> wanted;
  bool few = !textures.empty();
  for (const std::size_t texture : textures) {
    selected_[texture] = true;
    const TextureEntry& entry = description().textures[texture];
    const Grid& size = description().volumes[entry.volume].region;
    const auto id = static_cast<std::uint8_t>(texture);
    few = few && is_known(entry);
    if (few && size.x == 0) wanted.push_back({id, 0});
    if (!few || size.x == 0) continue;
    const std::uint32_t regions = regions_of(entry.desc, size).regions();
    few = wanted.size() + std::uint64_t{regions} <= kMaxSelected;
    for (std::uint32_t region = 1; few && region <= regions; ++region) {
      wanted.push_back({id, region});
    }
  }
  if (few) check(reader_->select(wanted), path_);
}

void ContainerInput::seek(std::uint64_t frame) {
  if (reader_->seekable()) (void)reader_->seek(frame);  // Else all frames are read in order.
}

void ContainerInput::read_ahead() {
  ContainerPacket packet;
  Status status = Status::ok;
  do {
    status = reader_->next(packet);
  } while (status == Status::ok && !selected_[packet.texture_id]);
  switch (status) {
    case Status::ok:
      ahead_ = std::move(packet);
      break;
    case Status::end:
      break;
    case Status::truncated:
      missing_ = kNoEnd;
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
    const std::string place = last_frame_ ? fmt::format("after frame {}", *last_frame_)
                                          : std::string("before the first frame");
    check(failure_, fmt::format("{}: {}", path_, place));
  }
  frame = ahead_->frame;
  if (!first_frame_) first_frame_ = frame;
  last_frame_ = frame;
  last_textures_.clear();
  std::set<std::pair<std::uint8_t, std::uint32_t>> seen;
  while (ahead_ && ahead_->frame == frame) {
    if (!seen.emplace(ahead_->texture_id, ahead_->region).second) {
      fail(Exit::bad_input, "{}: a second packet in this frame", where(*ahead_));
    }
    last_textures_.insert(ahead_->texture_id);
    packets.push_back(*std::exchange(ahead_, std::nullopt));
    read_ahead();
  }
  return true;
}

void ContainerInput::describe_cut() {
  const std::string* all = find_metadata(description().metadata, "frames");
  const std::string planned = all == nullptr ? "" : fmt::format(" of frames {}", *all);
  if (!first_frame_) {
    missing_ =
        fmt::format("{}: it holds none{}", kNoEnd, planned.empty() ? " of its frames" : planned);
    return;
  }
  missing_ =
      fmt::format("{}: it holds frames {}-{}{}", kNoEnd, *first_frame_, *last_frame_, planned);
  const auto wanted = std::count(selected_.begin(), selected_.end(), true);
  if (last_textures_.size() == static_cast<std::size_t>(wanted)) return;
  std::string found;
  for (const std::uint8_t id : last_textures_) {
    found += (found.empty() ? "" : ", ") + textures_[id].name;
  }
  missing_ += fmt::format(", and of frame {} only {}", *last_frame_, found);
}

std::string ContainerInput::frames_there() {
  std::uint64_t frame = 0, frames = 0;
  std::vector<ContainerPacket> packets;
  if (bytes()) rewind();  // It may have been entered at a later frame.
  try {
    while (next_frame(frame, packets)) ++frames;
  } catch (const Error& error) {
    if (!first_frame_) return error.what();
  }
  if (!first_frame_) return "it holds none";
  const bool gaps = bytes() && frames <= *last_frame_ - *first_frame_;
  return fmt::format("it holds frames {}-{}{}", *first_frame_, *last_frame_,
                     gaps ? fmt::format(", {} of them", frames) : "");
}

std::string ContainerInput::where(const ContainerPacket& packet) const {
  return fmt::format("{}: frame {}, texture {}{}", path_, packet.frame,
                     textures_[packet.texture_id].name,
                     packet.region == 0 ? "" : fmt::format(", region {}", packet.region));
}

std::string require_complete(const ContainerInput& input, bool allowed) {
  if (!input.cut_off()) return "";
  if (allowed) return fmt::format("{}: {}", input.path(), input.missing());
  fail(Exit::bad_input, "{}: {}; --allow-incomplete goes on with what is there", input.path(),
       input.missing());
}

Exit report_cut_off(const ContainerInput& input, const std::string& rest, bool allowed) {
  if (!input.cut_off()) return Exit::ok;
  remark(fmt::format("{}: {}; {}", input.path(), input.missing(), rest));
  return allowed ? Exit::ok : Exit::bad_input;
}

std::string recovery(const ContainerInput& input) {
  if (!input.first_frame()) return "nothing can be given back; get it again";
  std::size_t dumps = 0;
  std::string flags;
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    if (!input.textures()[i].no_dump.empty()) continue;
    if (++dumps > 1) continue;
    flags = fmt::format(" --volume {}",
                        volume_name(input.description(), input.description().textures[i].volume));
  }
  if (dumps == 0) return "no dumps can be made of what is there; get it again";
  if (dumps == input.textures().size()) flags.clear();
  if (input.cut_off()) {
    flags += " --allow-incomplete";
  } else if (*input.first_frame() < *input.last_frame()) {
    // The last one may lack textures.
    flags += fmt::format(" --frames {}-{}", *input.first_frame(), *input.last_frame() - 1);
  }
  return fmt::format("\"gicodec decode {}{} -o DIR\" gives back what comes before",
                     input.argument(), flags);
}

void require_distinct_files(const ContainerInput& input) {
  const ContainerDescription& description = input.description();
  std::map<std::string, std::size_t> taken;
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const StoredTexture& texture = input.textures()[i];
    if (!input.is_selected(i) || !texture.no_dump.empty()) continue;
    const auto [other, fresh] = taken.emplace(texture.file_name(UINT64_MAX), i);
    if (fresh) continue;
    const std::size_t own = description.textures[i].volume;
    const bool volumes = own != description.textures[other->second].volume;
    fail(Exit::bad_input, "{}: textures {} and {} have files of the same names{}", input.path(),
         input.textures()[other->second].name, texture.name,
         volumes ? fmt::format("; --volume {} takes one volume alone{}",
                               volume_choice(description, own),
                               volume_choice(description, own) == volume_name(description, own)
                                   ? ""
                                   : ", by its number, since others have its name")
                 : "");
  }
}

void select_volume(ContainerInput& input, const std::string& volume) {
  if (volume.empty()) return;
  const std::size_t one = find_volume(input.description(), volume, input.path());
  const VolumeEntry& entry = input.description().volumes[one];
  std::vector<std::size_t> own(entry.textures);
  std::iota(own.begin(), own.end(), std::size_t{entry.first_texture});
  input.select(own);
}

void select_dumps(ContainerInput& input, const std::string& volume) {
  select_volume(input, volume);
  std::string other_volume, why_not;
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const StoredTexture& texture = input.textures()[i];
    if (!input.is_selected(i)) continue;
    if (!texture.no_dump.empty() && why_not.empty()) why_not = texture.no_dump;
    if (!texture.no_dump.empty() || !other_volume.empty()) continue;
    other_volume = volume_choice(input.description(), input.description().textures[i].volume);
  }
  if (!why_not.empty()) {
    fail(Exit::bad_input, "{}: {}{}", input.path(), why_not,
         other_volume.empty()
             ? ""
             : fmt::format("; --volume {} takes another volume alone", other_volume));
  }
  require_distinct_files(input);
}

}  // namespace gicodec::tools

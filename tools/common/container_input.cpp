#include "container_input.h"

#include "cli.h"
#include "dump/cure.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "file_forms.h"
#include "volume_words.h"

#include <gicodec/probes.h>
#include <gicodec/version.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace gicodec::tools {
namespace {

constexpr const char* kNoEnd = "its end is missing (cut off, or still being written)";

/// Bytes in MiB, rounded up.
std::uint64_t mebibytes(std::uint64_t bytes) { return (bytes >> 20) + 1; }

[[noreturn]] void fail_backend(std::uint8_t id, const TextureDesc& desc, const std::string& where) {
  load_backend(id);
  const std::string_view name = backend_name(id);
  if (name.empty()) fail(Exit::bad_input, "{}: its backend is unknown", where);
  const auto all = all_backends();
  const bool here = std::any_of(all.begin(), all.end(),
                                [&](const Backend* backend) { return backend->id() == id; });
  if (!here) fail(Exit::internal, "{}: backend {} is not in this build", where, name);
  fail(Exit::bad_input, "{}: backend {} does not code blocks of {} {}", where, name,
       block_text(desc.block), record_text(desc.record));
}

}  // namespace

ContainerInput::ContainerInput(const std::string& path, const DecoderFlags& decoding)
    : path_(path == "-"    ? "standard input"
            : is_url(path) ? shown_url(path)
                           : path),
      decoding_(decoding),
      hevc_(hevc_decoder(decoding)) {
  if (is_url(path)) {
    auto server = std::make_unique<HttpSource>(path, decoding.http, decoding.follow);
    server_ = server.get();
    source_ = std::make_unique<CountingSource>(std::move(server));
  } else {
    open_file(path);
  }
  open();
  for (const TextureEntry& entry : description().textures) {
    std::string why_not = no_dump(description(), entry);
    if (why_not.empty()) {
      textures_.push_back(stored(entry));
      continue;
    }
    StoredTexture& texture = textures_.emplace_back();
    texture.name = entry.name;
    texture.info.desc = entry.desc;
    texture.lossy = error_text(entry.largest_error);
    texture.no_dump = std::move(why_not);
  }
  selected_.assign(textures_.size(), true);
  prepare();
  if (!source_->size() || player_->finished()) return;
  if (decoding.follow) {
    player_->set_growing(true);
  } else {
    find_missing();
  }
}

void ContainerInput::open_file(const std::string& path) {
  file_.reset(path == "-" ? stdin : open_input(path));
  if (!file_) fail(Exit::io, "{}: cannot be opened: {}", path_, reason(errno));
  const auto state = path == "-" ? std::nullopt : state_of(path.c_str());
  if (state && state->kind == FileState::Kind::directory)
    fail(Exit::io, "{}: is a directory, not a container", path_);
  if (state && state->kind == FileState::Kind::regular && state->size == 0) {
    fail(Exit::bad_input,
         "{}: is empty: a recording that was ended before its first packet, or a copy that failed; "
         "get it again",
         path_);
  }
  source_ = std::make_unique<CountingSource>(std::make_unique<FileSource>(file_.get()));
}

StoredTexture ContainerInput::stored(const TextureEntry& entry) const {
  StoredTexture texture = from_entry(entry, path_);
  const bool timed = find_attribute(texture.info.attributes, kTimeAttribute) != nullptr;
  if (timed) texture.times = times_of(description());
  return texture;
}

void ContainerInput::read_metadata(bool allow_damaged) {
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    auto beside = player_->metadata(static_cast<std::uint8_t>(i));
    const Status status = beside.status();
    if (status == Status::truncated) return;  // No packet can follow.
    const std::string where = fmt::format("{}: metadata of texture {}", path_, textures_[i].name);
    const bool damaged = exit_code(status) == Exit::bad_input;
    if (damaged && !allow_damaged) {
      fail(Exit::bad_input, "{}: {}; {}", where, to_string(status), to_cure(Cure::incomplete));
    }
    if (damaged) {
      remark(fmt::format("{}: {}; its files lack it", where, to_string(status)));
      continue;
    }
    check_read(status, where);
    Metadata more = *std::move(beside);
    if (more.empty() || !textures_[i].no_dump.empty()) continue;
    TextureEntry entry = description().textures[i];
    entry.metadata.insert(entry.metadata.end(), std::make_move_iterator(more.begin()),
                          std::make_move_iterator(more.end()));
    textures_[i] = stored(entry);
  }
}

Metadata ContainerInput::beside(std::size_t texture) {
  auto metadata = player_->metadata(static_cast<std::uint8_t>(texture));
  return metadata ? *std::move(metadata) : Metadata{};
}

void ContainerInput::open() {
  PlayerOptions options;
  options.limits.max_total_bytes = decoding_.memory << 20;
  if (hevc_ != nullptr) options.backends.push_back(hevc_.get());
  options.threads = std::min(decoding_.threads, kMaxThreads);
  options.isa = decoding_.isa;
  auto player = ContainerPlayer::open(*source_, options);
  if (player.status() == Status::not_gicodec) {
    fail(Exit::bad_input, "{}: is not a .gic container", path_);
  }
  if (player.status() == Status::unsupported_version) refuse_version();
  check_read(player.status(), path_);
  player_.emplace(*std::move(player));
}

void ContainerInput::refuse_version() {
  std::array<std::byte, ContainerVersion::kBytes> head{};
  const bool again = source_->seek(0) == Status::ok && source_->read(head).ok();
  const auto version = container_version(head);
  fail(Exit::bad_input,
       "{}: is a container of {}; gicodec {} reads version {}: take a newer gicodec", path_,
       again && version ? fmt::format("version {}.{}", version->major, version->minor)
                        : std::string("another version"),
       kVersionString, kContainerMajor);
}

void ContainerInput::find_missing() {
  if (server_ != nullptr) return find_missing_by_index();
  try {
    while (skip_frame()) continue;
  } catch (const Error&) {
    missing_.clear();  // Damage, which later reading reports at its place.
  }
  rewind();
}

void ContainerInput::rewind() {
  check(source_->seek(0), path_);
  open();
  prepare();
  first_frame_.reset();
  last_frame_.reset();
  sought_.reset();
}

void ContainerInput::select(const std::vector<std::size_t>& textures) {
  selected_.assign(textures_.size(), false);
  for (const std::size_t texture : textures) selected_[texture] = true;
  prepare();
}

void ContainerInput::seek(std::uint64_t frame) {
  // Otherwise all frames are read in order.
  if (!player_->seekable()) return;
  const Status status = player_->seek(frame);
  if (status == Status::ok) sought_ = frame;
  if (status == Status::io_failed) check_read(status, path_);
}

bool ContainerInput::go_on(Status (ContainerPlayer::*step)()) {
  Status status = ((*player_).*step)();
  while (status == Status::truncated && decoding_.follow && source_->size()) {
    wait_for_more();
    status = ((*player_).*step)();
  }
  if (status == Status::end) return false;
  if (status == Status::truncated && !player_->where().part) {
    if (!sought_ || missing_.empty()) describe_cut();  // seek() may have skipped frames that exist.
    return false;
  }
  damaged_ = exit_code(status) == Exit::bad_input && status != Status::limit_exceeded &&
             status != Status::backend_missing;
  if (status != Status::ok) fail_at(status);
  last_frame_ = player_->frame();
  if (!first_frame_) first_frame_ = last_frame_;
  last_textures_.clear();
  for (const ContainerPacket& packet : packets()) {
    if (selected_[packet.texture_id]) last_textures_.insert(packet.texture_id);
  }
  return true;
}

std::string ContainerInput::place_of_damage() const {
  if (!last_frame_) {
    return sought_ ? fmt::format("in or before frame {}", *sought_) : "before the first frame";
  }
  // The frame's missing packets may be the damaged ones.
  bool whole = true;
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    const VolumeEntry& volume = description().volumes[description().textures[i].volume];
    const auto id = static_cast<std::uint8_t>(i);
    whole = whole && (!selected_[i] || last_textures_.contains(id)) && volume.region == Grid{};
  }
  return fmt::format("{}after frame {}", whole ? "" : "in or ", *last_frame_);
}

void ContainerInput::fail_at(Status status) const {
  const ContainerPlayer::Where at = player_->where();
  if (status == Status::io_failed && server_ != nullptr) {
    check_read(status, fmt::format("{}: {}", path_, place_of_damage()));
  }
  if (!at.part) {
    // A packet that takes more by itself.
    const std::uint64_t usual = mebibytes(DecodeLimits{}.max_total_bytes - 1);
    const bool more = status == Status::limit_exceeded && decoding_.memory < usual;
    fail(exit_code(status), "{}: {}: {}{}", path_, place_of_damage(), to_string(status),
         more && decoding_.memory_flag ? "; " + to_cure(Cure::more_memory, usual) : "");
  }
  const std::string there = where(at.frame, *at.part);
  if (status == Status::limit_exceeded) require_memory(at.memory - player_->memory(), there);
  for (const ContainerPacket& packet : packets()) {
    if (status != Status::backend_missing || packet.texture_id != at.part->texture_id) continue;
    const TextureEntry& entry = description().textures[packet.texture_id];
    const auto info = peek(packet.bytes);
    if (info) fail_backend(info->backend, part_of(description(), entry, packet.region), there);
  }
  fail(exit_code(status), "{}: {}", there, to_string(status));
}

std::vector<std::size_t> ContainerInput::arrived() const {
  return {last_textures_.begin(), last_textures_.end()};
}

std::vector<std::byte> ContainerInput::texels(std::size_t texture) const {
  const std::string where = fmt::format("{}: texture {}", path_, textures_[texture].name);
  const std::uint64_t bytes = texture_bytes(textures_[texture].info.desc);
  const auto together = std::min<std::size_t>(decoding_.threads, textures_.size());
  require_memory(bytes * together, where);
  std::vector<std::byte> texels(static_cast<std::size_t>(bytes));
  check(player_->read(static_cast<std::uint8_t>(texture), TextureView{texels}), where);
  return texels;
}

void ContainerInput::follow(std::size_t texture, std::span<std::byte> texels) const {
  check(player_->read_changed(static_cast<std::uint8_t>(texture), TextureView{texels}),
        fmt::format("{}: texture {}", path_, textures_[texture].name));
}

void ContainerInput::require_memory(std::uint64_t bytes, const std::string& where) const {
  const std::uint64_t wanted = player_->memory() + bytes;
  if (wanted <= decoding_.memory << 20) return;
  // What comes after this needs memory too: decoders take a few times their textures.
  constexpr std::uint64_t kTimes = 8;
  std::uint64_t all = 0;
  for (const TextureEntry& texture : description().textures) {
    if (is_known(texture)) all += kTimes * texture_bytes(texture.desc);
  }
  const std::uint64_t enough = std::max(wanted, std::min(all, DecodeLimits{}.max_total_bytes));
  fail(Exit::bad_input,
       "{}: decoding takes {} MiB with the textures before it, and {} are allowed{}", where,
       mebibytes(wanted), decoding_.memory,
       decoding_.memory_flag ? "; " + to_cure(Cure::more_memory, mebibytes(enough)) : "");
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
  missing_ +=
      fmt::format(", and of frame {} only {}", *last_frame_,
                  listed(last_textures_, [&](std::uint8_t id) { return textures_[id].name; }));
}

std::string ContainerInput::frames_there() {
  std::uint64_t frames = 0;
  if (bytes()) rewind();  // reading may have begun at a later frame
  try {
    while (skip_frame()) ++frames;
  } catch (const Error& error) {
    if (!first_frame_) return error.what();
  }
  if (!first_frame_) return "it holds none";
  const bool gaps = bytes() && frames <= *last_frame_ - *first_frame_;
  return fmt::format("it holds frames {}-{}{}", *first_frame_, *last_frame_,
                     gaps ? fmt::format(", {} of them", frames) : "");
}

std::string ContainerInput::where(std::uint64_t frame, TextureRegion part) const {
  return fmt::format(
      "{}: frame {}, texture {}{}", path_, frame, textures_[part.texture_id].name,
      part.region == StreamId::kWholeVolume ? "" : fmt::format(", region {}", part.region));
}

std::string require_complete(const ContainerInput& input, bool allowed) {
  if (!input.cut_off()) return "";
  if (allowed) return fmt::format("{}: {}", input.path(), input.missing());
  fail(Exit::bad_input, "{}: {}; {}", input.path(), input.missing(), to_cure(Cure::incomplete));
}

void require_whole(ContainerInput& input) {
  const std::uint64_t frame = input.frame();
  std::string why;
  try {
    if (input.skip_frame() || !input.cut_off()) return;
    why = input.missing();
  } catch (const Error& error) {
    if (error.code() != Exit::bad_input) throw;
    why = error.what();
    if (why.starts_with(input.path() + ": ")) why.erase(0, input.path().size() + 2);
  }
  fail(Exit::bad_input,
       "{}: frame {} is not whole: {}; --frame takes one before it, if there is any", input.path(),
       frame, why);
}

Exit report_cut_off(const ContainerInput& input, const std::string& rest, bool allowed) {
  if (!input.cut_off()) return Exit::ok;
  remark(fmt::format("{}: {}; {}", input.path(), input.missing(), rest));
  return allowed ? Exit::ok : Exit::bad_input;
}

bool has_dumps(const ContainerInput& input, std::size_t volume) {
  const VolumeEntry& entry = input.description().volumes[volume];
  const auto textures = std::span(input.textures()).subspan(entry.first_texture, entry.textures);
  return !textures.empty() && std::ranges::all_of(textures, [](const StoredTexture& texture) {
    return texture.no_dump.empty();
  });
}

std::string recovery(const ContainerInput& input) {
  if (!input.first_frame() && !input.sought()) return "nothing can be given back; get it again";
  std::size_t dumps = 0;
  std::string flags;
  for (std::size_t i = 0; i < input.textures().size(); ++i) {
    const std::size_t volume = input.description().textures[i].volume;
    if (!has_dumps(input, volume)) continue;
    if (++dumps > 1) continue;
    flags = fmt::format(" --volume {}", shell_word(volume_name(input.description(), volume)));
  }
  const bool drawn = std::ranges::any_of(
      input.description().volumes,
      [](const VolumeEntry& volume) { return volume.kind != kKindProbes && is_drawn(volume); });
  if (dumps == 0 && drawn) {
    return fmt::format("\"gi-render --stream {}{}\" draws what comes before",
                       shell_word(input.argument()), input.cut_off() ? " --allow-incomplete" : "");
  }
  if (dumps == 0) return "no dumps can be made of what is there; get it again";
  if (dumps == input.textures().size()) flags.clear();
  if (input.cut_off()) {
    flags += " --allow-incomplete";
  } else if (input.last_frame()) {
    const std::uint64_t first = input.sought() ? 0 : *input.first_frame();
    // The last one may lack textures.
    if (first < *input.last_frame()) {
      flags += fmt::format(" --frames {}-{}", first, *input.last_frame() - 1);
    }
  }
  return fmt::format("\"gicodec decode {}{} -o DIR\" gives back what comes before",
                     shell_word(input.argument()), flags);
}

}  // namespace gicodec::tools

#include "play_feed.h"

#include "clock.h"
#include "common/container_input.h"
#include "common/stored_texture.h"
#include "common/volume_words.h"
#include "ddgi/scene_id.h"
#include "dump/block_place.h"
#include "dump/cure.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/geometry_attributes.h"
#include "dump/sequence.h"
#include "log.h"
#include "programs/feed_container.h"
#include "programs/stored_volume.h"
#include "recording.h"

#include <gicodec/probes.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

/// Plays the textures frame by frame, from a container or from dumps.
struct Player {
  virtual ~Player() = default;
  virtual void rewind(bool allow_incomplete) = 0;
  /// Reads the next frame. False at the end, where the textures stay as they are.
  virtual bool advance() = 0;

  std::vector<FeedVolume> volumes;               ///< without geometry, if it is unknown
  std::vector<std::vector<std::byte>> textures;  ///< of all volumes
  kinds::FrameFacts facts;
  Recording recording;               ///< only its complete frames are played
  std::vector<std::string> remarks;  ///< since they were last taken
};

/// "1 whole frame is", "2 whole frames are".
std::string frames_are(std::uint64_t frames, const char* whole) {
  return fmt::format("{} {}frame{}", frames, whole, frames == 1 ? " is" : "s are");
}

/// Remarks on the recording for the operator. Throws if it has a flaw, unless that is allowed.
std::vector<std::string> remarks_on(const Recording& recording, bool allowed) {
  std::vector<std::string> remarks = recording.remarks;
  if (recording.flaw.empty()) return remarks;
  const std::string left = frames_are(recording.frames, "whole ");
  if (!allowed || recording.frames == 0) {
    fail(Exit::bad_input, "{}; {} before that; get the recording again{}", recording.flaw, left,
         recording.frames == 0 ? "" : ", or play what is left with --allow-incomplete");
  }
  remarks.push_back(fmt::format("{}; {} before that and played", recording.flaw, left));
  return remarks;
}

/// Differs between a file and another at the same path, or the same with more frames.
struct FileState {
  std::filesystem::file_time_type written;
  std::uintmax_t size = 0;
  friend bool operator==(const FileState&, const FileState&) = default;
};

FileState file_state(const std::string& path) {
  std::error_code error;
  return {std::filesystem::last_write_time(path, error), std::filesystem::file_size(path, error)};
}

class RecordingPlayer final : public Player {
 public:
  RecordingPlayer(std::string path, const PlayOptions& options) : path_(std::move(path)) {
    decoding_.isa = options.isa;
    decoding_.memory = std::max<std::uint64_t>(decoding_.memory, options.memory);
    decoding_.memory_flag = true;
    state_ = file_state(path_);
    recording = look_through(path_);
    open();
    Chosen chosen = choose();
    volumes = std::move(chosen.volumes);
    if (!chosen.remark.empty()) recording.remarks.push_back(std::move(chosen.remark));
    textures.resize(played_.size());
  }

  void rewind(bool allow_incomplete) override {
    const FileState state = file_state(path_);
    if (!(state == state_)) {
      recording = look_through(path_);
      remarks = remarks_on(recording, allow_incomplete);
      remarks.insert(remarks.begin(),
                     fmt::format("{}: is another file than before; of it {} played from here on",
                                 path_, frames_are(recording.frames, "")));
      state_ = state;
    }
    open();
    const auto same = [](const FeedVolume& a, const FeedVolume& b) {
      return a.name == b.name && a.desc == b.desc;
    };
    if (std::ranges::equal(choose().volumes, volumes, same)) return;
    fail(Exit::bad_input,
         "{}: was replaced by a recording of other volumes while it was played; start the server "
         "again to play that",
         path_);
  }

  bool advance() override {
    if (at_ >= recording.frames) return false;
    if (!input_->next_frame()) {
      fail(Exit::bad_input, "{}: ends after {} of the {} that it had when it was opened", path_,
           at_, count(recording.frames, "frame"));
    }
    ++at_;
    facts.time.reset();
    for (std::size_t i = 0; i < played_.size(); ++i) {
      if (at_ == 1) {
        textures[i] = input_->texels(played_[i]);
      } else {
        input_->follow(played_[i], textures[i]);
      }
      facts.read(input_->textures()[played_[i]].info_at(input_->frame()).attributes);
    }
    const ContainerDescription& description = input_->description();
    const auto times = kinds::times_of(description);
    if (!facts.time && times) facts.time = times->at(input_->frame());
    if (!facts.scene && !description.scene.name.empty()) facts.scene = description.scene.name;
    return true;
  }

 private:
  /// Opens the file at the path, which may have been replaced, at its first frame.
  void open() {
    input_ = std::make_unique<tools::ContainerInput>(path_, decoding_);
    at_ = 0;
  }

  struct Chosen {
    std::vector<FeedVolume> volumes;
    std::string remark;  ///< on volumes that cannot be played; empty: all can
  };
  Chosen choose() {
    constexpr std::size_t kMaxWords = 4;
    const auto& all = input_->description().volumes;
    Chosen chosen;
    played_.clear();
    std::size_t left_out = 0;
    std::string words;
    for (const VolumeEntry& entry : all) {
      const std::string why = why_not(entry);
      if (why.empty()) {
        chosen.volumes.push_back(volume(entry));
        for (std::size_t i = 0; i < entry.textures; ++i) played_.push_back(entry.first_texture + i);
      } else if (++left_out <= kMaxWords) {
        words += (words.empty() ? "" : "; ") + why;
      }
    }
    if (left_out == 0) return chosen;
    if (left_out > kMaxWords) words += fmt::format("; and {} more", left_out - kMaxWords);
    if (chosen.volumes.empty()) {
      fail(Exit::bad_input,
           "{}: no volume of it can be played: {}; a newer gi-server may know more, and the "
           "application that wrote it can stream it itself",
           path_, words);
    }
    chosen.remark =
        fmt::format("{}: {} of {} volumes are left out: {}", path_, left_out, all.size(), words);
    return chosen;
  }

  /// The reason why a volume cannot be played; empty if it can.
  [[nodiscard]] std::string why_not(const VolumeEntry& entry) const {
    const ContainerDescription& description = input_->description();
    return tools::unknown_kind(description, description.textures[entry.first_texture].volume);
  }

  /// The volume as stored, with the layout of decoded textures.
  [[nodiscard]] FeedVolume volume(const VolumeEntry& entry) const {
    FeedVolume made{entry.name, entry.geometry.value_or(VolumeGeometry{}), entry.desc};
    std::size_t id = entry.first_texture;
    for (TextureGroup& group : made.desc.groups) {
      for (NamedTexture& texture : group.textures) {
        const tools::StoredTexture& stored = input_->textures()[id++];
        texture.desc = stored.info.desc;
        const bool bounded = stored.lossy.empty() || stored.largest_error > 0;
        made.errors.push_back(bounded ? stored.largest_error
                                      : std::numeric_limits<float>::infinity());
      }
    }
    if (!entry.geometry) made.geometry.grid = made.desc.groups.front().textures.front().desc.grid;
    return made;
  }

  std::string path_;
  tools::DecoderFlags decoding_;
  std::unique_ptr<tools::ContainerInput> input_;
  FileState state_;
  std::vector<std::size_t> played_;  ///< textures of the volumes, ascending
  std::uint64_t at_ = 0;
};

/// `described`: the dumps' attributes say what they hold.
[[noreturn]] void fail_no_probes(const std::string& folder, bool described) {
  if (described) {
    fail(Exit::bad_input,
         "{}: its dumps are of other blocks than probes, which alone are played; the application "
         "that they are for can stream them itself",
         folder);
  }
  fail(Exit::bad_input,
       "{}: its dumps do not say that they are textures of probes, which alone are played, and DDS "
       "files cannot; if they are, this makes a container that can be played: gicodec encode "
       "--layout NAME --grid XxYxZ -o FILE.gic \"{}\"",
       folder, folder);
}

class DumpPlayer final : public Player {
 public:
  explicit DumpPlayer(const std::string& folder)
      : sequences_(tools::group_sequences({folder}, {.cure = tools::Cure::play_gaps})) {
    recording = look_through(sequences_);
    std::vector<NamedTexture> named;
    std::vector<float> errors;
    for (const tools::Sequence& sequence : sequences_) {
      const tools::DumpInfo info = tools::read_dump_info(sequence.frames.front().path);
      const auto* const lost = tools::find_attribute(info.attributes, tools::kLossyAttribute);
      errors.push_back(lost == nullptr ? 0 : tools::error_of(lost->value));
      descs_.push_back(info.desc);
      named.push_back({sequence.name, descs_.back()});
      if (!tools::is_probes(descs_.back()))
        fail_no_probes(folder, tools::find_attribute(info.attributes, tools::kBlock) != nullptr);
      if (!(descs_.back().grid == descs_.front().grid)) {
        fail(Exit::bad_input,
             "{}: its textures have different grids, {} and {}; give each volume a folder of its "
             "own and play one of them",
             folder, tools::to_string(descs_.front().grid), tools::to_string(descs_.back().grid));
      }
      if (!is_utf8(sequence.name)) {
        fail(Exit::bad_input, "{}: the name of texture {} is not UTF-8; rename its dumps", folder,
             sequence.name);
      }
    }
    VolumeDesc probes = tools::take(probe_volume(named), folder);
    volumes.push_back({"world", {descs_.front().grid}, std::move(probes), std::move(errors)});
    textures.resize(descs_.size());
  }

  void rewind(bool) override { at_ = 0; }

  bool advance() override {
    if (at_ >= recording.frames) return false;
    facts.time.reset();
    for (std::size_t i = 0; i < sequences_.size(); ++i) {
      const std::string& path = sequences_[i].frames[at_].path;
      tools::Dump dump = tools::read_dump(path);
      if (!(dump.info.desc == descs_[i]))
        fail(Exit::bad_input, "{}: is not like the first frame", path);
      textures[i] = std::move(dump.texels);
      facts.read(dump.info.attributes);
    }
    ++at_;
    return true;
  }

 private:
  std::vector<tools::Sequence> sequences_;
  std::vector<TextureDesc> descs_;
  std::uint64_t at_ = 0;
};

/// Marks the blocks that have a record other than zero.
void mark_used(const TextureDesc& desc, std::span<const std::byte> texels, BlockMask& used) {
  for (std::uint32_t block = 0; block < used.size(); ++block) {
    const bool any = tools::any_row(desc, block, [&](std::size_t offset, std::size_t bytes) {
      return std::ranges::any_of(texels.subspan(offset, bytes),
                                 [](std::byte b) { return b != std::byte{}; });
    });
    if (any) used[block] = 1;
  }
}

std::unique_ptr<Player> open(const std::string& path, const PlayOptions& options) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return std::make_unique<DumpPlayer>(path);
  return std::make_unique<RecordingPlayer>(path, options);
}

/// Plays the next frame. It was complete when checked, so damage means that the file has changed.
bool advance(Player& player, std::uint64_t frames) {
  try {
    return player.advance();
  } catch (const tools::Error& error) {
    if (error.code() != Exit::bad_input) throw;
    fail(Exit::bad_input, "{}; {} played before; get the recording again", error.what(),
         frames == 1 ? "1 frame was" : fmt::format("{} frames were", frames));
  }
}

}  // namespace

Feed play_feed(const std::string& path, const PlayOptions& options) {
  std::shared_ptr<Player> player = open(path, options);
  std::vector<std::string> remarks = remarks_on(player->recording, options.allow_incomplete);
  if (!advance(*player, 0)) fail(Exit::bad_input, "{}: has no frame; record it again", path);
  VolumeGeometry& geometry = player->volumes.front().geometry;
  if (const auto o = player->facts.origin) geometry.origin = *o;
  if (const auto s = player->facts.spacing) geometry.spacing = *s;
  player->rewind(options.allow_incomplete);

  Feed feed{player->volumes,
            {ddgi::scene_name(player->facts.scene.value_or("")), 0},
            true,
            {},
            std::move(remarks)};
  auto active = std::make_shared<std::vector<BlockMask>>();
  for (const FeedVolume& volume : feed.volumes) {
    const std::uint32_t blocks = block_count(volume.desc.groups.front().textures.front().desc);
    active->emplace_back(is_probes(volume) ? blocks : 0);
  }
  auto frames = std::make_shared<std::uint64_t>(0);
  feed.next = [=](const FeedRequest&) {
    const double start = now();
    if (!advance(*player, *frames) && options.loop) {
      player->rewind(options.allow_incomplete);
      if (!advance(*player, *frames))
        fail(Exit::bad_input, "{}: has no frame; record it again", path);
    }
    FeedFrame frame;
    frame.remarks = std::exchange(player->remarks, {});
    frame.time = player->facts.time.value_or(static_cast<double>(*frames) / options.rate);
    ++*frames;
    auto texture = player->textures.begin();
    for (std::size_t v = 0; v < player->volumes.size(); ++v) {
      const FeedVolume& volume = player->volumes[v];
      const auto first = texture;
      texture += static_cast<std::ptrdiff_t>(textures_of(volume.desc).size());
      const auto& group = volume.desc.groups.front().textures;
      for (std::size_t i = 0; i < group.size() && is_probes(volume); ++i) {
        mark_used(group[i].desc, first[static_cast<std::ptrdiff_t>(i)], (*active)[v]);
      }
      frame.volumes.push_back({volume.geometry.scroll, (*active)[v], {first, texture}});
    }
    frame.seconds = now() - start;
    return frame;
  };
  return feed;
}

}  // namespace gicodec::streaming

#include "source.h"

#include "clock.h"
#include "ddgi/probe_source.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/sequence.h"
#include "gicodec/container_input.h"

#include <algorithm>
#include <filesystem>
#include <memory>

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

/// The textures of one frame after the other, from either kind of input.
struct Player {
  virtual ~Player() = default;
  virtual void rewind() = 0;
  /// False at the end; the textures stay what they are.
  virtual bool advance() = 0;

  std::vector<std::string> names;
  std::vector<TextureDesc> descs;
  std::vector<std::vector<std::byte>> textures;
  ddgi::ProbeFrame facts;  ///< scene, time and place of the frame, as far as they are told
};

/// Fails if the end of a container is missing, and says what is left of it. One with its index at
/// the end is whole; of others all records are read.
void check_whole(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file) return;  // Who opens it next says why not.
  FileSource source(file.get());
  auto reader = ContainerReader::open(source);
  if (!reader || reader->seekable()) return;
  std::vector<bool> held;
  std::uint64_t frames = 0, last = 0;
  ContainerPacket packet;
  Status status = reader->next(packet);
  for (; status == Status::ok; status = reader->next(packet)) {
    if (frames == 0 || packet.frame != last) {
      ++frames;
      held.assign(reader->description().textures.size(), false);
    }
    last = packet.frame;
    held[packet.texture_id] = true;
  }
  if (status != Status::truncated) return;
  std::string missing;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i]) continue;
    missing += (missing.empty() ? "" : ", ") + reader->description().textures[i].name;
  }
  const std::string left =
      frames == 0 ? "no frame is left"
      : missing.empty()
          ? fmt::format("{} frames are left, the last one is {}", frames, last)
          : fmt::format("{} whole frames are left, and {} without {}", frames - 1, last, missing);
  fail(Exit::bad_input,
       "{}: its end is missing; {}; get the whole file, or play what is left with "
       "--allow-incomplete",
       path, left);
}

class ContainerPlayer final : public Player {
 public:
  ContainerPlayer(std::string path, bool allow_incomplete) : path_(std::move(path)) {
    if (!allow_incomplete) check_whole(path_);
    ContainerPlayer::rewind();
    for (const TextureEntry& entry : input_->description().textures) {
      names.push_back(entry.name);
      descs.push_back(entry.desc);
    }
    textures.resize(descs.size());
  }

  void rewind() override {
    states_.reset();
    input_ = std::make_unique<tools::ContainerInput>(path_);
    states_ = std::make_unique<tools::TextureStates>(*input_);
  }

  bool advance() override {
    std::uint64_t frame = 0;
    std::vector<ContainerPacket> packets;
    if (!input_->next_frame(frame, packets)) return false;
    // The one at the cut.
    if (input_->cut_off() && packets.size() < descs.size()) return false;
    for (const ContainerPacket& packet : packets) states_->apply(packet);
    facts.time.reset();
    for (std::size_t i = 0; i < descs.size(); ++i) {
      const auto texels = states_->texels(i);
      textures[i].assign(texels.begin(), texels.end());
      read_attributes(facts, input_->textures()[i].info_at(frame).attributes);
    }
    return true;
  }

 private:
  std::string path_;
  std::unique_ptr<tools::ContainerInput> input_;
  std::unique_ptr<tools::TextureStates> states_;
};

class DumpPlayer final : public Player {
 public:
  explicit DumpPlayer(const std::string& folder) : sequences_(tools::group_sequences({folder})) {
    for (const tools::Sequence& sequence : sequences_) {
      names.push_back(sequence.name);
      descs.push_back(tools::read_dump_info(sequence.frames.front().path).desc);
    }
    textures.resize(descs.size());
  }

  void rewind() override { at_ = 0; }

  bool advance() override {
    if (at_ >= sequences_.front().frames.size()) return false;
    facts.time.reset();
    for (std::size_t i = 0; i < sequences_.size(); ++i) {
      const std::string& path = sequences_[i].frames[at_].path;
      tools::Dump dump = tools::read_dump(path);
      if (!(dump.info.desc == descs[i]))
        fail(Exit::bad_input, "{}: is not like the first frame", path);
      textures[i] = std::move(dump.texels);
      read_attributes(facts, dump.info.attributes);
    }
    ++at_;
    return true;
  }

 private:
  std::vector<tools::Sequence> sequences_;
  std::size_t at_ = 0;
};

/// Marks the probes that have a texel other than zero.
void mark_used(const TextureDesc& desc, std::span<const std::byte> texels, ProbeMask& used) {
  const std::size_t row = std::size_t{block_side(desc)} * texel_bytes(desc);
  const std::size_t pitch = std::size_t{extent(desc).width} * texel_bytes(desc);
  for (std::uint32_t probe = 0; probe < used.size(); ++probe) {
    const BlockOrigin at = block_origin(desc, probe);
    const std::size_t top = std::size_t{at.slice} * extent(desc).height + at.y;
    for (std::uint32_t y = 0; used[probe] == 0 && y < block_side(desc); ++y) {
      const auto line = texels.subspan((top + y) * pitch + at.x * texel_bytes(desc), row);
      used[probe] = std::ranges::any_of(line, [](std::byte b) { return b != std::byte{}; });
    }
  }
}

std::unique_ptr<Player> open(const std::string& path, const PlayOptions& options) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return std::make_unique<DumpPlayer>(path);
  return std::make_unique<ContainerPlayer>(path, options.allow_incomplete);
}

}  // namespace

Source play_source(const std::string& path, const PlayOptions& options) {
  std::shared_ptr<Player> player = open(path, options);
  for (const TextureDesc& desc : player->descs) {
    if (desc.grid == player->descs.front().grid) continue;
    fail(Exit::bad_input, "{}: its textures have different grids, {} and {}", path,
         tools::to_string(player->descs.front().grid), tools::to_string(desc.grid));
  }
  if (!player->advance()) fail(Exit::bad_input, "{}: has no frame", path);
  VolumeGeometry geometry{player->descs.front().grid};
  if (const auto o = player->facts.origin) geometry.origin = {o->x, o->y, o->z};
  if (const auto s = player->facts.spacing) geometry.spacing = {s->x, s->y, s->z};
  player->rewind();

  Source source{{{"world", geometry, player->names, player->descs}},
                {player->facts.scene.value_or("").substr(0, kMaxName), 0},
                true,
                {}};
  auto active = std::make_shared<ProbeMask>(probe_count(player->descs.front()));
  auto frames = std::make_shared<std::uint64_t>(0);
  source.next = [=](const SourceRequest&) {
    const double start = now();
    if (!player->advance() && options.loop) {
      player->rewind();
      if (!player->advance()) fail(Exit::bad_input, "{}: has no frame", path);
    }
    SourceFrame frame;
    frame.time = player->facts.time.value_or(static_cast<double>(*frames) / options.rate);
    ++*frames;
    for (std::size_t i = 0; i < player->textures.size(); ++i) {
      mark_used(player->descs[i], player->textures[i], *active);
    }
    frame.volumes.push_back({{}, *active, player->textures});
    frame.seconds = now() - start;
    return frame;
  };
  return source;
}

}  // namespace gicodec::streaming

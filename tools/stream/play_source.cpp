#include "source.h"

#include "clock.h"
#include "ddgi/probe_source.h"
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/sequence.h"
#include "gicodec/container_input.h"
#include "recording.h"
#include "scene_id.h"

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
  Recording recording;     ///< of which no more frames than are whole are played
};

class ContainerPlayer final : public Player {
 public:
  ContainerPlayer(std::string path, Isa isa) : path_(std::move(path)) {
    decoding_.isa = isa;
    recording = look_through(path_);
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
    states_ = std::make_unique<tools::TextureStates>(*input_, decoding_);
    at_ = 0;
  }

  bool advance() override {
    if (at_ >= recording.frames) return false;
    std::uint64_t frame = 0;
    std::vector<ContainerPacket> packets;
    if (!input_->next_frame(frame, packets)) return false;
    ++at_;
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
  tools::DecoderFlags decoding_;
  std::unique_ptr<tools::ContainerInput> input_;
  std::unique_ptr<tools::TextureStates> states_;
  std::uint64_t at_ = 0;
};

class DumpPlayer final : public Player {
 public:
  explicit DumpPlayer(const std::string& folder)
      : sequences_(tools::group_sequences(
            {folder}, false,
            "\"gicodec encode --allow-gaps\" makes a container that can be played")) {
    recording = look_through(sequences_);
    for (const tools::Sequence& sequence : sequences_) {
      names.push_back(sequence.name);
      descs.push_back(tools::read_dump_info(sequence.frames.front().path).desc);
    }
    textures.resize(descs.size());
  }

  void rewind() override { at_ = 0; }

  bool advance() override {
    if (at_ >= recording.frames) return false;
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
  std::uint64_t at_ = 0;
};

/// Marks the probes that have a texel other than zero.
void mark_used(const TextureDesc& desc, std::span<const std::byte> texels, ProbeMask& used) {
  const std::size_t row = std::size_t{block_side(desc)} * texel_bytes(desc);
  const std::size_t pitch = std::size_t{extent(desc).width} * texel_bytes(desc);
  for (std::uint32_t probe = 0; probe < used.size(); ++probe) {
    const BlockOrigin at = block_origin(desc, probe);
    const std::size_t top = std::size_t{at.slice} * extent(desc).height + at.y;
    for (std::uint32_t y = 0; used[probe] == 0 && y < block_side(desc); ++y) {
      const auto line =
          texels.subspan((top + y) * pitch + std::size_t{at.x} * texel_bytes(desc), row);
      used[probe] = std::ranges::any_of(line, [](std::byte b) { return b != std::byte{}; });
    }
  }
}

std::unique_ptr<Player> open(const std::string& path, Isa isa) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return std::make_unique<DumpPlayer>(path);
  return std::make_unique<ContainerPlayer>(path, isa);
}

/// What is to be told of the recording. Throws if it has a flaw, unless that is allowed.
std::vector<std::string> remarks_on(const Recording& recording, bool allowed) {
  std::vector<std::string> remarks = recording.remarks;
  if (recording.flaw.empty()) return remarks;
  const std::string left = recording.frames == 1
                               ? "1 whole frame is"
                               : fmt::format("{} whole frames are", recording.frames);
  if (!allowed || recording.frames == 0) {
    fail(Exit::bad_input, "{}; {} before that; get the recording again{}", recording.flaw, left,
         recording.frames == 0 ? "" : ", or play what is left with --allow-incomplete");
  }
  remarks.push_back(fmt::format("{}; {} before that and played", recording.flaw, left));
  return remarks;
}

}  // namespace

Source play_source(const std::string& path, const PlayOptions& options) {
  std::shared_ptr<Player> player = open(path, options.isa);
  std::vector<std::string> remarks = remarks_on(player->recording, options.allow_incomplete);
  for (const TextureDesc& desc : player->descs) {
    if (desc.grid == player->descs.front().grid) continue;
    fail(Exit::bad_input, "{}: its textures have different grids, {} and {}", path,
         tools::to_string(player->descs.front().grid), tools::to_string(desc.grid));
  }
  for (const std::string& name : player->names) {
    if (is_utf8(name)) continue;
    fail(Exit::bad_input, "{}: the name of texture {} is not UTF-8; rename its dumps", path, name);
  }
  if (!player->advance()) fail(Exit::bad_input, "{}: has no frame", path);
  VolumeGeometry geometry{player->descs.front().grid};
  if (const auto o = player->facts.origin) geometry.origin = {o->x, o->y, o->z};
  if (const auto s = player->facts.spacing) geometry.spacing = {s->x, s->y, s->z};
  player->rewind();

  Source source{{{"world", geometry, player->names, player->descs}},
                {scene_name(player->facts.scene.value_or("")), 0},
                true,
                {},
                std::move(remarks)};
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

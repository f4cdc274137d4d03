// A container played frame by frame, from a file or standard input.
#pragma once

#include "backend_flags.h"
#include "dump/error.h"
#include "stored_texture.h"

#include <gicodec/gicodec.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::tools {

class ContainerInput {
 public:
  /// "-" is standard input. Throws if it cannot be opened or is no container. A file whose end is
  /// missing is read through once to find out what is there.
  explicit ContainerInput(const std::string& path, const DecoderFlags& decoding = {});

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// What a command is to be given to read it again.
  [[nodiscard]] std::string argument() const { return file_.get() == stdin ? "-" : path_; }
  [[nodiscard]] const ContainerDescription& description() const noexcept {
    return player_->description();
  }
  /// All that description() has, also those that no dump can be made of.
  [[nodiscard]] const std::vector<StoredTexture>& textures() const noexcept { return textures_; }
  /// Nothing for a pipe.
  [[nodiscard]] std::optional<std::uint64_t> bytes() const { return source_->size(); }
  /// So far; of a pipe at its end all that it gave.
  [[nodiscard]] std::uint64_t bytes_read() const { return source_->bytes_read(); }

  /// Makes all textures come back as files of that kind (file_forms.h).
  void set_files(ImageKind kind);
  /// From now on there are no packets but of these textures, and of those that say which of their
  /// records exist; of others nothing is read where the container can seek. Before the first frame
  /// only.
  void select(const std::vector<std::size_t>& textures);
  [[nodiscard]] bool is_selected(std::size_t texture) const { return selected_[texture]; }
  /// Makes that frame the next one if the container can seek and has it.
  void seek(std::uint64_t frame);
  /// Decodes the next frame; false at the end. What is damaged throws after all frames before it.
  [[nodiscard]] bool next_frame() { return go_on(&ContainerPlayer::next); }
  /// The same without decoding: its packets are not even checked.
  [[nodiscard]] bool skip_frame() { return go_on(&ContainerPlayer::skip); }
  [[nodiscard]] std::uint64_t frame() const noexcept { return player_->frame(); }
  /// Of the frame. Valid until the next call of next_frame() or skip_frame().
  [[nodiscard]] std::span<const ContainerPacket> packets() const noexcept {
    return player_->packets();
  }
  /// The selected textures that it has packets of, ascending.
  [[nodiscard]] std::vector<std::size_t> arrived() const;
  /// A texture after next_frame(), as StoredTexture::info says. Of different threads at once.
  [[nodiscard]] std::vector<std::byte> texels(std::size_t texture) const;
  /// The same, into what was like it before the frame.
  void follow(std::size_t texture, std::span<std::byte> texels) const;
  /// Throws Error of Exit::bad_input, which names the cure, where so many bytes besides what
  /// decoding takes are more than --max-memory allows.
  void require_memory(std::uint64_t bytes, const std::string& where) const;

  /// What is there and what is not where the end is missing, in words; the last frame may lack
  /// textures then. Empty for a whole container, and for a pipe until its end has been reached.
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
  [[nodiscard]] bool cut_off() const noexcept { return !missing_.empty(); }
  /// Whether the last call threw since the container is damaged: recovery() helps then.
  [[nodiscard]] bool damaged() const noexcept { return damaged_; }
  /// Where seek() made it begin, if it did.
  [[nodiscard]] std::optional<std::uint64_t> sought() const noexcept { return sought_; }
  /// The first frame that next_frame() gave, if any, and the last.
  [[nodiscard]] std::optional<std::uint64_t> first_frame() const noexcept { return first_frame_; }
  [[nodiscard]] std::optional<std::uint64_t> last_frame() const noexcept { return last_frame_; }
  /// "it holds frames 0-7", of what is selected, for a message that a frame is not there. Reads all
  /// that there is, so that nothing comes afterwards.
  [[nodiscard]] std::string frames_there();
  /// "x.gic: frame 3, texture vis", with the region of a volume that is cut.
  [[nodiscard]] std::string where(std::uint64_t frame, TextureRegion part) const;
  [[nodiscard]] std::string where(const ContainerPacket& packet) const {
    return where(packet.frame, {packet.texture_id, packet.region});
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const {
      if (file != stdin) std::fclose(file);
    }
  };
  /// Counts what it reads.
  class CountingSource final : public Source {
   public:
    explicit CountingSource(std::FILE* file) : file_(file) {}
    Result<std::size_t> read(std::span<std::byte> into) override {
      auto got = file_.read(into);
      if (got.ok()) bytes_read_ += *got;
      return got;
    }
    [[nodiscard]] std::optional<std::uint64_t> size() const override { return file_.size(); }
    Status seek(std::uint64_t offset) override { return file_.seek(offset); }
    [[nodiscard]] std::uint64_t bytes_read() const { return bytes_read_; }

   private:
    FileSource file_;
    std::uint64_t bytes_read_ = 0;
  };
  void open();
  /// Tells the player what is selected, and how textures lie in dumps.
  void prepare();
  void rewind();
  [[nodiscard]] bool go_on(Status (ContainerPlayer::*step)());
  [[noreturn]] void fail_at(Status status) const;
  /// "after frame 3", of damage behind the packets that were read.
  [[nodiscard]] std::string place_of_damage() const;
  void find_missing();
  void describe_cut();

  std::string path_;
  DecoderFlags decoding_;
  std::unique_ptr<const Backend> hevc_;
  std::unique_ptr<std::FILE, Close> file_;
  std::unique_ptr<CountingSource> source_;
  std::optional<ContainerPlayer> player_;
  std::vector<StoredTexture> textures_;
  std::vector<bool> selected_;  ///< by texture
  std::optional<std::uint64_t> first_frame_, last_frame_;
  std::optional<std::uint64_t> sought_;  ///< where seek() entered it
  bool damaged_ = false;
  std::set<std::uint8_t> last_textures_;  ///< of the last frame
  std::string missing_;
};

/// For programs whose result would be wrong or short without the end. Throws Error of
/// Exit::bad_input that names --allow-incomplete if the end is missing, unless `allowed`: gives the
/// remark for the user then. Empty if nothing is missing. Pipes are to be asked at their end.
[[nodiscard]] std::string require_complete(const ContainerInput& input, bool allowed);

/// Throws Error of Exit::bad_input where the last frame that was decoded, which lacks packets of
/// some textures, may not be whole. Reads on: what follows tells whether it was written so, since
/// packets are whole by themselves.
void require_whole(ContainerInput& input);

/// Says what is missing, and `rest`; the exit code is bad_input unless `allowed`.
[[nodiscard]] Exit report_cut_off(const ContainerInput& input, const std::string& rest,
                                  bool allowed);
/// Whether dumps can be made of a volume, which is of all of its textures.
[[nodiscard]] bool has_dumps(const ContainerInput& input, std::size_t volume);
/// What gives back what was read of a container that is damaged or cut off, in words.
[[nodiscard]] std::string recovery(const ContainerInput& input);

/// Throws Error of Exit::bad_input that names the cure where files of two selected textures that
/// dumps can be made of would have the same names.
void require_distinct_files(const ContainerInput& input);
/// Selects the textures of the volume of that name, or of all volumes if it is empty.
void select_volume(ContainerInput& input, const std::string& volume);
/// The same. Throws Error of Exit::bad_input that names the cure where no dump can be made of one,
/// and as require_distinct_files() does.
void select_dumps(ContainerInput& input, const std::string& volume);

}  // namespace gicodec::tools

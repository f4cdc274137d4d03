// Plays a container frame by frame, from a file, standard input or a server of files.
#pragma once

#include "backend_flags.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "http_source.h"
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
  /// `path`: "-" is standard input; or a URL, see http_source.h. Throws if it cannot be opened or
  /// is no container. Reads a file whose end is missing once to find its frames, of one on a server
  /// the index.
  explicit ContainerInput(const std::string& path, const DecoderFlags& decoding = {});

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// The argument that makes a command read it again.
  [[nodiscard]] std::string argument() const { return file_.get() == stdin ? "-" : path_; }
  /// What reading took of a file of which parts are read; nullptr for files here and pipes.
  [[nodiscard]] const HttpSource::Cost* cost() const noexcept {
    return server_ != nullptr && server_->size() ? &server_->cost() : nullptr;
  }
  [[nodiscard]] const ContainerDescription& description() const noexcept {
    return player_->description();
  }
  /// All textures of description(), also those that cannot become dumps.
  [[nodiscard]] const std::vector<StoredTexture>& textures() const noexcept { return textures_; }
  /// Size of the file; nullopt for a pipe.
  [[nodiscard]] std::optional<std::uint64_t> bytes() const { return source_->size(); }
  /// Bytes read so far; at a pipe's end, all of it.
  [[nodiscard]] std::uint64_t bytes_read() const { return source_->bytes_read(); }

  /// Reads what is kept of files beside the description, for programs that show or write files.
  /// Call it before the functions below. Throws for damaged metadata unless `allow_damaged`, which
  /// leaves them out and says so.
  void read_metadata(bool allow_damaged = false);
  /// What read_metadata() read of a texture, read again, since it may be large; empty where it is
  /// damaged.
  [[nodiscard]] Metadata beside(std::size_t texture);
  /// Makes all textures decode to files of that kind (file_forms.h).
  void set_files(ImageKind kind);
  /// Makes no texture's files have an attribute.
  void drop_attribute(std::string_view name);
  /// What the index lists, and how many frames; nothing where it has none.
  struct Listed {
    std::vector<ListedPart> parts;
    std::size_t frames = 0;
  };
  [[nodiscard]] std::optional<Listed> from_index();
  /// Plays only these textures and their presence textures, without reading others if the container
  /// can seek. Call it before the first frame.
  void select(const std::vector<std::size_t>& textures);
  [[nodiscard]] bool is_selected(std::size_t texture) const { return selected_[texture]; }
  /// Makes that frame the next one, if the container can seek and has it.
  void seek(std::uint64_t frame);
  /// Decodes the next frame; false at the end. Throws at damage, after all frames before it.
  [[nodiscard]] bool next_frame() { return go_on(&ContainerPlayer::next); }
  /// Skips the next frame without checking or decoding its packets.
  [[nodiscard]] bool skip_frame() { return go_on(&ContainerPlayer::skip); }
  [[nodiscard]] std::uint64_t frame() const noexcept { return player_->frame(); }
  /// Packets of the frame. Valid until the next call of next_frame() or skip_frame().
  [[nodiscard]] std::span<const ContainerPacket> packets() const noexcept {
    return player_->packets();
  }
  /// The selected textures with packets in the frame, ascending.
  [[nodiscard]] std::vector<std::size_t> arrived() const;
  /// A texture after next_frame(), laid out as StoredTexture::info. Callable by several threads.
  [[nodiscard]] std::vector<std::byte> texels(std::size_t texture) const;
  /// The same, updating `texels` that equal the texture before the frame.
  void follow(std::size_t texture, std::span<std::byte> texels) const;
  /// Throws Error of Exit::bad_input with a hint if `bytes`, besides decoding, exceed --max-memory.
  void require_memory(std::uint64_t bytes, const std::string& where) const;

  /// If the end is missing: what the container holds and lacks, in words; its last frame may then
  /// lack textures. Empty for a whole container, and for a pipe before its end.
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
  [[nodiscard]] bool cut_off() const noexcept { return !missing_.empty(); }
  /// True if the last call threw because the container is damaged; see recovery().
  [[nodiscard]] bool damaged() const noexcept { return damaged_; }
  /// The frame at which seek() made it begin, if any.
  [[nodiscard]] std::optional<std::uint64_t> sought() const noexcept { return sought_; }
  /// The first and the last frame of next_frame(), if any.
  [[nodiscard]] std::optional<std::uint64_t> first_frame() const noexcept { return first_frame_; }
  [[nodiscard]] std::optional<std::uint64_t> last_frame() const noexcept { return last_frame_; }
  /// "it holds frames 0-7", of the selected textures, for messages. Reads to the end.
  [[nodiscard]] std::string frames_there();
  /// "x.gic: frame 3, texture vis", with the region if the volume has several.
  [[nodiscard]] std::string where(std::uint64_t frame, TextureRegion part) const;
  [[nodiscard]] std::string where(const ContainerPacket& packet) const {
    return where(packet.frame, {packet.texture_id, packet.region});
  }

 private:
  /// Counts the bytes read of a source.
  class CountingSource final : public Source {
   public:
    explicit CountingSource(std::unique_ptr<Source> source) : source_(std::move(source)) {}
    Result<std::size_t> read(std::span<std::byte> into) override {
      auto got = source_->read(into);
      if (got.ok()) bytes_read_ += *got;
      return got;
    }
    [[nodiscard]] std::optional<std::uint64_t> size() const override { return source_->size(); }
    Status seek(std::uint64_t offset) override { return source_->seek(offset); }
    bool prefetch(std::span<const ByteRange> ranges) override { return source_->prefetch(ranges); }
    [[nodiscard]] std::uint64_t bytes_read() const { return bytes_read_; }

   private:
    std::unique_ptr<Source> source_;
    std::uint64_t bytes_read_ = 0;
  };
  void open_file(const std::string& path);
  /// check(), with what a server said where reading failed.
  void check_read(Status status, const std::string& where) const;
  void open();
  [[noreturn]] void refuse_version();
  [[nodiscard]] StoredTexture stored(const TextureEntry& entry) const;
  /// Sets the player's selection, and the layouts of dumps.
  void prepare();
  [[nodiscard]] std::vector<TextureRegion> parts_in_box_of(
      std::span<const std::uint8_t> textures) const;
  void rewind();
  [[nodiscard]] bool go_on(Status (ContainerPlayer::*step)());
  [[noreturn]] void fail_at(Status status) const;
  /// "after frame 3", for damage behind the packets read so far.
  [[nodiscard]] std::string place_of_damage() const;
  void wait_for_more();
  void find_missing();
  void find_missing_by_index();
  void describe_cut();

  std::string path_;
  DecoderFlags decoding_;
  std::unique_ptr<const Backend> hevc_;
  OwnedFile file_;
  std::unique_ptr<CountingSource> source_;
  HttpSource* server_ = nullptr;  ///< in source_
  std::optional<ContainerPlayer> player_;
  std::vector<StoredTexture> textures_;
  std::vector<bool> selected_;  ///< by texture
  std::optional<std::uint64_t> first_frame_, last_frame_;
  std::optional<std::uint64_t> sought_;  ///< frame of seek()
  bool damaged_ = false;
  std::uint64_t followed_ = 0;            ///< bytes of a file that grows
  std::set<std::uint8_t> last_textures_;  ///< textures with packets in the last frame
  std::string missing_;
};

/// Says how much was read of a file on a server, and in how many round trips.
void remark_cost(const ContainerInput& input);

/// For programs whose result would be wrong or short if the end is missing. If it is, throws Error
/// of Exit::bad_input that names --allow-incomplete, or if `allowed` returns a remark for the user;
/// else returns an empty text. For a pipe, call it at its end.
[[nodiscard]] std::string require_complete(const ContainerInput& input, bool allowed);

/// Throws Error of Exit::bad_input if the last decoded frame lacks packets of some textures because
/// of damage. Reads on to find out: packets that follow show whether the frame was written so.
void require_whole(ContainerInput& input);

/// Prints what is missing, and `rest`; returns Exit::bad_input unless `allowed`.
[[nodiscard]] Exit report_cut_off(const ContainerInput& input, const std::string& rest,
                                  bool allowed);
/// True if all textures of a volume can become dumps.
[[nodiscard]] bool has_dumps(const ContainerInput& input, std::size_t volume);
/// The command that recovers the readable part of a damaged or cut off container, in words.
[[nodiscard]] std::string recovery(const ContainerInput& input);

/// Throws Error of Exit::bad_input with a hint if dumps of two selected textures would have the
/// same file names.
void require_distinct_files(const ContainerInput& input);
/// Selects the textures of the volume of that name; empty: of all volumes.
void select_volume(ContainerInput& input, const std::string& volume);
/// The same. Throws Error of Exit::bad_input with a hint if one cannot become a dump, and as
/// require_distinct_files() does.
void select_dumps(ContainerInput& input, const std::string& volume);

}  // namespace gicodec::tools

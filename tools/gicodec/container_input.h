// A container read frame by frame, from a file or standard input.
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
#include <string>
#include <utility>
#include <vector>

namespace gicodec::tools {

class ContainerInput {
 public:
  /// "-" is standard input. Throws if it cannot be opened or is no container. A file whose end is
  /// missing is read through once to find out what is there.
  explicit ContainerInput(const std::string& path);

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] const ContainerDescription& description() const noexcept {
    return reader_->description();
  }
  /// All that description() has, also those that no dump can be made of.
  [[nodiscard]] const std::vector<StoredTexture>& textures() const noexcept { return textures_; }
  /// Nothing for a pipe.
  [[nodiscard]] std::optional<std::uint64_t> bytes() const { return source_->size(); }

  /// From now on there are no packets but of these textures; of others nothing is read where the
  /// container can seek. Before the first frame only.
  void select(const std::vector<std::size_t>& textures);
  [[nodiscard]] bool is_selected(std::size_t texture) const { return selected_[texture]; }
  /// Makes frame `frame` come early in next_frame() if the container can seek.
  void seek(std::uint64_t frame);
  /// The packets of the next frame; false at the end. Damage throws after all frames before it.
  [[nodiscard]] bool next_frame(std::uint64_t& frame, std::vector<ContainerPacket>& packets);
  /// What is there and what is not where the end is missing, in words; the last frame may lack
  /// textures then. Empty for a whole container, and for a pipe until its end has been reached.
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
  [[nodiscard]] bool cut_off() const noexcept { return !missing_.empty(); }
  /// "x.gic: frame 3, texture vis", with the region of a volume that is cut.
  [[nodiscard]] std::string where(const ContainerPacket& packet) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const {
      if (file != stdin) std::fclose(file);
    }
  };
  void open();
  void read_ahead();
  void find_missing();
  void describe_cut();

  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::unique_ptr<FileSource> source_;
  std::optional<ContainerReader> reader_;
  std::vector<StoredTexture> textures_;
  std::vector<bool> selected_;  ///< by texture
  std::optional<ContainerPacket> ahead_;
  std::optional<std::uint64_t> first_frame_, last_frame_;
  std::set<std::uint8_t> last_textures_;  ///< of the last frame
  Status failure_ = Status::ok;
  bool started_ = false;
  std::string missing_;
};

/// For programs whose result would be wrong or short without the end. Throws Error of
/// Exit::bad_input that names --allow-incomplete if the end is missing, unless `allowed`: gives the
/// remark for the user then. Empty if nothing is missing. Pipes are to be asked at their end.
[[nodiscard]] std::string require_complete(const ContainerInput& input, bool allowed);

/// Says what is missing; the exit code is bad_input unless `allowed`.
[[nodiscard]] Exit report_cut_off(const ContainerInput& input, std::size_t frames, bool allowed);

/// Throws Error of Exit::bad_input that names the cure where files of two selected textures that
/// dumps can be made of would have the same names.
void require_distinct_files(const ContainerInput& input);
/// Selects the textures of the volume of that name, or of all volumes if it is empty.
void select_volume(ContainerInput& input, const std::string& volume);
/// The same. Throws Error of Exit::bad_input that names the cure where no dump can be made of one,
/// and as require_distinct_files() does.
void select_dumps(ContainerInput& input, const std::string& volume);

}  // namespace gicodec::tools

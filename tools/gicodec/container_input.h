// A container read frame by frame, from a file or standard input.
#pragma once

#include "backend_flags.h"
#include "dump/error.h"
#include "stored_texture.h"

#include <gicodec/gicodec.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
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
  [[nodiscard]] const std::vector<StoredTexture>& textures() const noexcept { return textures_; }
  /// Nothing for a pipe.
  [[nodiscard]] std::optional<std::uint64_t> bytes() const { return source_->size(); }

  /// Makes frame `frame` come early in next_frame() if the container can seek.
  void seek(std::uint64_t frame);
  /// The packets of the next frame; false at the end. Damage throws after all frames before it.
  [[nodiscard]] bool next_frame(std::uint64_t& frame, std::vector<ContainerPacket>& packets);
  /// What is there and what is not where the end is missing, in words; the last frame may lack
  /// textures then. Empty for a whole container, and for a pipe until its end has been reached.
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
  [[nodiscard]] bool cut_off() const noexcept { return !missing_.empty(); }

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
  std::optional<ContainerPacket> ahead_;
  std::optional<std::uint64_t> first_frame_, last_frame_;
  std::vector<std::uint8_t> last_textures_;  ///< of the last frame
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

/// Decoded state of every texture of a container that has packets. A texture's memory is taken with
/// its first packet, and counts for all of them together: a description costs nothing.
class TextureStates {
 public:
  explicit TextureStates(const ContainerInput& input, const DecoderFlags& flags = {});

  /// Applies a packet; `frame` is for messages. Different textures may be used by different
  /// threads.
  void apply(const ContainerPacket& packet);
  /// Zeros before the first packet.
  [[nodiscard]] std::span<const std::byte> texels(std::size_t texture) {
    return open(texture).texels;
  }

 private:
  struct State {
    std::optional<Decoder> decoder;
    std::vector<std::byte> texels;
  };
  State& open(std::size_t texture);

  const ContainerInput& input_;
  DecoderFlags flags_;
  std::vector<State> states_;
  std::atomic<std::uint64_t> memory_ = 0;  ///< of the textures that are open
};

}  // namespace gicodec::tools

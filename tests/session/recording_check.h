// Records what a client receives, and plays it at once: what comes out is what the client holds.
#pragma once

#include "container_support.h"

#include <gicodec/player.h>
#include <gicodec/recorder.h>

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gicodec::test {

class RecordingCheck final : public ClientListener {
 public:
  explicit RecordingCheck(std::vector<const Kind*> kinds = {}) : kinds_(std::move(kinds)) {}

  void updated(const Client& client,
               std::span<const UpdateMessage::Part> packets) noexcept override {
    if (recorder_ && !recorder_->fits(client)) finish();
    if (!recorder_ && packets.empty()) return;
    if (!recorder_) begin(client);
    if (!recorder_) return;
    ASSERT_EQ(recorder_->add(client, packets), Status::ok);
    updates += packets.empty() ? 0 : 1;
    play(client);
  }
  /// Ends the container that is being written.
  void finish() {
    if (!recorder_) return;
    waiting += recorder_->waiting();
    ASSERT_EQ(recorder_->finish(), Status::ok);
    player_.reset();
    source_.reset();
    recorder_.reset();
    containers.push_back(std::move(sink_->bytes));
  }

  std::vector<Bytes> containers;  ///< that are finished
  std::vector<std::uint64_t> frames;
  std::size_t updates = 0, waiting = 0, compared = 0;

 private:
  void begin(const Client& client) {
    const auto description = ClientRecorder::describe(client);
    ASSERT_EQ(description.status(), Status::ok);
    sink_ = std::make_unique<MemorySink>();
    auto recorder = ClientRecorder::begin(*sink_, client, *description);
    ASSERT_EQ(recorder.status(), Status::ok);
    recorder_.emplace(*std::move(recorder));
    source_ = std::make_unique<Growing>(sink_->bytes);
    auto player = ContainerPlayer::open(*source_, {.kinds = kinds_});
    ASSERT_EQ(player.status(), Status::ok);
    player_.emplace(*std::move(player));
  }

  void play(const Client& client) {
    Status status = Status::ok;
    while ((status = player_->next()) == Status::ok) frames.push_back(player_->frame());
    ASSERT_EQ(status, Status::truncated);
    if (recorder_->waiting() > 0) return;
    std::uint8_t id = 0;
    for (const ClientVolume& volume : client.frame().volumes) {
      for (const ClientTexture& texture : volume.textures) {
        Bytes played(static_cast<std::size_t>(texture_bytes(texture.desc)));
        Bytes held(played.size());
        const auto place = static_cast<std::uint8_t>(&texture - volume.textures.data());
        ASSERT_EQ(player_->read(id++, TextureView{played}), Status::ok);
        if (texture.texels.empty()) {
          ASSERT_EQ(client.read(volume.id, place, 0, TextureView{held}), Status::ok);
        } else {
          held = texture.texels;
        }
        ASSERT_TRUE(played == held) << volume.name << ", " << texture.name;
        ++compared;
      }
    }
  }

  /// Sees what the sink has so far.
  class Growing final : public Source {
   public:
    explicit Growing(const Bytes& bytes) : bytes_(&bytes) {}
    Result<std::size_t> read(std::span<std::byte> into) override {
      const std::size_t size = std::min(into.size(), bytes_->size() - at_);
      std::copy_n(bytes_->begin() + static_cast<std::ptrdiff_t>(at_), size, into.begin());
      at_ += size;
      return size;
    }
    [[nodiscard]] std::optional<std::uint64_t> size() const override { return bytes_->size(); }
    Status seek(std::uint64_t offset) override {
      at_ = static_cast<std::size_t>(offset);
      return Status::ok;
    }

   private:
    const Bytes* bytes_;
    std::size_t at_ = 0;
  };

  std::vector<const Kind*> kinds_;
  std::unique_ptr<MemorySink> sink_;
  std::unique_ptr<Growing> source_;
  std::optional<ClientRecorder> recorder_;
  std::optional<ContainerPlayer> player_;
};

}  // namespace gicodec::test

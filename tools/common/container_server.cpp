// What is special about containers on servers, where the index says what others read packets for,
// and about those that grow.
#include "cli.h"
#include "container_input.h"
#include "dump/error.h"
#include "interrupts.h"

#include <chrono>
#include <thread>

namespace gicodec::tools {

void ContainerInput::check_read(Status status, const std::string& where) const {
  if (status == Status::io_failed && server_ != nullptr && !server_->failure().empty()) {
    fail(Exit::io, "{}: {}", where, server_->failure());
  }
  check(status, where);
}

void ContainerInput::wait_for_more() {
  constexpr auto kPause = std::chrono::milliseconds(250);
  check_interrupt();
  std::this_thread::sleep_for(kPause);
  if (server_ != nullptr) {
    if (!server_->refresh()) fail(Exit::io, "{}: {}", path_, server_->failure());
    return;
  }
  const auto opened = state_of(file_.get()), named = state_of(path_.c_str());
  if (!opened || !named || !opened->same_file(*named) || opened->size < followed_) {
    fail(Exit::io, "{}: was replaced, cut or removed; run the command again", path_);
  }
  followed_ = opened->size;
}

void ContainerInput::find_missing_by_index() {
  const auto frames = player_->frames();
  if (!frames || frames->empty()) return;
  first_frame_ = frames->front();
  last_frame_ = frames->back();
  for (std::size_t i = 0; i < textures_.size(); ++i) {
    last_textures_.insert(static_cast<std::uint8_t>(i));
  }
  describe_cut();
  rewind();
}

std::optional<ContainerInput::Listed> ContainerInput::from_index() {
  if (!player_->seekable()) return std::nullopt;
  auto parts = player_->listed();
  if (parts.status() == Status::unknown_frame) return std::nullopt;
  check_read(parts.status(), path_);
  const auto frames = player_->frames();
  check_read(frames.status(), path_);
  return Listed{*std::move(parts), frames->size()};
}

void remark_cost(const ContainerInput& input) {
  const HttpSource::Cost* const cost = input.cost();
  if (cost == nullptr) return;
  remark(fmt::format("{}: {} of {} bytes read in {} round trip{}", input.path(), cost->bytes,
                     *input.bytes(), cost->round_trips, cost->round_trips == 1 ? "" : "s"));
}

}  // namespace gicodec::tools

// A client on a thread of its own. The lock guards the queue and the replies. Decoding and frames
// do without it.
#include <gicodec/client.h>

#include "base/guard.h"
#include "base/triple_buffer.h"
#include "session/client/client_state.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace gicodec {

struct ClientThread::State {
  explicit State(const Options& options_in) : options(options_in) {}
  ~State() {
    {
      const std::lock_guard lock(mutex);
      stop = cancel = true;
      wake.notify_all();
    }
    if (thread.joinable()) thread.join();
  }
  void run();
  void rest(std::unique_lock<std::mutex>& lock);
  Status follow_volumes();
  Status show(ClientFrame& to) const;
  /// Decodes one message. The caller does not hold the lock.
  Status work(const Message& message);

  std::optional<Client> client;  ///< for the worker while `busy`, else guarded by the lock
  Options options;
  bool texels = true;       ///< frames have texels; the client's own frame has none
  std::uint64_t shown = 0;  ///< serial of the last finished frame
  TripleBuffer<ClientFrame> frames;

  mutable std::mutex mutex;
  std::condition_variable wake, rested;
  std::deque<Message> waiting;
  std::size_t waiting_bytes = 0;
  std::vector<Message> replies;
  Interest interest;                        ///< instead of the client's
  std::optional<std::uint32_t> generation;  ///< that `interest` knows; nullopt: no session
  Status status = Status::ok;
  Goodbye goodbye;
  ClientStatistics statistics;
  bool busy = false, stop = false;
  std::atomic<bool> cancel{false};  ///< cancels the message being decoded

  std::thread thread;
};

/// Makes `to`, one of the frames, equal to what the client holds. Reads texels from the decoders.
Status ClientThread::State::show(ClientFrame& to) const {
  const std::uint64_t before = to.serial;
  const Status copied = copy_changes(client->frame(), to);
  if (copied != Status::ok || !texels) return copied;
  const Status filled = guarded([&]() -> Status {
    for (ClientVolume& volume : to.volumes) {
      for (std::uint8_t t = 0; t < volume.textures.size(); ++t) {
        ClientTexture& texture = volume.textures[t];
        const bool anew = texture.texels.empty();
        if (anew) texture.texels.resize(static_cast<std::size_t>(texture_bytes(texture.desc)));
        const Status read =
            client->read(volume.id, t, anew ? 0 : before, TextureView{texture.texels});
        if (read != Status::ok) return read;
      }
    }
    return Status::ok;
  });
  if (filled != Status::ok) to.serial = before;  // Some texels are still of that serial.
  return filled;
}

Status ClientThread::State::work(const Message& message) {
  const Status result = client->receive(message);
  const std::uint64_t now = client->frame().serial;
  if (result != Status::ok || !client->consistent() || now == shown) return result;
  const Status copied = show(frames.back());
  if (copied != Status::ok) return copied;  // The next message tries again.
  shown = now;
  frames.publish();
  return Status::ok;
}

void ClientThread::State::run() {
  std::unique_lock lock(mutex);
  while (true) {
    wake.wait(lock, [&] { return stop || !waiting.empty(); });
    if (stop) return;
    const Message message = std::move(waiting.front());
    waiting.pop_front();
    waiting_bytes -= message.size();
    busy = true;
    lock.unlock();
    Status result = work(message);
    auto made = client->take_messages();
    lock.lock();
    busy = false;
    const Status kept = guarded([&]() -> Status {
      replies.reserve(replies.size() + made.size());
      std::move(made.begin(), made.end(), std::back_inserter(replies));
      if (result == Status::end) goodbye = client->goodbye();
      return follow_volumes();
    });
    if (kept != Status::ok) result = kept;
    if (status == Status::ok) status = result;
    if (status != Status::ok) {
      waiting.clear();
      waiting_bytes = 0;
    }
    statistics = client->statistics();
    rested.notify_all();
  }
}

ClientThread::ClientThread(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
ClientThread::ClientThread(ClientThread&&) noexcept = default;
ClientThread& ClientThread::operator=(ClientThread&&) noexcept = default;

ClientThread::~ClientThread() = default;

Result<ClientThread> ClientThread::start(Client&& client, const Options& options) {
  return guarded([&]() -> Result<ClientThread> {
    auto state = std::make_unique<State>(options);
    state->thread = std::thread([raw = state.get()] { raw->run(); });
    Client::State& of_client = *client.state_;
    of_client.frames += 2;  // Three frames instead of one.
    state->texels = std::exchange(of_client.options.texels, false);
    for (ClientVolume& volume : of_client.frame.volumes) {
      for (ClientTexture& texture : volume.textures) std::vector<std::byte>().swap(texture.texels);
    }
    if (of_client.options.cancel == nullptr) of_client.options.cancel = &state->cancel;
    state->interest = std::move(of_client.interest);
    of_client.interest = {};
    state->client = std::move(client);  // The thread uses it once there is a message.
    return ClientThread(std::move(state));
  });
}

Result<ClientThread> ClientThread::start(Client&& client) { return start(std::move(client), {}); }

/// Drops the queue, and cancels the message being decoded.
void ClientThread::State::rest(std::unique_lock<std::mutex>& lock) {
  waiting.clear();
  waiting_bytes = 0;
  cancel = true;
  rested.wait(lock, [&] { return !busy; });
  cancel = false;
  interest.end();
  generation.reset();
}

/// Sends the interest to a new session; drops interest in volumes that have gone.
Status ClientThread::State::follow_volumes() {
  if (!client->is_connected()) return Status::ok;
  const std::uint32_t now = client->state_->generation;
  if (generation == now) return Status::ok;
  const auto before = std::exchange(generation, now);
  const auto& volumes = client->frame().volumes;
  return before ? interest.change(now, volumes) : interest.begin(now, volumes, replies);
}

Result<Message> ClientThread::hello() {
  std::unique_lock lock(state_->mutex);
  state_->rest(lock);
  state_->replies.clear();
  state_->status = Status::ok;
  return state_->client->hello();
}

Status ClientThread::set_viewpoint(const Viewpoint& viewpoint) {
  const std::lock_guard lock(state_->mutex);
  return state_->interest.set_viewpoint(viewpoint, state_->replies);
}

Status ClientThread::subscribe(std::uint16_t volume, std::span<const std::uint8_t> blocks,
                               std::uint8_t group) {
  const std::lock_guard lock(state_->mutex);
  return state_->interest.subscribe(volume, blocks, group, state_->replies);
}

Status ClientThread::disconnect() {
  std::unique_lock lock(state_->mutex);
  state_->rest(lock);
  const Status status = state_->client->disconnect();
  if (status != Status::ok) return status;
  state_->replies = state_->client->take_messages();
  state_->status = Status::end;
  return Status::ok;
}

Status ClientThread::push(Message message) {
  return guarded([&]() -> Status {
    const std::lock_guard lock(state_->mutex);
    if (state_->status != Status::ok) return state_->status;
    if (message.size() > state_->options.max_waiting_bytes - state_->waiting_bytes) {
      return Status::limit_exceeded;
    }
    state_->waiting_bytes += message.size();
    state_->waiting.push_back(std::move(message));
    state_->wake.notify_one();
    return Status::ok;
  });
}

std::vector<Message> ClientThread::take_messages() {
  const std::lock_guard lock(state_->mutex);
  return std::exchange(state_->replies, {});
}

Status ClientThread::status() const {
  const std::lock_guard lock(state_->mutex);
  return state_->status;
}

Result<Goodbye> ClientThread::goodbye() const {
  return guarded([&]() -> Result<Goodbye> {
    const std::lock_guard lock(state_->mutex);
    return state_->goodbye;
  });
}

ClientStatistics ClientThread::statistics() const {
  const std::lock_guard lock(state_->mutex);
  return state_->statistics;
}

bool ClientThread::idle() const {
  const std::lock_guard lock(state_->mutex);
  return !state_->busy && state_->waiting.empty();
}

const ClientFrame& ClientThread::latest() noexcept { return state_->frames.latest(); }

}  // namespace gicodec

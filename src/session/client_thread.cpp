// A client on a thread of its own. The lock guards the queue and the replies; nothing is decoded
// and no frame is handed over under it.
#include <gicodec/client.h>

#include "base/guard.h"
#include "base/triple_buffer.h"
#include "session/client_state.h"

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
  /// Decodes one message; without the lock.
  Status work(const Message& message);

  std::optional<Client> client;  ///< the worker's while `busy`, else of whoever has the lock
  Options options;
  TripleBuffer<ClientFrame> frames;

  mutable std::mutex mutex;
  std::condition_variable wake, rested;
  std::deque<Message> waiting;
  std::size_t waiting_bytes = 0;
  std::vector<Message> replies;
  Status status = Status::ok;
  Goodbye goodbye;
  ClientStatistics statistics;
  bool busy = false, stop = false;
  std::atomic<bool> cancel{false};  ///< the message being decoded

  std::thread thread;
};

Status ClientThread::State::work(const Message& message) {
  const std::uint64_t before = client->frame().serial;
  const Status result = client->receive(message);
  if (result != Status::ok || !client->consistent() || client->frame().serial == before)
    return result;
  const Status copied = copy_changes(client->frame(), frames.back());
  if (copied == Status::ok) frames.publish();
  return copied;
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
    auto made = client->take_replies();
    lock.lock();
    busy = false;
    const Status kept = guarded([&]() -> Status {
      replies.reserve(replies.size() + made.size());
      std::move(made.begin(), made.end(), std::back_inserter(replies));
      if (result == Status::end) goodbye = client->goodbye();
      return Status::ok;
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
    of_client.frames += 3;
    if (of_client.options.cancel == nullptr) of_client.options.cancel = &state->cancel;
    state->client = std::move(client);  // The thread looks at it when there is a message.
    return ClientThread(std::move(state));
  });
}

Result<ClientThread> ClientThread::start(Client&& client) { return start(std::move(client), {}); }

Result<Message> ClientThread::hello() {
  std::unique_lock lock(state_->mutex);
  state_->waiting.clear();
  state_->waiting_bytes = 0;
  state_->cancel = true;
  state_->rested.wait(lock, [&] { return !state_->busy; });
  state_->cancel = false;
  state_->replies.clear();
  state_->status = Status::ok;
  return state_->client->hello();
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

std::vector<Message> ClientThread::take_replies() {
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

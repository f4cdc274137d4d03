#include "modules/nats.h"

#include "modules/nats_inbound.h"

#include <nats/nats.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>

namespace gicodec::tools {
namespace {

constexpr double kLongestAttempt = 8;         // seconds
constexpr std::int64_t kReconnectWait = 100;  // milliseconds
constexpr std::int64_t kPing = 1000;          // milliseconds; two without an answer are a loss
constexpr std::int64_t kLastFlush = 500;      // milliseconds

template <auto function>
struct Destroy {
  template <typename T>
  void operator()(T* what) const noexcept {
    function(what);
  }
};
using Options = std::unique_ptr<natsOptions, Destroy<natsOptions_Destroy>>;
using Connection = std::unique_ptr<natsConnection, Destroy<natsConnection_Destroy>>;
using Subscription = std::unique_ptr<natsSubscription, Destroy<natsSubscription_Destroy>>;
using Received = std::unique_ptr<natsMsg, Destroy<natsMsg_Destroy>>;

/// What libnats gives back with each message of a subscription.
struct Topic {
  std::shared_ptr<Inbound> inbound;
  std::uint64_t id = 0;
};

class LibNats final : public NatsConnection {
 public:
  explicit LibNats(const NatsOptions& options)
      : options_(options), inbound_(std::make_shared<Inbound>(options.max_received)) {
    char* inbox = nullptr;
    if (natsInbox_Create(&inbox) != NATS_OK) throw std::bad_alloc();
    inbox_ = inbox;
    natsInbox_Destroy(inbox);
    sender_ = std::jthread([this] { run(); });
  }
  ~LibNats() override {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    sender_.join();
  }
  LibNats(const LibNats&) = delete;
  LibNats& operator=(const LibNats&) = delete;

  std::uint64_t subscribe(const std::string& subject) override;
  void unsubscribe(std::uint64_t subscription) override;
  bool publish(NatsMessage&& message) override;
  bool next(NatsMessage& message, unsigned milliseconds) override {
    return inbound_->take(message, milliseconds);
  }
  NatsState state() override;
  const std::string& inbox() const noexcept override { return inbox_; }

 private:
  /// What the sender does, in the order of the calls.
  struct Task {
    enum class Type : std::uint8_t { subscribe, unsubscribe, publish } type{};
    std::uint64_t subscription = 0;
    NatsMessage message = {};  ///< or the subject to subscribe to
  };

  void run();
  void connect();
  natsStatus set_options(natsOptions* options, double seconds);
  void take_connection(natsConnection* connection);
  void close();
  bool add(Task&& task);
  void perform(const Task& task);
  void fail(natsStatus status, const char* detail, bool final);

  NatsOptions options_;
  std::string inbox_;
  std::shared_ptr<Inbound> inbound_;

  // The sender's.
  Connection connection_;
  std::map<std::uint64_t, Subscription> subscriptions_;

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  std::size_t unsent_bytes_ = 0;
  std::uint64_t last_subscription_ = 0;
  NatsState state_;
  bool ends_ = false, closed_ = false;

  std::jthread sender_;
};

bool LibNats::add(Task&& task) {
  const std::size_t bytes = memory_of(task.message);
  const std::lock_guard lock(mutex_);
  const bool full = unsent_bytes_ > 0 && unsent_bytes_ + bytes > options_.max_unsent;
  if (task.type == Task::Type::publish && full) return false;
  try {
    tasks_.push_back(std::move(task));
  } catch (const std::bad_alloc&) {
    return false;
  }
  unsent_bytes_ += bytes;
  changed_.notify_all();
  return true;
}

std::uint64_t LibNats::subscribe(const std::string& subject) {
  const std::uint64_t id = ++last_subscription_;
  return add({Task::Type::subscribe, id, {.subject = subject}}) ? id : 0;
}

void LibNats::unsubscribe(std::uint64_t subscription) {
  static_cast<void>(add({Task::Type::unsubscribe, subscription}));
}

bool LibNats::publish(NatsMessage&& message) {
  return add({Task::Type::publish, 0, std::move(message)});
}

NatsState LibNats::state() {
  const std::uint64_t dropped = inbound_->dropped();
  const std::lock_guard lock(mutex_);
  state_.dropped = dropped;
  return state_;
}

void LibNats::fail(natsStatus status, const char* detail, bool final) {
  if (status == NATS_OK) status = NATS_CONNECTION_DISCONNECTED;  // by the other end
  const std::lock_guard lock(mutex_);
  state_.failure = detail != nullptr && *detail != '\0' ? detail : natsStatus_GetText(status);
  state_.final = state_.final || final;
}

natsStatus LibNats::set_options(natsOptions* options, double seconds) {
  std::vector<const char*> urls;
  for (const std::string& url : options_.urls) urls.push_back(url.c_str());
  const auto timeout = static_cast<std::int64_t>(seconds * 1e3);
  natsStatus status = natsOptions_SetServers(options, urls.data(), static_cast<int>(urls.size()));
  const auto set = [&status](natsStatus next) {
    if (status == NATS_OK) status = next;
  };
  set(natsOptions_SetNoRandomize(options, true));
  set(natsOptions_SetName(options, options_.name.c_str()));
  set(natsOptions_SetTimeout(options, timeout));
  set(natsOptions_SetWriteDeadline(options, timeout));
  set(natsOptions_SetMaxReconnect(options, -1));
  set(natsOptions_SetReconnectWait(options, kReconnectWait));
  set(natsOptions_SetReconnectJitter(options, kReconnectWait, kReconnectWait));
  set(natsOptions_SetPingInterval(options, kPing));
  set(natsOptions_SetMaxPingsOut(options, 2));
  // What is published while there is no connection is old when there is one.
  set(natsOptions_SetReconnectBufSize(options, 0));
  // One thread delivers the messages of all subscriptions in their order.
  set(natsOptions_UseGlobalMessageDelivery(options, true));
  if (!options_.user.empty())
    set(natsOptions_SetUserInfo(options, options_.user.c_str(), options_.password.c_str()));
  bool secure = !options_.ca.empty();
  for (const std::string& url : options_.urls) secure = secure || url.starts_with("tls://");
  if (secure) set(natsOptions_SetSecure(options, true));
  if (!options_.ca.empty())
    set(natsOptions_LoadCATrustedCertificates(options, options_.ca.c_str()));
  set(natsOptions_SetDisconnectedCB(
      options,
      [](natsConnection* connection, void* self) {
        auto* const me = static_cast<LibNats*>(self);
        const char* detail = nullptr;
        const natsStatus why = natsConnection_GetLastError(connection, &detail);
        me->fail(why, detail, false);
        const std::lock_guard lock(me->mutex_);
        me->state_.connected = false;
      },
      this));
  set(natsOptions_SetReconnectedCB(
      options,
      [](natsConnection* connection, void* self) {
        static_cast<LibNats*>(self)->take_connection(connection);
      },
      this));
  set(natsOptions_SetClosedCB(
      options,
      [](natsConnection* connection, void* self) {
        auto* const me = static_cast<LibNats*>(self);
        const char* detail = nullptr;
        const natsStatus why = natsConnection_GetLastError(connection, &detail);
        me->fail(why, detail, true);
        const std::lock_guard lock(me->mutex_);
        me->closed_ = true;  // The last that libnats says of the connection.
        me->changed_.notify_all();
      },
      this));
  set(natsOptions_SetErrorHandler(
      options,
      [](natsConnection* connection, natsSubscription*, natsStatus why, void* self) {
        const char* detail = nullptr;
        static_cast<void>(natsConnection_GetLastError(connection, &detail));
        static_cast<LibNats*>(self)->fail(why, detail, false);
      },
      this));
  return status;
}

void LibNats::take_connection(natsConnection* connection) {
  const std::lock_guard lock(mutex_);
  state_.connected = true;
  ++state_.connections;
  state_.failure.clear();
  state_.max_payload = static_cast<std::size_t>(natsConnection_GetMaxPayload(connection));
}

/// Tries until it is connected, or refused, or the program ends.
void LibNats::connect() {
  // Longer each time, for servers that are far away.
  const double longest = std::max(options_.timeout, kLongestAttempt);
  for (double seconds = options_.timeout;; seconds = std::min(2 * seconds, longest)) {
    natsOptions* made = nullptr;
    natsStatus status = natsOptions_Create(&made);
    const Options options(made);
    if (status == NATS_OK) status = set_options(made, seconds);
    if (status != NATS_OK) return fail(status, nats_GetLastError(nullptr), true);
    natsConnection* connection = nullptr;
    status = natsConnection_Connect(&connection, made);
    if (status == NATS_OK) {
      connection_.reset(connection);
      return take_connection(connection);
    }
    const bool refused = status == NATS_CONNECTION_AUTH_FAILED || status == NATS_SSL_ERROR ||
                         status == NATS_SECURE_CONNECTION_REQUIRED ||
                         status == NATS_SECURE_CONNECTION_WANTED || status == NATS_INVALID_ARG;
    fail(status, nats_GetLastError(nullptr), refused);
    if (refused) return;
    std::unique_lock lock(mutex_);
    const bool ends = changed_.wait_for(lock, std::chrono::milliseconds(kReconnectWait),
                                        [this] { return ends_; });
    if (ends) return;
  }
}

void LibNats::close() {
  // What was published last should arrive.
  static_cast<void>(natsConnection_FlushTimeout(connection_.get(), kLastFlush));
  subscriptions_.clear();
  natsConnection_Close(connection_.get());
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_; });
  }
  connection_.reset();
}

void LibNats::perform(const Task& task) {
  natsStatus status = NATS_OK;
  if (task.type == Task::Type::unsubscribe) {
    const auto found = subscriptions_.find(task.subscription);
    if (found == subscriptions_.end()) return;
    status = natsSubscription_Unsubscribe(found->second.get());
    subscriptions_.erase(found);
  } else if (task.type == Task::Type::subscribe) {
    auto topic = std::make_unique<Topic>(Topic{inbound_, task.subscription});
    natsSubscription* made = nullptr;
    status = natsConnection_Subscribe(
        &made, connection_.get(), task.message.subject.c_str(),
        [](natsConnection*, natsSubscription*, natsMsg* message, void* given) {
          const Received received(message);
          const auto* const of = static_cast<const Topic*>(given);
          of->inbound->add(of->id, message);
        },
        topic.get());
    if (status == NATS_OK) {
      subscriptions_[task.subscription].reset(made);
      // Inbound has limits of its own.
      static_cast<void>(natsSubscription_SetPendingLimits(made, -1, -1));
      status = natsSubscription_SetOnCompleteCB(
          made, [](void* given) { delete static_cast<Topic*>(given); }, topic.get());
      static_cast<void>(topic.release());
    }
  } else {
    const NatsMessage& message = task.message;
    natsMsg* made = nullptr;
    status = natsMsg_Create(
        &made, message.subject.c_str(), message.reply.empty() ? nullptr : message.reply.c_str(),
        reinterpret_cast<const char*>(message.data.data()), static_cast<int>(message.data.size()));
    const Received held(made);
    for (const auto& [key, value] : message.headers) {
      if (status == NATS_OK) status = natsMsgHeader_Set(made, key.c_str(), value.c_str());
    }
    if (status == NATS_OK) status = natsConnection_PublishMsg(connection_.get(), made);
  }
  if (status != NATS_OK) fail(status, nats_GetLastError(nullptr), false);
}

void LibNats::run() {
  connect();
  if (connection_ == nullptr) return;
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ends_ || !tasks_.empty(); });
    if (tasks_.empty()) break;
    const Task task = std::move(tasks_.front());
    tasks_.pop_front();
    unsent_bytes_ -= memory_of(task.message);
    lock.unlock();
    try {
      perform(task);
    } catch (const std::bad_alloc&) {
      fail(NATS_NO_MEMORY, nullptr, false);
    }
    lock.lock();
  }
  lock.unlock();
  close();
}

std::unique_ptr<NatsConnection> open_connection(const NatsOptions& options) {
  try {
    return std::make_unique<LibNats>(options);
  } catch (const std::bad_alloc&) {
    return nullptr;
  } catch (const std::system_error&) {
    return nullptr;
  }
}

}  // namespace

extern "C" GICODEC_MODULE_EXPORT const NatsModule gicodec_module;
const NatsModule gicodec_module{{"gicodec-nats"}, open_connection};

}  // namespace gicodec::tools

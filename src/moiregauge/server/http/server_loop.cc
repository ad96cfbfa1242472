// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/server_loop.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace moiregauge::internal {
namespace {

constexpr std::uint64_t kListenId = 1, kWakeId = 2, kFirstId = 16;
constexpr int kWait_ms = 100;            // longest time between two questions whether to continue
constexpr std::int64_t kSweep_ms = 250;  // between two searches for overdue connections

void register_with(int epoll, int file, std::uint64_t id, int action, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = id;
  ::epoll_ctl(epoll, action, file, &event);
}

}  // namespace

HttpServer::Loop::Loop(ListenSocket listening, std::unique_ptr<TlsContext> tls, const HttpLimits& limits)
    : listening_(listening), tls_(std::move(tls)), limits_(limits), next_id_(kFirstId) {
  epoll_ = ::epoll_create1(EPOLL_CLOEXEC);
  wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  register_with(epoll_, listening_.socket, kListenId, EPOLL_CTL_ADD, EPOLLIN);
  register_with(epoll_, wake_, kWakeId, EPOLL_CTL_ADD, EPOLLIN);
}

HttpServer::Loop::~Loop() {
  connections_.clear();
  ::close(listening_.socket);
  ::close(wake_);
  ::close(epoll_);
}

void HttpServer::Loop::run(HttpHandler& handler, const std::function<bool()>& may_continue) {
  handler_ = &handler;
  WorkerPool workers(limits_.workers, limits_.max_waiting);
  workers_ = &workers;
  while (may_continue()) {
    wait_for_events();
    collect_answers();
    send_events();
    close_overdue();
  }
  workers_ = nullptr;
}

void HttpServer::Loop::wait_for_events() {
  std::array<epoll_event, 128> ready{};
  const int count = ::epoll_wait(epoll_, ready.data(), static_cast<int>(ready.size()), kWait_ms);
  for (int i = 0; i < count; ++i) {
    const epoll_event& event = ready[static_cast<std::size_t>(i)];
    const std::uint64_t id = event.data.u64;
    if (id == kListenId) {
      accept_all();
    } else if (id == kWakeId) {
      std::uint64_t ignored = 0;
      while (::read(wake_, &ignored, sizeof ignored) > 0) continue;
    } else if (const auto found = connections_.find(id); found != connections_.end()) {
      settle(id, step(*found->second, event.events));
    }
  }
}

void HttpServer::Loop::accept_all() {
  constexpr int kMaxAtOnce = 64;
  for (int i = 0; i < kMaxAtOnce; ++i) {
    const int socket = ::accept4(listening_.socket, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket >= 0) {
      add(socket);
    } else {
      if (errno == EMFILE || errno == ENFILE) make_room();
      if (errno != EINTR && errno != ECONNABORTED) return;
    }
  }
}

void HttpServer::Loop::add(int socket) {
  if (connections_.size() >= limits_.max_connections) make_room();
  ssl_st* session = tls_ ? tls_->begin_session(socket) : nullptr;
  if (connections_.size() >= limits_.max_connections || (tls_ && session == nullptr)) {
    ::close(socket);
    return;
  }
  auto c = std::make_unique<Connection>(std::make_unique<ByteChannel>(socket, session), next_id_++);
  c->deadline_ms = now_ms() + limits_.head_ms;
  register_with(epoll_, socket, c->id, EPOLL_CTL_ADD, EPOLLIN);
  c->watched = EPOLLIN;
  connections_.emplace(c->id, std::move(c));
}

// Closes the connection that only waits and would expire first.
void HttpServer::Loop::make_room() {
  auto oldest = connections_.end();
  for (auto i = connections_.begin(); i != connections_.end(); ++i) {
    if (!i->second->can_be_dropped()) continue;
    if (oldest == connections_.end() || i->second->deadline_ms < oldest->second->deadline_ms) oldest = i;
  }
  if (oldest != connections_.end()) connections_.erase(oldest);
}

void HttpServer::Loop::settle(std::uint64_t id, bool is_open) {
  const auto found = connections_.find(id);
  if (found == connections_.end()) return;
  if (is_open) return watch(*found->second);
  release_body(*found->second);
  connections_.erase(found);
}

void HttpServer::Loop::watch(Connection& c) {
  std::uint32_t events = EPOLLIN;
  if (c.state == ConnectionState::kWorking) events = 0;
  if (c.state == ConnectionState::kWriting) events = EPOLLOUT;
  if (c.state == ConnectionState::kStreaming && c.has_output()) events |= EPOLLOUT;
  if (c.state == ConnectionState::kHandshake && c.channel->waits_for_write()) events = EPOLLOUT;
  if (events == c.watched) return;
  register_with(epoll_, c.channel->socket(), c.id, EPOLL_CTL_MOD, events);
  c.watched = events;
}

bool HttpServer::Loop::step(Connection& c, std::uint32_t events) {
  switch (c.state) {
    case ConnectionState::kHandshake: {
      const Transfer outcome = c.channel->shake_hands();
      if (outcome != Transfer::kProgress) return outcome == Transfer::kWait;
      c.state = ConnectionState::kHead;
      return receive(c);
    }
    case ConnectionState::kHead:
    case ConnectionState::kBody:
      return receive(c);
    case ConnectionState::kWorking:  // only errors are reported
      return (events & (EPOLLERR | EPOLLHUP)) == 0;
    case ConnectionState::kWriting:
      return send(c);
    case ConnectionState::kStreaming:
      return discard(c) && send_output(c) != Transfer::kEnd;
    case ConnectionState::kDraining:
      return discard(c);
  }
  return false;
}

void HttpServer::Loop::close_overdue() {
  const std::int64_t now = now_ms();
  if (now - swept_ms_ < kSweep_ms) return;
  swept_ms_ = now;
  std::vector<std::uint64_t> overdue;
  for (const auto& [id, c] : connections_) {
    if (c->deadline_ms < now) overdue.push_back(id);
  }
  for (const std::uint64_t id : overdue) settle(id, false);
}

}  // namespace moiregauge::internal

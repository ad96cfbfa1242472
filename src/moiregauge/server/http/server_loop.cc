// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/server_loop.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <exception>
#include <limits>

#include "moiregauge/server/http/request_head.h"

namespace moiregauge::internal {
namespace {

constexpr std::uint64_t kListenId = 1, kWakeId = 2, kFirstId = 16;
constexpr std::size_t kPiece = 64 << 10;   // bytes of one read
constexpr int kWait_ms = 100;              // longest time between two questions whether to continue
constexpr std::int64_t kSweep_ms = 250;    // between two searches for overdue connections
constexpr std::int64_t kBeat_ms = 15'000;  // between two comments in a stream, which find peers that vanished
constexpr std::int64_t kDrain_ms = 2'000;  // for a peer to read an answer before its request is complete
constexpr std::int64_t kNever_ms = std::numeric_limits<std::int64_t>::max();

std::int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void register_with(int epoll, int file, std::uint64_t id, int action, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = id;
  ::epoll_ctl(epoll, action, file, &event);
}

Answer answer_or_error(HttpHandler& handler, const Request& request) {
  try {
    return handler.answer(request);
  } catch (const std::exception&) {
    return error_answer(500, "the request failed: the server: look at its terminal");
  }
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

bool HttpServer::Loop::receive(Connection& c) {
  while (c.state == ConnectionState::kHead || c.state == ConnectionState::kBody) {
    const bool was_idle = c.is_idle();
    const Transfer outcome = c.channel->read(kPiece, c.in);
    if (outcome != Transfer::kProgress) return outcome == Transfer::kWait;
    if (was_idle) c.deadline_ms = now_ms() + limits_.head_ms;
    if (!advance(c)) return false;
  }
  return true;
}

bool HttpServer::Loop::discard(Connection& c) {
  std::string ignored;
  const Transfer outcome = c.channel->read(kPiece, ignored);
  return outcome != Transfer::kEnd;
}

bool HttpServer::Loop::advance(Connection& c) {
  if (c.state == ConnectionState::kHead) {
    const std::size_t length = head_length(c.in);
    if (std::max(length, length == 0 ? c.in.size() : 0) > kMaxHead)
      return refuse(c, error_answer(431, "the head is too long: the request: send up to 16 kB"));
    if (length == 0) return true;
    if (!begin_body(c, length)) return false;
  }
  if (c.state != ConnectionState::kBody) return true;
  return static_cast<std::int64_t>(c.in.size()) < c.head.content_length || submit(c);
}

bool HttpServer::Loop::begin_body(Connection& c, std::size_t length_of_head) {
  auto head = parse_request_head(std::string_view(c.in).substr(0, length_of_head));
  c.in.erase(0, length_of_head);
  if (!head) return refuse(c, error_answer(head.error().status, head.error().message));
  c.head = *std::move(head);
  if (auto refusal = handler_->refuse(c.head)) return refuse(c, *std::move(refusal));
  const std::int64_t length = c.head.content_length;
  if (length > handler_->max_body(c.head))
    return refuse(c, error_answer(413, "the body is too long: the request: send less"));
  if (bodies_ + length > limits_.max_bodies)
    return refuse(c, error_answer(503, "too many bodies are being received: the server: try again"));
  bodies_ += c.reserved_bytes = length;
  c.state = ConnectionState::kBody;
  c.deadline_ms = now_ms() + limits_.body_ms + length / limits_.slowest_bytes_per_ms;
  if (c.head.expects_continue && static_cast<std::int64_t>(c.in.size()) < length) {
    c.out = "HTTP/1.1 100 Continue\r\n\r\n";
    return send_output(c) == Transfer::kProgress;  // so few bytes always fit
  }
  return true;
}

void HttpServer::Loop::release_body(Connection& c) {
  bodies_ -= c.reserved_bytes;
  c.reserved_bytes = 0;
}

bool HttpServer::Loop::submit(Connection& c) {
  const auto length = static_cast<std::size_t>(c.head.content_length);
  auto request = std::make_shared<Request>();
  request->head = c.head;
  request->body = c.in.substr(0, length);
  c.in.erase(0, length);
  c.state = ConnectionState::kWorking;
  c.deadline_ms = kNever_ms;
  const bool is_accepted = workers_->add([this, request, id = c.id] {
    Answer answer = answer_or_error(*handler_, *request);
    {
      const std::lock_guard lock(mutex_);
      finished_.emplace_back(id, std::move(answer));
    }
    const std::uint64_t one = 1;
    (void)!::write(wake_, &one, sizeof one);
  });
  return is_accepted || refuse(c, error_answer(503, "too many requests wait: the server: try again"));
}

void HttpServer::Loop::collect_answers() {
  std::vector<Finished> finished;
  {
    const std::lock_guard lock(mutex_);
    finished.swap(finished_);
  }
  for (auto& [id, answer] : finished) {
    const auto found = connections_.find(id);
    if (found != connections_.end()) settle(id, begin_answer(*found->second, std::move(answer)));
  }
}

bool HttpServer::Loop::refuse(Connection& c, Answer answer) {
  c.head.can_stay_open = false;
  return begin_answer(c, std::move(answer));
}

bool HttpServer::Loop::begin_answer(Connection& c, Answer answer) {
  release_body(c);
  if (answer.is_event_stream) return begin_stream(c, answer);
  c.stays_open = c.head.can_stay_open;
  const std::int64_t length = answer.file ? answer.file->size() : static_cast<std::int64_t>(answer.body.size());
  c.out = answer_head(answer, length, c.stays_open);
  if (!answer.file) c.out += answer.body;
  c.sent = 0;
  c.file = std::move(answer.file);
  c.file_offset = 0;
  c.state = ConnectionState::kWriting;
  return send(c);
}

std::size_t HttpServer::Loop::streams() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      connections_, [](const auto& c) { return c.second->state == ConnectionState::kStreaming; }));
}

bool HttpServer::Loop::begin_stream(Connection& c, const Answer& answer) {
  if (streams() >= limits_.max_streams)
    return refuse(c, error_answer(503, "too many pages are open: the server: close one of them"));
  c.out = answer_head(answer, -1, false) + handler_->first_events();
  c.sent = 0;
  c.state = ConnectionState::kStreaming;
  c.deadline_ms = kNever_ms;
  return send_output(c) != Transfer::kEnd;
}

bool HttpServer::Loop::send(Connection& c) {
  const std::size_t sent = c.sent;
  const std::int64_t offset = c.file_offset;
  const Transfer outcome = send_output(c);
  if (outcome == Transfer::kEnd) return false;
  if (outcome == Transfer::kWait) {
    if (c.sent != sent || c.file_offset != offset || c.deadline_ms == kNever_ms)
      c.deadline_ms = now_ms() + limits_.write_ms;
    return true;
  }
  c.file.reset();
  if (!c.stays_open) {
    c.channel->finish_writing();
    c.in.clear();
    c.state = ConnectionState::kDraining;
    c.deadline_ms = now_ms() + kDrain_ms;
    return true;
  }
  c.state = ConnectionState::kHead;
  c.deadline_ms = now_ms() + (c.in.empty() ? limits_.idle_ms : limits_.head_ms);
  // The next request may have arrived with this one.
  return advance(c) && receive(c);
}

void HttpServer::Loop::publish(std::string event) {
  {
    const std::lock_guard lock(mutex_);
    events_ += event;
  }
  const std::uint64_t one = 1;
  (void)!::write(wake_, &one, sizeof one);
}

void HttpServer::Loop::send_events() {
  std::string events;
  {
    const std::lock_guard lock(mutex_);
    events.swap(events_);
  }
  const std::int64_t now = now_ms();
  if (now - beat_ms_ >= kBeat_ms) {
    beat_ms_ = now;
    events += ": beat\n\n";
  }
  if (events.empty()) return;
  std::vector<std::uint64_t> receivers;
  for (const auto& [id, c] : connections_) {
    if (c->state == ConnectionState::kStreaming) receivers.push_back(id);
  }
  for (const std::uint64_t id : receivers) {
    Connection& c = *connections_.at(id);
    c.out.erase(0, c.sent);
    c.sent = 0;
    c.out += events;
    settle(id, c.out.size() <= limits_.max_stream_backlog && send_output(c) != Transfer::kEnd);
  }
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

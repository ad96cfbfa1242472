// SPDX-License-Identifier: Apache-2.0
// Sends answers and events.
#include "moiregauge/server/http/server_loop.h"

#include <unistd.h>

#include <algorithm>

namespace moiregauge::internal {
namespace {

constexpr std::int64_t kBeat_ms = 15'000;  // between two comments in a stream, which find peers that vanished
constexpr std::int64_t kDrain_ms = 2'000;  // for a peer to read an answer before its request is complete

}  // namespace

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

void HttpServer::Loop::publish(const std::string& event) {
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

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// Receives requests and gives them to the workers.
#include "moiregauge/server/http/server_loop.h"

#include <unistd.h>

#include <algorithm>
#include <exception>

#include "moiregauge/server/http/request_head.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kPiece = 64 << 10;  // bytes of one read

Answer answer_or_error(HttpHandler& handler, const Request& request) {
  try {
    return handler.answer(request);
  } catch (const std::exception&) {
    return error_answer(500, "the request failed: the server: look at its terminal");
  }
}

}  // namespace

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

}  // namespace moiregauge::internal

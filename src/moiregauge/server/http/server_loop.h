// SPDX-License-Identifier: Apache-2.0
// The thread of the server that owns all connections.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "moiregauge/server/http/connection.h"
#include "moiregauge/server/http/http_server.h"
#include "moiregauge/server/http/worker_pool.h"

namespace moiregauge::internal {

class HttpServer::Loop {
 public:
  Loop(ListenSocket listening, std::unique_ptr<TlsContext> tls, const HttpLimits& limits);
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;
  ~Loop();
  [[nodiscard]] int port() const { return listening_.port; }
  void run(HttpHandler& handler, const std::function<bool()>& may_continue);
  void publish(const std::string& event);

 private:
  using Finished = std::pair<std::uint64_t, Answer>;

  // server_loop.cc: accepts connections, serves what is ready, and closes what is overdue.
  void wait_for_events();
  void accept_all();
  void add(int socket);
  void make_room();
  void settle(std::uint64_t id, bool is_open);
  void watch(Connection& c);
  void close_overdue();
  // Each bool function returns false if the connection has ended.
  [[nodiscard]] bool step(Connection& c, std::uint32_t events);

  // server_requests.cc: receives requests and gives them to the workers.
  [[nodiscard]] bool receive(Connection& c);
  [[nodiscard]] bool discard(Connection& c);
  [[nodiscard]] bool advance(Connection& c);
  [[nodiscard]] bool begin_body(Connection& c, std::size_t length_of_head);
  [[nodiscard]] bool submit(Connection& c);
  void release_body(Connection& c);

  // server_answers.cc: sends answers and events.
  void collect_answers();
  [[nodiscard]] bool begin_answer(Connection& c, Answer answer);
  [[nodiscard]] bool refuse(Connection& c, Answer answer);
  [[nodiscard]] bool send(Connection& c);
  [[nodiscard]] bool begin_stream(Connection& c, const Answer& answer);
  [[nodiscard]] std::size_t streams() const;
  void send_events();

  ListenSocket listening_;
  std::unique_ptr<TlsContext> tls_;
  const HttpLimits limits_;
  int epoll_ = -1;
  int wake_ = -1;  // eventfd
  HttpHandler* handler_ = nullptr;
  WorkerPool* workers_ = nullptr;
  std::unordered_map<std::uint64_t, std::unique_ptr<Connection>> connections_;
  std::uint64_t next_id_;
  std::int64_t bodies_ = 0;  // bytes reserved for bodies
  std::int64_t swept_ms_ = 0, beat_ms_ = 0;
  std::mutex mutex_;  // protects the two below
  std::vector<Finished> finished_;
  std::string events_;
};

}  // namespace moiregauge::internal

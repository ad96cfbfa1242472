// SPDX-License-Identifier: Apache-2.0
// HTTP/1.1 server. One thread owns all connections (epoll), so idle and slow clients cost memory but no thread. Answers
// are made by a few workers.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/server/http/listen_socket.h"
#include "moiregauge/server/http/request.h"
#include "moiregauge/server/http/tls_context.h"

namespace moiregauge::internal {

struct HttpLimits {
  std::size_t max_connections = 1500;        // beyond it, the connection that was idle longest is closed
  std::size_t max_streams = 16;              // event streams
  std::int64_t max_bodies = 64 << 20;        // bytes of all bodies together that are being received
  std::size_t max_stream_backlog = 4 << 20;  // bytes that a stream may lag behind before it is closed
  int workers = 6;                           // threads that make answers
  std::size_t max_waiting = 256;             // requests that wait for a worker
  std::int64_t head_ms = 10'000;             // from the first byte of a head to its end
  std::int64_t idle_ms = 60'000;             // an open connection between requests
  std::int64_t body_ms = 15'000;             // for a body, in addition to its length by the slowest rate
  std::int64_t slowest_bytes_per_ms = 64;    // rate of a body
  std::int64_t write_ms = 20'000;            // without progress
};

class HttpHandler {
 public:
  virtual ~HttpHandler() = default;
  // Refuses a request before its body is read. Called on the server's thread, so it must be fast.
  [[nodiscard]] virtual std::optional<Answer> refuse(const RequestHead& head) const = 0;
  // Returns the largest body of a request, bytes.
  [[nodiscard]] virtual std::int64_t max_body(const RequestHead& head) const = 0;
  // Answers a request. Called on a worker's thread.
  [[nodiscard]] virtual Answer answer(const Request& request) = 0;
  // Returns the first events of a new stream. Called on the server's thread. Every later published event follows.
  [[nodiscard]] virtual std::string first_events() const = 0;
};

class HttpServer {
 public:
  // `tls` may be null. Fails with the reason.
  [[nodiscard]] static tl::expected<std::unique_ptr<HttpServer>, std::string> open(const ListenAddress& address,
                                                                                   std::unique_ptr<TlsContext> tls,
                                                                                   const HttpLimits& limits = {});
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();
  [[nodiscard]] int port() const;
  // Serves until `may_continue` returns false. It is called at least every 100 ms.
  void run(HttpHandler& handler, const std::function<bool()>& may_continue);
  // Sends an event to every stream. Called on any thread; it never waits.
  void publish(const std::string& event);

 private:
  class Loop;
  explicit HttpServer(std::unique_ptr<Loop> loop);
  std::unique_ptr<Loop> loop_;
};

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/http_server.h"

#include <utility>

#include "moiregauge/server/http/server_loop.h"

namespace moiregauge::internal {

tl::expected<std::unique_ptr<HttpServer>, std::string> HttpServer::open(const ListenAddress& address,
                                                                        std::unique_ptr<TlsContext> tls,
                                                                        const HttpLimits& limits) {
  const auto listening = open_listen_socket(address);
  if (!listening) return tl::unexpected(listening.error());
  return std::unique_ptr<HttpServer>(new HttpServer(std::make_unique<Loop>(*listening, std::move(tls), limits)));
}

HttpServer::HttpServer(std::unique_ptr<Loop> loop) : loop_(std::move(loop)) {}
HttpServer::~HttpServer() = default;
int HttpServer::port() const { return loop_->port(); }
void HttpServer::run(HttpHandler& handler, const std::function<bool()>& may_continue) {
  loop_->run(handler, may_continue);
}
void HttpServer::publish(const std::string& event) { loop_->publish(event); }

}  // namespace moiregauge::internal

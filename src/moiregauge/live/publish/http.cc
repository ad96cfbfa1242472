// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/http.h"

#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <httplib.h>

namespace moiregauge::internal {
namespace {

constexpr int kTimeout_s = 5, kPostTimeout_s = 10;
constexpr std::size_t kMaxRequest = 1024, kThreads = 4;

// Returns true if the header names this host, with any port. A web page that resolves its own name to this host sends
// that name.
bool is_own_host(const std::string& header) {
  const std::size_t bracket = header.starts_with('[') ? header.find(']') : std::string::npos;
  const std::size_t colon = header.find(':', bracket == std::string::npos ? 0 : bracket);
  std::string host = header.substr(0, colon);
  if (bracket != std::string::npos) host = header.substr(1, bracket - 1);
  return is_loopback(host);
}

class Server final : public PageServer {
 public:
  explicit Server(std::function<std::string()> page) : page_(std::move(page)) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    // The default would let a second program share the port.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server_.set_payload_max_length(kMaxRequest);
    server_.set_read_timeout(kTimeout_s, 0);
    server_.set_write_timeout(kTimeout_s, 0);
    server_.set_keep_alive_max_count(5);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server() override {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] bool bind(const std::string& host, int port, const std::string& path) {
    server_.Get(path, [this](const httplib::Request& request, httplib::Response& response) {
      if (!is_own_host(request.get_header_value("Host"))) {
        response.status = 403;
        return;
      }
      response.set_header("X-Content-Type-Options", "nosniff");
      response.set_content(page_(), "text/plain; version=0.0.4; charset=utf-8");
    });
    port_ = port == 0 ? server_.bind_to_any_port(host) : server_.bind_to_port(host, port) ? port : -1;
    if (port_ <= 0) return false;
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    // stop() has no effect before the server runs.
    while (!server_.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return true;
  }
  [[nodiscard]] int port() const override { return port_; }

 private:
  std::function<std::string()> page_;
  httplib::Server server_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace

tl::expected<std::unique_ptr<PageServer>, std::string> serve_page(const std::string& host, int port,
                                                                  const std::string& path,
                                                                  std::function<std::string()> page) {
  auto server = std::make_unique<Server>(std::move(page));
  if (!server->bind(host, port, path))
    return tl::unexpected(fmt::format("the port {} of {} cannot be used", port, host));
  return std::unique_ptr<PageServer>(std::move(server));
}

int post_text(const OutletUrl& url, const std::string& token, const std::string& body) {
  const bool is_secure = url.scheme == "https";
  const std::string host = url.host.find(':') == std::string::npos ? url.host : "[" + url.host + "]";
  const std::string server = fmt::format("{}://{}:{}", url.scheme, host,
                                         url.port > 0 ? url.port
                                         : is_secure  ? 443
                                                      : 80);
  httplib::Client client(server);
  client.set_connection_timeout(kPostTimeout_s, 0);
  client.set_read_timeout(kPostTimeout_s, 0);
  client.set_write_timeout(kPostTimeout_s, 0);
  httplib::Headers headers;
  if (!token.empty()) headers.emplace("Authorization", "Token " + token);
  const auto answer = client.Post(url.path.empty() ? "/" : url.path, headers, body, "text/plain; charset=utf-8");
  return answer ? answer->status : 0;
}

}  // namespace moiregauge::internal

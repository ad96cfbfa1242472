// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/web_server.h"

#include <utility>

#include <fmt/format.h>

#include "moiregauge/server/answers/routes.h"
#include "moiregauge/server/api/access.h"
#include "moiregauge/server/api/tickets.h"
#include "moiregauge/server/http/http_server.h"

namespace moiregauge::internal {
namespace {

tl::unexpected<ServeFailure> serve_failure(ServeProblem problem, std::string message) {
  return tl::unexpected(ServeFailure{problem, std::move(message)});
}

class FolderServer final : public WebServer, private HttpHandler {
 public:
  FolderServer(ConfinedFolder folder, std::unique_ptr<HttpServer> server, const ServeOptions& options,
               AccessRules rules)
      : rules_(std::move(rules)),
        server_(std::move(server)),
        options_(options),
        state_(
            std::move(folder), [this](const std::string& event) { server_->publish(event); }, options.jobs_at_once) {
    state_.token = rules_.token;
    state_.is_token_in_page = !options.is_beyond_loopback;
    state_.max_upload = options.max_upload;
  }

  [[nodiscard]] std::string url() const override {
    const bool is_six = options_.address.host.find(':') != std::string::npos;
    const std::string host = is_six ? "[" + options_.address.host + "]" : options_.address.host;
    return fmt::format("{}://{}:{}/{}", rules_.scheme, host, rules_.port,
                       options_.is_beyond_loopback ? "#token=" + rules_.token : "");
  }

  void run(const std::function<bool()>& may_continue) override { server_->run(*this, may_continue); }

 private:
  [[nodiscard]] std::optional<Answer> refuse(const RequestHead& head) const override {
    if (auto refusal = access_refusal(rules_, head)) return refusal;
    bool is_other_method = false;
    const Route* route = find_route(head.method, head.path, is_other_method);
    if (route == nullptr && is_other_method)
      return error_answer(405, "the address has another method: the request: use GET to read, POST to change");
    if (route == nullptr) return error_answer(404, "the address does not exist: the request: see docs/cli/serve.md");
    const std::string_view type = head.header("content-type");
    if (route->has_json_body && type.substr(0, type.find(';')) != "application/json")
      return error_answer(415, "the body is not declared as JSON: the request: send Content-Type application/json");
    return std::nullopt;
  }

  [[nodiscard]] std::int64_t max_body(const RequestHead& head) const override {
    bool ignored = false;
    const Route* route = find_route(head.method, head.path, ignored);
    return route == nullptr ? 0 : route->max_body;
  }

  [[nodiscard]] Answer answer(const Request& request) override {
    bool ignored = false;
    return find_route(request.head.method, request.head.path, ignored)->answer(state_, request);
  }

  [[nodiscard]] std::string first_events() const override {
    return event_text("hello", "{}") + state_.queue.present_events();
  }

  AccessRules rules_;
  std::unique_ptr<HttpServer> server_;
  ServeOptions options_;
  ServerState state_;  // last: its commands publish through the server until they have ended
};

}  // namespace

tl::expected<std::unique_ptr<WebServer>, ServeFailure> WebServer::open(const ServeOptions& options) {
  auto folder = ConfinedFolder::open(options.folder);
  if (!folder)
    return serve_failure(
        ServeProblem::kUsage,
        fmt::format("the folder cannot be opened ({}): {}: give a folder with clips", folder.error(), options.folder));
  AccessRules rules;
  rules.token = options.token.empty() ? random_digits(32) : options.token;
  std::unique_ptr<TlsContext> tls;
  if (options.is_beyond_loopback) {
    auto context = TlsContext::from_files(options.certificate, options.key);
    if (!context) return serve_failure(ServeProblem::kUsage, context.error());
    tls = *std::move(context);
    rules.scheme = "https";
    rules.is_issued_for = [certificate = tls.get()](const std::string& host) {
      return certificate->is_issued_for(host);
    };
  }
  auto server = HttpServer::open(options.address, std::move(tls));
  if (!server)
    return serve_failure(ServeProblem::kPort,
                         fmt::format("the port cannot be used ({}): {} of {}: choose another with --port",
                                     server.error(), options.address.port, options.address.host));
  rules.port = (*server)->port();
  return std::make_unique<FolderServer>(*std::move(folder), *std::move(server), options, std::move(rules));
}

}  // namespace moiregauge::internal

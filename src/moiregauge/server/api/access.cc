// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/access.h"

#include <fmt/format.h>

#include "moiregauge/server/http/listen_socket.h"

namespace moiregauge::internal {
namespace {

struct HostName {
  std::string name;  // without brackets
  std::string port;
};

std::optional<HostName> host_name(std::string_view host) {
  if (host.starts_with('[')) {
    const auto bracket = host.find(']');
    if (bracket == std::string_view::npos) return std::nullopt;
    const std::string_view rest = host.substr(bracket + 1);
    if (!rest.empty() && rest.front() != ':') return std::nullopt;
    return HostName{std::string(host.substr(1, bracket - 1)), std::string(rest.empty() ? rest : rest.substr(1))};
  }
  const auto colon = host.find(':');
  if (colon == std::string_view::npos) return HostName{std::string(host), ""};
  return HostName{std::string(host.substr(0, colon)), std::string(host.substr(colon + 1))};
}

bool is_own_host_name(const AccessRules& rules, std::string_view header) {
  const auto host = host_name(header);
  if (!host) return false;
  const std::string usual_port = rules.scheme == "https" ? "443" : "80";
  if ((host->port.empty() ? usual_port : host->port) != std::to_string(rules.port)) return false;
  if (host->name == "localhost" || is_loopback_number(host->name)) return true;
  // A number cannot be made to point elsewhere, as a name can.
  return rules.is_issued_for && (is_ip_number(host->name) || rules.is_issued_for(host->name));
}

Answer forbidden(const char* what) {
  return error_answer(403, fmt::format("{}: the request: open the printed address", what));
}

}  // namespace

bool is_same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

std::optional<Answer> access_refusal(const AccessRules& rules, const RequestHead& head) {
  if (!is_own_host_name(rules, head.header("host"))) return forbidden("the host is not this server");
  const std::string_view origin = head.header("origin");
  if (!origin.empty() && origin != fmt::format("{}://{}", rules.scheme, head.header("host")))
    return forbidden("another page sent it");
  if (!head.path.starts_with("/api")) return std::nullopt;
  const std::string_view site = head.header("sec-fetch-site");
  if (!site.empty() && site != "same-origin" && site != "none") return forbidden("another page sent it");
  if (!is_same_secret(head.header("x-moiregauge-token"), rules.token))
    return forbidden("the token is missing or wrong");
  return std::nullopt;
}

}  // namespace moiregauge::internal

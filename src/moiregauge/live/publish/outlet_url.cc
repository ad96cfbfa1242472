// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/outlet_url.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

tl::unexpected<std::string> url_mistake(const std::string& what, const std::string& remedy) {
  return tl::unexpected(fmt::format("{}: {}", what, remedy));
}

constexpr const char* kForm = "write it like mqtt://HOST:PORT/TOPIC";

}  // namespace

tl::expected<OutletUrl, std::string> parse_outlet_url(std::string_view text) {
  const bool is_printable =
      std::all_of(text.begin(), text.end(), [](unsigned char c) { return c > 0x20 && c != 0x7f; });
  if (!is_printable) return url_mistake("the address contains a space or a control character", kForm);
  const std::size_t colon = text.find("://");
  if (colon == std::string_view::npos || colon == 0) return url_mistake("the address has no scheme", kForm);
  OutletUrl url;
  url.scheme = text.substr(0, colon);
  text.remove_prefix(colon + 3);
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos) url.path = text.substr(slash);
  std::string_view server = text.substr(0, slash);
  if (const std::size_t at = server.rfind('@'); at != std::string_view::npos) {
    if (server.substr(0, at).find(':') != std::string_view::npos)
      return url_mistake("the address contains a password, which other users can read in the list of processes",
                         "set the environment variable MOIREGAUGE_PASSWORD instead");
    url.user = server.substr(0, at);
    server.remove_prefix(at + 1);
  }
  const std::size_t bracket = server.starts_with('[') ? server.find(']') : std::string_view::npos;
  const std::size_t port_colon = server.find(':', bracket == std::string_view::npos ? 0 : bracket);
  const std::string_view host = server.substr(0, port_colon);
  url.host = bracket == std::string_view::npos ? host : host.substr(1, bracket - 1);
  if (url.host.empty()) return url_mistake("the address has no host", kForm);
  if (port_colon != std::string_view::npos) {
    const std::string_view port = server.substr(port_colon + 1);
    const auto [end, problem] = std::from_chars(port.data(), port.data() + port.size(), url.port);
    if (problem != std::errc() || end != port.data() + port.size() || url.port < 1 || url.port > 65535)
      return url_mistake(fmt::format("'{}' is no port", port), "give a port from 1 to 65535");
  }
  return url;
}

bool is_loopback(std::string_view host) { return host == "localhost" || host == "::1" || host.starts_with("127."); }

}  // namespace moiregauge::internal

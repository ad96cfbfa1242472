// SPDX-License-Identifier: Apache-2.0
// Reads the addresses of outlets, such as "mqtt://user@broker:1883/bridge/span2".
#pragma once

#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace moiregauge::internal {

struct OutletUrl {
  std::string scheme;
  std::string user;  // empty: none
  std::string host;  // without the brackets of an IPv6 address
  int port = 0;      // 0: not stated
  std::string path;  // from the first slash on, with the query; empty: none
};

// Reads "SCHEME://[USER@]HOST[:PORT][/PATH]".
// Fails with "what happened: what to do": no host, a wrong port, control characters, a password. A password would be
// visible in the list of processes, so it belongs in the environment.
[[nodiscard]] tl::expected<OutletUrl, std::string> parse_outlet_url(std::string_view text);

// Returns true for localhost and the addresses of the loopback interface.
[[nodiscard]] bool is_loopback(std::string_view host);

}  // namespace moiregauge::internal

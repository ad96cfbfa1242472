// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Numeric address and port. Port 0: any free one.
struct ListenAddress {
  std::string host = "127.0.0.1";
  int port = 0;
};

struct ListenSocket {
  int socket = -1;
  int port = 0;  // the one in use
};

// Reads "192.168.1.5:8443" or "[::1]:8443". Fails with what to write instead.
[[nodiscard]] tl::expected<ListenAddress, std::string> listen_address(const std::string& text);

// Returns true for 127.0.0.0/8 and ::1, as numbers.
[[nodiscard]] bool is_loopback_number(const std::string& host);
// Returns true for an IPv4 or IPv6 address in digits, without brackets.
[[nodiscard]] bool is_ip_number(const std::string& host);

// Opens a socket that listens and does not block. Fails with the system's reason.
[[nodiscard]] tl::expected<ListenSocket, std::string> open_listen_socket(const ListenAddress& address);

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/listen_socket.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <memory>
#include <system_error>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr int kBacklog = 1024;

using AddressList = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

AddressList numeric_address(const ListenAddress& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(address.port);
  if (getaddrinfo(address.host.c_str(), port.c_str(), &hints, &found) != 0) found = nullptr;
  return {found, freeaddrinfo};
}

tl::unexpected<std::string> socket_failure(int socket) {
  const std::string reason = std::generic_category().message(errno);
  if (socket >= 0) ::close(socket);
  return tl::unexpected(reason);
}

int port_of(int socket) {
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  getsockname(socket, reinterpret_cast<sockaddr*>(&own), &size);
  return own.ss_family == AF_INET6 ? ntohs(reinterpret_cast<const sockaddr_in6*>(&own)->sin6_port)
                                   : ntohs(reinterpret_cast<const sockaddr_in*>(&own)->sin_port);
}

}  // namespace

tl::expected<ListenAddress, std::string> listen_address(const std::string& text) {
  ListenAddress out;
  const std::size_t colon = text.rfind(':');
  const bool is_bracketed = text.starts_with('[') && colon != std::string::npos && colon > 1 && text[colon - 1] == ']';
  out.host = is_bracketed ? text.substr(1, colon - 2) : text.substr(0, colon);
  const std::string digits = colon == std::string::npos ? "" : text.substr(colon + 1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), out.port);
  const bool is_port =
      error == std::errc{} && end == digits.data() + digits.size() && out.port >= 0 && out.port < 65536;
  if (!is_port || !is_ip_number(out.host) || (!is_bracketed && out.host.find(':') != std::string::npos))
    return tl::unexpected(std::string("write ADDRESS:PORT in digits, e.g. 192.168.1.5:8443 or [fd00::5]:8443"));
  return out;
}

bool is_ip_number(const std::string& host) {
  in6_addr bytes{};
  return inet_pton(AF_INET, host.c_str(), &bytes) == 1 || inet_pton(AF_INET6, host.c_str(), &bytes) == 1;
}

bool is_loopback_number(const std::string& host) {
  in_addr four{};
  if (inet_pton(AF_INET, host.c_str(), &four) == 1) return (ntohl(four.s_addr) >> 24) == 127;
  in6_addr six{};
  return inet_pton(AF_INET6, host.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

tl::expected<ListenSocket, std::string> open_listen_socket(const ListenAddress& address) {
  const AddressList list = numeric_address(address);
  if (!list) return tl::unexpected(std::string("it is no address of this computer"));
  const int socket = ::socket(list->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return socket_failure(socket);
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (::bind(socket, list->ai_addr, list->ai_addrlen) != 0 || ::listen(socket, kBacklog) != 0)
    return socket_failure(socket);
  return ListenSocket{socket, port_of(socket)};
}

}  // namespace moiregauge::internal

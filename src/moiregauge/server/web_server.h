// SPDX-License-Identifier: Apache-2.0
// The web page of `moiregauge serve` and the addresses behind it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/server/http/listen_socket.h"

namespace moiregauge::internal {

struct ServeOptions {
  std::string folder = ".";
  ListenAddress address;
  bool is_beyond_loopback = false;                   // --listen: with TLS, and the token is not in the page
  std::string certificate, key;                      // PEM files of --listen
  std::string token;                                 // empty: a random one
  int jobs_at_once = 1;                              // commands that run at the same time
  std::int64_t max_upload = std::int64_t{64} << 30;  // bytes
};

enum class ServeProblem { kUsage, kPort };

struct ServeFailure {
  ServeProblem problem = ServeProblem::kUsage;
  std::string message;  // "what: where: what to do"
};

class WebServer {
 public:
  // Opens folder and port. Fails: no such folder, a certificate that cannot be read, a port in use.
  [[nodiscard]] static tl::expected<std::unique_ptr<WebServer>, ServeFailure> open(const ServeOptions& options);
  virtual ~WebServer() = default;
  // Returns the address for a browser. Beyond this computer it ends in the token.
  [[nodiscard]] virtual std::string url() const = 0;
  // Serves until `may_continue` returns false. It is called at least every 100 ms.
  virtual void run(const std::function<bool()>& may_continue) = 0;
};

}  // namespace moiregauge::internal

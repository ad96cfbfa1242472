// SPDX-License-Identifier: Apache-2.0
// HTTP for outlets. Only its source includes cpp-httplib, which compiles slowly.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/live/publish/outlet_url.h"

namespace moiregauge::internal {

// Serves one page on the loopback interface, read by Prometheus. Requests are limited to 1 kB and 5 s, and a foreign
// Host header is refused, because a web page could send it.
class PageServer {
 public:
  virtual ~PageServer() = default;  // stops the server
  [[nodiscard]] virtual int port() const = 0;
};

// `page` is called on the server's threads. Port 0 chooses a free one. Fails with the reason: the port is in use.
[[nodiscard]] tl::expected<std::unique_ptr<PageServer>, std::string> serve_page(const std::string& host, int port,
                                                                                const std::string& path,
                                                                                std::function<std::string()> page);

// Posts a text to an http or https address. Returns the status, or 0 if no server answered within 10 s.
// `token`: sent as "Authorization: Token ..."; empty: none.
[[nodiscard]] int post_text(const OutletUrl& url, const std::string& token, const std::string& body);

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// Certificate and key of a server that listens beyond this computer.
#pragma once

#include <memory>
#include <string>

#include <tl/expected.hpp>

struct ssl_ctx_st;
struct ssl_st;

namespace moiregauge::internal {

class TlsContext {
 public:
  // Reads PEM files. Fails with "what: where: what to do": a file cannot be read, or the key does not match.
  [[nodiscard]] static tl::expected<std::unique_ptr<TlsContext>, std::string> from_files(const std::string& certificate,
                                                                                         const std::string& key);
  // Returns a session on a connected socket, or null without memory. The caller frees it.
  [[nodiscard]] ssl_st* begin_session(int socket) const;
  // Returns true if the certificate is issued for this host name.
  [[nodiscard]] bool is_issued_for(const std::string& host) const;

 private:
  struct Free {
    void operator()(ssl_ctx_st* context) const;
  };
  explicit TlsContext(ssl_ctx_st* context) : context_(context) {}
  std::unique_ptr<ssl_ctx_st, Free> context_;
};

}  // namespace moiregauge::internal

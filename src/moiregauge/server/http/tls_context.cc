// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/tls_context.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

std::string tls_reason() {
  const char* reason = ERR_reason_error_string(ERR_peek_last_error());
  ERR_clear_error();
  return reason != nullptr ? reason : "unknown reason";
}

tl::unexpected<std::string> tls_failure(const std::string& what, const std::string& path) {
  return tl::unexpected(fmt::format("{} ({}): {}: give a file in PEM format", what, tls_reason(), path));
}

}  // namespace

void TlsContext::Free::operator()(ssl_ctx_st* context) const { SSL_CTX_free(context); }

tl::expected<std::unique_ptr<TlsContext>, std::string> TlsContext::from_files(const std::string& certificate,
                                                                              const std::string& key) {
  std::unique_ptr<TlsContext> made(new TlsContext(SSL_CTX_new(TLS_server_method())));
  SSL_CTX* context = made->context_.get();
  if (context == nullptr) return tl::unexpected(std::string("TLS cannot start: OpenSSL: check its installation"));
  SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
  SSL_CTX_set_options(context, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
  SSL_CTX_set_mode(context, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  // OpenSSL would otherwise request the passphrase of a key on the terminal.
  SSL_CTX_set_default_passwd_cb(context, [](char*, int, int, void*) { return 0; });
  if (SSL_CTX_use_certificate_chain_file(context, certificate.c_str()) != 1)
    return tls_failure("the certificate cannot be read", certificate);
  if (SSL_CTX_use_PrivateKey_file(context, key.c_str(), SSL_FILETYPE_PEM) != 1)
    return tls_failure("the key cannot be read, or is not that of the certificate", key);
  if (SSL_CTX_check_private_key(context) != 1) return tls_failure("the key is not that of the certificate", key);
  return made;
}

ssl_st* TlsContext::begin_session(int socket) const {
  SSL* session = SSL_new(context_.get());
  if (session == nullptr) return nullptr;
  SSL_set_fd(session, socket);
  SSL_set_accept_state(session);
  return session;
}

bool TlsContext::is_issued_for(const std::string& host) const {
  X509* certificate = SSL_CTX_get0_certificate(context_.get());
  return certificate != nullptr && X509_check_host(certificate, host.data(), host.size(), 0, nullptr) == 1;
}

}  // namespace moiregauge::internal

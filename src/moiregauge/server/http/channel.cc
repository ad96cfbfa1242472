// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/channel.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace moiregauge::internal {

ByteChannel::~ByteChannel() {
  if (session_ != nullptr) SSL_free(session_);
  ::close(socket_);
}

Transfer ByteChannel::tls_outcome(int result) {
  waits_for_write_ = false;
  if (result > 0) return Transfer::kProgress;
  const int error = SSL_get_error(session_, result);
  ERR_clear_error();
  waits_for_write_ = error == SSL_ERROR_WANT_WRITE;
  return error == SSL_ERROR_WANT_WRITE || error == SSL_ERROR_WANT_READ ? Transfer::kWait : Transfer::kEnd;
}

Transfer ByteChannel::shake_hands() {
  return session_ == nullptr ? Transfer::kProgress : tls_outcome(SSL_accept(session_));
}

Transfer ByteChannel::read(std::size_t most, std::string& out) {
  const std::size_t before = out.size();
  out.resize(before + most);
  ssize_t got = 0;
  Transfer outcome = Transfer::kProgress;
  if (session_ != nullptr) {
    got = SSL_read(session_, out.data() + before, static_cast<int>(most));
    outcome = tls_outcome(static_cast<int>(got));
  } else {
    got = ::recv(socket_, out.data() + before, most, 0);
    if (got <= 0) outcome = got < 0 && (errno == EAGAIN || errno == EINTR) ? Transfer::kWait : Transfer::kEnd;
  }
  out.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return outcome;
}

Transfer ByteChannel::write(std::string_view bytes, std::size_t& written) {
  written = 0;
  if (bytes.empty()) return Transfer::kProgress;
  if (session_ != nullptr) {
    const int put = SSL_write(session_, bytes.data(), static_cast<int>(std::min<std::size_t>(bytes.size(), 1 << 20)));
    if (put > 0) written = static_cast<std::size_t>(put);
    return tls_outcome(put);
  }
  const ssize_t put = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  waits_for_write_ = put < 0 && (errno == EAGAIN || errno == EINTR);
  if (put >= 0) written = static_cast<std::size_t>(put);
  return put >= 0 ? Transfer::kProgress : waits_for_write_ ? Transfer::kWait : Transfer::kEnd;
}

bool ByteChannel::has_pending() const { return session_ != nullptr && SSL_pending(session_) > 0; }

void ByteChannel::finish_writing() {
  if (session_ != nullptr) {
    SSL_shutdown(session_);
    ERR_clear_error();
  }
  ::shutdown(socket_, SHUT_WR);
}

}  // namespace moiregauge::internal

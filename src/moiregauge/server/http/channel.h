// SPDX-License-Identifier: Apache-2.0
// Bytes of one connection, with or without TLS. No call waits.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

struct ssl_st;

namespace moiregauge::internal {

enum class Transfer { kProgress, kWait, kEnd };

class ByteChannel {
 public:
  // Takes the socket and the session, which is null without TLS.
  ByteChannel(int socket, ssl_st* session) : socket_(socket), session_(session) {}
  ByteChannel(const ByteChannel&) = delete;
  ByteChannel& operator=(const ByteChannel&) = delete;
  ~ByteChannel();

  [[nodiscard]] int socket() const { return socket_; }
  [[nodiscard]] bool has_tls() const { return session_ != nullptr; }
  // Continues the TLS handshake. kProgress: it is complete.
  [[nodiscard]] Transfer shake_hands();
  // Appends up to `most` bytes. kEnd: the peer has closed, or an error.
  [[nodiscard]] Transfer read(std::size_t most, std::string& out);
  // Writes from the start of `bytes`, and gives the number written.
  [[nodiscard]] Transfer write(std::string_view bytes, std::size_t& written);
  // Returns true if the next step needs the socket to be writable.
  [[nodiscard]] bool waits_for_write() const { return waits_for_write_; }
  // Returns true if decrypted bytes are ready, of which the socket shows nothing.
  [[nodiscard]] bool has_pending() const;
  // States the end of the answer. The peer can still send.
  void finish_writing();

 private:
  [[nodiscard]] Transfer tls_outcome(int result);
  int socket_;
  ssl_st* session_;
  bool waits_for_write_ = false;
};

}  // namespace moiregauge::internal

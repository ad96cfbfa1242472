// SPDX-License-Identifier: Apache-2.0
// One connection of the server and what it is waiting for.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "moiregauge/server/http/channel.h"
#include "moiregauge/server/http/request.h"

namespace moiregauge::internal {

enum class ConnectionState {
  kHandshake,
  kHead,       // receives a head, or is idle
  kBody,       // receives a body
  kWorking,    // a worker makes the answer
  kWriting,    // sends an answer
  kStreaming,  // sends events until the peer closes
  kDraining,   // has sent its last answer and discards what still comes
};

// Returns the time on the clock of Connection::deadline_ms.
[[nodiscard]] inline std::int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
inline constexpr std::int64_t kNever_ms = std::numeric_limits<std::int64_t>::max();

struct Connection {
  Connection(std::unique_ptr<ByteChannel> bytes, std::uint64_t number) : channel(std::move(bytes)), id(number) {}
  std::unique_ptr<ByteChannel> channel;
  std::uint64_t id;
  ConnectionState state = ConnectionState::kHandshake;
  std::string in, out;   // bytes received and to be sent
  std::size_t sent = 0;  // bytes of `out`
  RequestHead head;
  std::int64_t reserved_bytes = 0;  // share of the limit on bodies
  std::shared_ptr<AnswerFile> file;
  std::int64_t file_offset = 0;
  bool stays_open = true;
  std::int64_t deadline_ms = 0;
  std::uint32_t watched = 0;  // events registered with epoll

  [[nodiscard]] bool is_idle() const { return state == ConnectionState::kHead && in.empty(); }
  // Returns true if only its peer keeps it open.
  [[nodiscard]] bool can_be_dropped() const {
    return state == ConnectionState::kHandshake || state == ConnectionState::kHead ||
           state == ConnectionState::kDraining;
  }
  [[nodiscard]] bool has_output() const { return sent < out.size() || (file && file_offset < file->size()); }
};

// Sends what it can. kProgress: everything is sent.
[[nodiscard]] Transfer send_output(Connection& c);

}  // namespace moiregauge::internal

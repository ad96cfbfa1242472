// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace moiregauge::internal {

// Returns hexadecimal digits from the system's random source.
[[nodiscard]] std::string random_digits(int bytes);

// Addresses of files that a browser may open for ten minutes without the token's header, because it opens a tab without
// headers. None can be guessed.
class Tickets {
 public:
  [[nodiscard]] std::string add(std::string path);
  [[nodiscard]] std::optional<std::string> path_of(std::string_view ticket) const;

 private:
  struct Ticket {
    std::string digits, path;
    std::chrono::steady_clock::time_point end;
  };
  mutable std::mutex mutex_;
  std::deque<Ticket> tickets_;  // oldest first
};

}  // namespace moiregauge::internal

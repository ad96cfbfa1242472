// SPDX-License-Identifier: Apache-2.0
// SHA-256 of bytes that arrive in pieces: the fingerprint of an input (run.json).
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace moiregauge::internal {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;
  void add(std::span<const std::byte> bytes);
  // 64 lower-case hexadecimal digits. Ends the sum; call once.
  [[nodiscard]] std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace moiregauge::internal

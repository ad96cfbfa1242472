// SPDX-License-Identifier: Apache-2.0
// Computes SHA-256 of bytes that arrive in pieces. run.json holds it as the fingerprint of the input.
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
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;
  void add(std::span<const std::byte> bytes);
  // Returns 64 lower-case hexadecimal digits and ends the sum. Call it once.
  [[nodiscard]] std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace moiregauge::internal

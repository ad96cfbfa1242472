// SPDX-License-Identifier: Apache-2.0
// SHA-256 of an INPUT's bytes: what tells one recording from another. A pass over all bytes takes longer than measuring
// a file that is not compressed, so it runs beside the measuring.
#pragma once

#include <string>
#include <thread>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

class Fingerprint {
 public:
  // Starts at once, unless options.threads is 1: then hex() does it.
  Fingerprint(std::string path, const InputOptions& options);
  Fingerprint(const Fingerprint&) = delete;
  Fingerprint& operator=(const Fingerprint&) = delete;
  ~Fingerprint() = default;  // stops where it is
  // Waits for it. 64 lower-case hexadecimal digits; empty where the input cannot be read.
  [[nodiscard]] const std::string& hex();

 private:
  void take(const std::stop_token& stop);
  std::string path_;
  InputOptions options_;
  std::string hex_;
  bool taken_ = false;
  std::jthread thread_;
};

}  // namespace moiregauge::internal

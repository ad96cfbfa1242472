// SPDX-License-Identifier: Apache-2.0
// SHA-256 of an INPUT's bytes, which identifies a recording. Reading all bytes takes longer than measuring an
// uncompressed file, so it runs in a thread during the measurement.
#pragma once

#include <string>
#include <thread>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

class Fingerprint {
 public:
  // Starts the thread, unless options.threads is 1. Then hex() reads the bytes.
  Fingerprint(std::string path, const InputOptions& options);
  Fingerprint(const Fingerprint&) = delete;
  Fingerprint& operator=(const Fingerprint&) = delete;
  ~Fingerprint() = default;  // stops the thread at once
  // Returns 64 lower-case hexadecimal digits, after waiting for the thread. Empty: the input is unreadable.
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

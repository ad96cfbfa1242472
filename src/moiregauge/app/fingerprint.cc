// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/fingerprint.h"

#include <system_error>
#include <utility>

#include "moiregauge/base/file_hash.h"
#include "moiregauge/io/pictures/picture_source.h"

namespace moiregauge::internal {

Fingerprint::Fingerprint(std::string path, const InputOptions& options) : path_(std::move(path)), options_(options) {
  if (options.threads == 1) return;
  try {
    thread_ = std::jthread([this](const std::stop_token& stop) { take(stop); });
  } catch (const std::system_error&) {  // no thread can start: hex() reads the bytes
  }
}

void Fingerprint::take(const std::stop_token& stop) {
  const auto files = files_of_input(path_, options_);
  if (files) hex_ = sha256_of_files(*files, [&stop] { return !stop.stop_requested(); });
}

const std::string& Fingerprint::hex() {
  if (!std::exchange(taken_, true)) {
    if (thread_.joinable())
      thread_.join();
    else
      take({});
  }
  return hex_;
}

}  // namespace moiregauge::internal

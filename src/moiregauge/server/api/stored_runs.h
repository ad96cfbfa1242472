// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/io/journal/run_file.h"

namespace moiregauge::internal {

// Keeps the observations of the run that was read last, because a page shows many frames of one run.
class StoredRuns {
 public:
  // Returns the run of a run.mgj by its absolute path. Safe on any thread.
  [[nodiscard]] tl::expected<std::shared_ptr<const KeptRun>, std::string> read(const std::string& path);

 private:
  std::mutex mutex_;
  std::string key_;  // path and version of the file
  std::shared_ptr<const KeptRun> run_;
};

}  // namespace moiregauge::internal

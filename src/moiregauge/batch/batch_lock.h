// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/base/output_error.h"
#include "moiregauge/batch/clip.h"

namespace moiregauge::internal {

// Makes one process at a time the owner of OUT: of its list of clips, table, catalogue and page. Slurm tasks need no
// lock, because they write only into the runs of their own clips.
class BatchLock {
 public:
  // Creates OUT if needed. Fails (usage) if another process owns it, or if it holds something else than a batch. Fails
  // (not usage) if it cannot be written.
  [[nodiscard]] static tl::expected<BatchLock, OutputError> take(const BatchFolder& folder);
  BatchLock(const BatchLock&) = delete;
  BatchLock& operator=(const BatchLock&) = delete;
  BatchLock(BatchLock&& other) noexcept : file_(other.file_) { other.file_ = -1; }
  BatchLock& operator=(BatchLock&&) = delete;
  ~BatchLock();

 private:
  explicit BatchLock(int file) : file_(file) {}
  int file_;
};

}  // namespace moiregauge::internal

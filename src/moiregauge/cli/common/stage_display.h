// SPDX-License-Identifier: Apache-2.0
// The progress of a run on stderr, and Ctrl-C as the means to stop it.
#pragma once

#include <optional>

#include "moiregauge/app/run_progress.h"
#include "moiregauge/cli/common/progress.h"

namespace moiregauge::internal::cli {

class StageDisplay {
 public:
  explicit StageDisplay(bool quiet);
  // Refers to this display, which must outlive the run.
  [[nodiscard]] const RunCallbacks& callbacks() const { return callbacks_; }
  StageDisplay(const StageDisplay&) = delete;
  StageDisplay& operator=(const StageDisplay&) = delete;
  ~StageDisplay() = default;

 private:
  void show(const RunProgress& progress);
  void clear();
  void print(const std::string& note);

  bool quiet_;
  RunCallbacks callbacks_;
  std::optional<Stage> stage_;
  std::optional<Progress> frames_;
  std::optional<ElapsedLine> elapsed_;
};

}  // namespace moiregauge::internal::cli

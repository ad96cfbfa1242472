// SPDX-License-Identifier: Apache-2.0
// Interface for the results of a run. `io` implements it (run directory).
#pragma once

#include <tl/expected.hpp>

#include "moiregauge/base/output_error.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

class ResultSink {
 public:
  virtual ~ResultSink() = default;
  // Writes all files or none.
  [[nodiscard]] virtual tl::expected<void, OutputError> write(const Measurement& measurement,
                                                              const MeasureOptions& options) = 0;
};

}  // namespace moiregauge::internal

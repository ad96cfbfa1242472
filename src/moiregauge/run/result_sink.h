// SPDX-License-Identifier: Apache-2.0
// The door through which results go out. Implemented by io (a run directory).
#pragma once

#include <tl/expected.hpp>

#include "moiregauge/base/output_error.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

class ResultSink {
 public:
  virtual ~ResultSink() = default;
  // All or nothing.
  [[nodiscard]] virtual tl::expected<void, OutputError> write(const Measurement& measurement,
                                                              const MeasureOptions& options) = 0;
};

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// The door through which results go out. Implemented by io (a run directory).
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/run/measure.h"

namespace moiregauge {

struct OutputError {
  bool usage = false;    // the place is somebody else's: exit 2, not 6
  std::string message;   // "what: where: what to do"
};

class ResultSink {
 public:
  virtual ~ResultSink() = default;
  // All or nothing.
  [[nodiscard]] virtual tl::expected<void, OutputError> write(const Measurement& measurement,
                                                              const MeasureOptions& options) = 0;
};

}  // namespace moiregauge

// SPDX-License-Identifier: Apache-2.0
// Table of derived channels: one row per frame, or per time after resampling.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {

struct DerivedColumn {
  std::string name, unit, expression;
  std::vector<double> value, u;  // in `unit`; NaN if there is none
  std::vector<Status> status;
};

struct DerivedTable {
  std::vector<long> frame;  // empty: the rows are even times, not frames
  std::vector<double> time_s;
  std::vector<DerivedColumn> columns;
};

}  // namespace moiregauge::internal

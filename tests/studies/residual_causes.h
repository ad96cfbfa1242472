// SPDX-License-Identifier: Apache-2.0
// Causes of the published method's residuals: one cause at a time, on exact points.
#pragma once

#include <span>

namespace moiregauge::internal::test {

struct PaperCase {
  const char* scenario;
  const char* paper;
  long reference_frame;
};

// Prints a Markdown section with the largest error of dy per cause and case, over the run.
void print_residual_causes(std::span<const PaperCase> cases);

}  // namespace moiregauge::internal::test

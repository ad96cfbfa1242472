// SPDX-License-Identifier: Apache-2.0
// What the published method's residuals are made of: one cause at a time, on exact points.
#pragma once

#include <span>

namespace moiregauge::internal::test {

struct PaperCase {
  const char* scenario;
  const char* paper;
  long reference_frame;
};

// Prints a Markdown section: the largest error of dy over each case's run for every cause.
void print_residual_causes(std::span<const PaperCase> cases);

}  // namespace moiregauge::internal::test

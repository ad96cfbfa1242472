// SPDX-License-Identifier: Apache-2.0
// A layout of references, one of which makes a step, measured by `precise`. The input is images, or points with the
// noise of images, which takes a hundredth of the time.
#pragma once

#include <optional>
#include <string>

#include "common/simulated_run.h"

namespace moiregauge::internal::study {

enum class Layout { kRows, kScattered };  // two rows; random positions without overlap
enum class Footage { kPictures, kPoints };

struct SlipKind {
  int references = 6;
  Layout layout = Layout::kRows;
  bool lens_known = false;
  double slip_px = 0.2;  // px, size of the step
  Footage footage = Footage::kPoints;
};

struct Slip {
  simulator::Scenario scenario;
  test::RunPlan plan;
  std::string who;  // name of the reference with the step
  long when = 0;    // first frame after the step
};

// Returns draw `number` of positions, camera motion, reference, frame and direction of the step.
[[nodiscard]] Slip drawn_slip(const SlipKind& kind, int number);

// Returns samples and notes. Empty if the reference frame is refused.
[[nodiscard]] std::optional<Solution> measured(const Slip& slip, Footage footage);

}  // namespace moiregauge::internal::study

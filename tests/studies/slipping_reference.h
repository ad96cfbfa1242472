// SPDX-License-Identifier: Apache-2.0
// A layout of references of which one slips, measured by `precise`: from pictures, or from points with the noise of
// pictures, which costs a hundredth.
#pragma once

#include <optional>
#include <string>

#include "common/simulated_run.h"

namespace moiregauge::internal::study {

enum class Layout { kRows, kStrewn };  // two rows; anywhere, beside one another
enum class Footage { kPictures, kPoints };

struct SlipKind {
  int references = 6;
  Layout layout = Layout::kRows;
  bool lens_known = false;
  double slip_px = 0.2;
  Footage footage = Footage::kPoints;
};

struct Slip {
  simulator::Scenario scenario;
  test::RunPlan plan;
  std::string who;  // slips
  long when = 0;    // first frame after it
};

// Draw `number`: places, camera motion, who slips, when and whereto.
[[nodiscard]] Slip drawn_slip(const SlipKind& kind, int number);

// Samples and notes; nothing if the reference frame was refused.
[[nodiscard]] std::optional<Solution> measured(const Slip& slip, Footage footage);

}  // namespace moiregauge::internal::study

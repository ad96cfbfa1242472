// SPDX-License-Identifier: Apache-2.0
// One frame's observation in few bytes: 1.5 kB for five markers, where the struct takes 17 kB.
//
// Positions in the picture (maps, circle centres) and travel stay doubles: a float at 4000 px is off by 1e-4 px, a tenth
// of u. All else is single precision, relative 6e-8. Phases (wrapped) are off by 1.2e-7 rad then, 0.2 nm of a pitch of
// 10 mm. The readings of a print's points are kept as differences from the template's grid, 0.01 pitches at most for a
// print that was followed: off by 5e-10 pitches. u of a print is 5e-5 pitches at best.
//
// Nothing is kept that follows from the rest: the nine points are where the window's map has them, and their information
// matrix is the reference frame's times a factor (decision 0020).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

class ObservationPacking {
 public:
  ObservationPacking() = default;  // no reference frame yet: points of prints are kept in full
  explicit ObservationPacking(const Reference& reference);

  // Returns the observation's bytes. A second round of packing and unpacking changes no value.
  [[nodiscard]] std::string packed(const Observation& seen) const;
  // Returns the observation of such bytes. Fails (no value): they are not an observation.
  [[nodiscard]] std::optional<Observation> unpacked(std::string_view bytes) const;

  // The part that a marker's observations have in common.
  struct Shared {
    std::optional<DetectedCircle> circle;  // as in the reference frame
    bool has_print = false;
    PatchWindow window;
    PatchInformation per_pixel = PatchInformation::Zero();  // of noise and contrast as at rest
    double gain = 1.0;
  };

 private:
  std::vector<Shared> shared_;  // one per site marker
};

// Part of run.mgj's layout: its number must rise when the bytes change their meaning.
inline constexpr char kPackedLayout[] = "packed observation 1";

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// One frame -> one Observation: the pixel side of the methods `conventional` and `two-stage`.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// What the past says about this frame. Only a hint for where to look: a wrong one costs time, not truth; but `travel`
// decides the whole pitches of a target that has left its first half pitch.
struct Prediction {
  std::optional<IdealFromBoard> view;        // how the last frame saw the board
  std::vector<Extent<frame::Board>> travel;  // of each site marker since the reference frame, mm
  // The same for this frame, at constant velocity; nothing when the last frame was lost.
  std::optional<IdealFromBoard> expected;
  std::vector<Extent<frame::Board>> travel_expected;
};

// Seed paper 2.1, camera assumed still: every window stays where it was in the reference frame.
[[nodiscard]] Observation observe_conventional(const GreyPicture& picture, const Reference& reference,
                                               const Prediction& prediction, PatchWorkspace& work);

inline constexpr std::size_t kMinForHomography = 4, kMinForPose = 3;  // references

// The first stage and the second through at least so many references: kMinForPose of a known camera will do where the
// frame before says which three are seen.
[[nodiscard]] Observation observe_board(const GreyPicture& picture, const Reference& reference,
                                        const Prediction& prediction, std::size_t least, PatchWorkspace& work);

// Seed paper 2.2, Fig. 5: circle centres -> homography -> patches of the references -> their displacements added at the
// circles -> second homography -> target.
[[nodiscard]] Observation observe_two_stage(const GreyPicture& picture, const Reference& reference,
                                            const Prediction& prediction, PatchWorkspace& work);

// Fig. 5's second homography: stage 1 of `seen`, corrected by what its references' patches moved at their circles. None
// when too few can be read.
[[nodiscard]] std::optional<IdealFromBoard> second_view(const Reference& reference,
                                                        const std::vector<CirclePoint>& circles,
                                                        const Observation& seen);

// What `precise` adds to the reference frame: every print's template, learned from its picture, and the points it shows there.
void learn_prints(const GreyPicture& picture, Reference& reference);

// As two-stage, which says where everything is to a hundredth of a pixel; then every print's raw pixels against its template.
[[nodiscard]] Observation observe_precise(const GreyPicture& picture, const Reference& reference,
                                          const Prediction& prediction, PatchWorkspace& work);

}  // namespace moiregauge::internal

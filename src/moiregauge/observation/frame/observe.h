// SPDX-License-Identifier: Apache-2.0
// Reads one frame into one Observation: the part of the methods that needs pixels.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Prediction of a frame from earlier ones. It only states the start of a search, so a wrong one costs time and not
// correctness. One exception: `travel` determines the fringe order of a target that has moved by more than half a
// pitch.
struct Prediction {
  std::optional<IdealFromBoard> view;        // view of the last frame
  std::vector<Extent<frame::Board>> travel;  // displacement of each site marker in the last frame, mm
  // The same predicted for this frame, at constant velocity. Empty if the last frame was lost.
  std::optional<IdealFromBoard> expected;
  std::vector<Extent<frame::Board>> travel_expected;

  // Returns the displacement of a marker in the last frame, mm. It is zero if no travel is known.
  [[nodiscard]] Extent<frame::Board> last_travel(std::size_t marker) const {
    return marker < travel.size() ? travel[marker] : Extent<frame::Board>{};
  }
};

// Reads a frame by seed paper 2.1. The camera is assumed fixed: every window stays at its position in the reference
// frame.
[[nodiscard]] Observation observe_conventional(const GreyPicture& picture, const Reference& reference,
                                               const Prediction& prediction);

// Fewest references that determine a homography, and the pose of a known camera.
inline constexpr std::size_t kMinForHomography = 4, kMinForPose = 3;

// Reads a frame by both stages through at least `least` references. kMinForPose suffices for a known camera, if the
// previous frame identifies the three references.
// Fails (references_seen = false): reference_problem names the reason.
[[nodiscard]] Observation observe_board(const GreyPicture& picture, const Reference& reference,
                                        const Prediction& prediction, std::size_t least);

// Reads a frame by seed paper 2.2, Fig. 5. The circle centres give the first homography, which serves to read the
// references' gratings. Their displacements, added at the circles, give the second homography, which serves to read the
// targets.
[[nodiscard]] Observation observe_two_stage(const GreyPicture& picture, const Reference& reference,
                                            const Prediction& prediction);

// Returns the second homography of Fig. 5: stage 1 of `seen`, corrected at the circles by the displacements of the
// references' gratings.
// Fails (nothing): too few references can be read.
[[nodiscard]] std::optional<IdealFromBoard> second_view(const Reference& reference,
                                                        const std::vector<CirclePoint>& circles,
                                                        const Observation& seen);

// Learns the template of every grating from the reference frame, for `precise`, and fits its points there. A template
// that cannot be learned stays empty.
void learn_prints(const GreyPicture& picture, Reference& reference);

// Fits the learned templates in a frame that another method read.
void fit_templates(const GreyPicture& picture, const Reference& reference, Observation& seen);

// Reads a frame by tracking, or by detection where tracking fails, and fits every template to the raw pixels. Steps and
// limits are in docs/methods/precise/frame-reading.md.
[[nodiscard]] Observation observe_precise(const GreyPicture& picture, const Reference& reference,
                                          const Prediction& prediction);

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// Notes on the limits of layout and footage, each with its remedy.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "moiregauge/calibration/model/calibrate.h"
#include "moiregauge/calibration/model/target_movement.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Returns one line for the worst target, if its layout shows one axis several times worse than the other. It states
// both bounds and the references to move.
[[nodiscard]] std::optional<std::string> weak_axis_note(const Reference& reference);

// Returns one line if the gratings are stretched along one axis beyond the site's `print_scale`. The pitch of both axes
// is then uncertain.
[[nodiscard]] std::optional<std::string> stretched_prints_note(const Site& site, const Calibration& calibration);

// Returns one line if the camera hardly rotates and moves in these frames. Its lens was then hardly tested.
[[nodiscard]] std::optional<std::string> still_camera_note(const Scene& scene, std::span<const BundleFrame> frames);

// Returns a line for every target whose height or rotation was removed from the frames of `solved`. It states the largest
// one since the reference frame, which is the first. The u of a height contains noise, the grating's size between two views,
// and the focal length: a height by size is proportional to it.
[[nodiscard]] std::vector<std::string> movement_notes(const Site& site, const MovementRemoval& removal,
                                                      const BundleSolution& solved);

}  // namespace moiregauge::internal

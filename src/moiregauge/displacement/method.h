// SPDX-License-Identifier: Apache-2.0
// Table of the measuring methods: one row per method.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/displacement/camera_pose.h"
#include "moiregauge/displacement/joint_errors.h"
#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/frame/observe.h"
#include "moiregauge/observation/reference/observations.h"
#include "moiregauge/units/frame_range.h"

namespace moiregauge::internal {

using Samples = std::vector<Sample>;  // by observation, then by target in the site's order

// Statements of the user about the run, besides the site.
struct SolveOptions {
  std::optional<FrameRange> rest;  // frames in which no target moves
  // Standard uncertainties of the given camera in the Scene's order, NaN if unknown. Empty: those of a usual
  // calibration.
  std::optional<std::array<double, kCameraParameters>> u_camera;
  // Readout time; 0: global shutter; empty: determined from the footage.
  std::optional<double> readout_s;
  int rotation_deg = 0;  // rotation tag of the stream: image columns may be rows of the sensor
};

// A target that moves in frames in which the user states rest.
struct MovedAtRest {
  std::size_t marker = 0;  // index in the site
  long from = 0, to = 0;   // the two rest frames with the largest distance
  double mm = 0.0;
  double u_mm = 0.0;  // standard uncertainty from the noise of both frames
};

struct Solution {
  Samples samples;
  // chi2 per degree of freedom of each observation in the scene, NaN if not fitted. Empty: no scene was solved.
  std::vector<double> chi2_dof;
  std::optional<Scene> scene;        // only from methods that solve a scene
  std::vector<CameraPose> poses;     // by observation; empty: no scene was solved
  bool references_verified = false;  // the layout can name a moving reference, and none is in doubt
  std::vector<std::string> notes;    // warnings and notes for the user
  // Instruction if no row is trusted; empty if no remedy is known.
  std::string remedy;
  std::vector<std::string> findings;  // results about camera and gratings, withheld from a refused run
  // If set, it contradicts the stated rest, and the samples do not use that statement.
  std::optional<MovedAtRest> moved_at_rest;
  // Computes the joint errors of the samples, at the cost of another fit of every frame. It refers to the reference and
  // the observations of the solution. Empty: the method does not know the covariance of different targets.
  std::function<JointErrors()> joint_errors;
};

// Measures by section 2.1 of the seed paper, with phase unwrapping beyond half a pitch. If the camera moved,
// displacements stay wrapped within half a pitch, as published.
[[nodiscard]] Solution solve_conventional(const Reference& reference, const Observations& observations,
                                          const SolveOptions& options);

// Measures by section 2.2 of the seed paper, with phase unwrapping beyond half a pitch, and with u.
[[nodiscard]] Solution solve_two_stage(const Reference& reference, const Observations& observations,
                                       const SolveOptions& options);

// Measures by comparing raw pixels with the learned template. Lens and marker positions are solved from the footage
// (docs/methods/precise.md). Falls back to `two-stage` if they cannot be solved.
[[nodiscard]] Solution solve_precise(const Reference& reference, const Observations& observations,
                                     const SolveOptions& options);

struct Method {
  std::string_view name;
  std::string_view summary;
  void (*prepare)(const GreyPicture&, Reference&);  // called once with the image of the reference frame; may be nullptr
  Observation (*observe)(const GreyPicture&, const Reference&, const Prediction&);
  Solution (*solve)(const Reference&, const Observations&, const SolveOptions&);
  bool needs_circles = true;  // false: gratings suffice, because the camera is assumed fixed
};

inline constexpr std::array kMethods{
    Method{"conventional", "sampling moire with a fixed camera (seed paper 2.1)", nullptr, observe_conventional,
           solve_conventional, false},
    Method{"two-stage", "the seed paper's method: circle centres, refined by sampling moire (2.2)", nullptr,
           observe_two_stage, solve_two_stage},
    Method{"precise",
           "raw pixels compared with a learned template; lens and marker positions are solved from the footage",
           learn_prints, observe_precise, solve_precise},
};
inline constexpr std::string_view kDefaultMethod = "precise";

[[nodiscard]] constexpr const Method* method_named(std::string_view name) {
  for (const Method& method : kMethods) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

}  // namespace moiregauge::internal

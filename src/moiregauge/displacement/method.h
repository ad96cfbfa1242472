// SPDX-License-Identifier: Apache-2.0
// The methods of measuring, as a table: a method is a row.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/frame/observe.h"
#include "moiregauge/observation/reference/observations.h"
#include "moiregauge/units/frame_range.h"

namespace moiregauge::internal {

using Samples = std::vector<Sample>;  // by observation, then by target in the site's order

// What the user says about the run beyond the site.
struct SolveOptions {
  std::optional<FrameRange> rest;  // frames in which no target moves
  // Standard uncertainties of the given camera in the Scene's order, NaN where unknown; none: those of a calibration.
  std::optional<std::array<double, kCameraParameters>> u_camera;
  // Time from the first row's exposure to the last one's; 0: all rows at once; none: told by the footage.
  std::optional<double> readout_s;
  int rotation_deg = 0;  // by which the picture is shown turned: rows of the sensor may be columns
};

// A target that moves in frames in which the user says it is at rest.
struct MovedAtRest {
  std::size_t marker = 0;  // index in the site
  long from = 0, to = 0;   // the two frames of the rest between which it moves furthest
  double mm = 0.0;
  double u_mm = 0.0;  // of both frames' noise
};

struct Solution {
  Samples samples;
  // Of each observation against the scene, NaN where not fitted; empty: no scene was solved.
  std::vector<double> chi2_dof;
  std::optional<Scene> scene;        // of a method that solves one
  bool references_verified = false;  // they were enough to be tested against each other, and were
  std::vector<std::string> notes;    // what the user should know
  std::string remedy;  // what to do where no row is trusted, as an order; empty where nothing is known to help
  std::vector<std::string> findings;         // results about camera and prints, withheld from a refused run
  std::optional<MovedAtRest> moved_at_rest;  // contradicts SolveOptions::rest, without which the samples are then made
};

// Seed paper 2.1, with travel followed beyond half a pitch. Behind a camera that moved displacements stay wrapped within
// half a pitch, as published.
[[nodiscard]] Solution solve_conventional(const Reference& reference, const Observations& observations,
                                          const SolveOptions& options);

// Seed paper 2.2, with travel followed beyond half a pitch, and u.
[[nodiscard]] Solution solve_two_stage(const Reference& reference, const Observations& observations,
                                       const SolveOptions& options);

// Raw pixels against the print's own template, the lens and the markers' places solved from the footage
// (docs/methods/precise.md); `two-stage` where they cannot be solved.
[[nodiscard]] Solution solve_precise(const Reference& reference, const Observations& observations,
                                     const SolveOptions& options);

struct Method {
  std::string_view name;
  std::string_view summary;
  void (*prepare)(const GreyPicture&, Reference&);  // with the reference frame's picture; may be nullptr
  Observation (*observe)(const GreyPicture&, const Reference&, const Prediction&, PatchWorkspace&);
  Solution (*solve)(const Reference&, const Observations&, const SolveOptions&);
  bool needs_circles = true;  // false: gratings are enough, the camera stands still
};

inline constexpr std::array kMethods{
    Method{"conventional", "sampling moire, camera assumed still (seed paper 2.1)", nullptr, observe_conventional,
           solve_conventional, false},
    Method{"two-stage", "the seed paper: circle centres, then moire-refined centres (2.2)", nullptr, observe_two_stage,
           solve_two_stage},
    Method{"precise", "raw pixels against the learned print, lens and markers solved from the footage", learn_prints,
           observe_precise, solve_precise},
};
inline constexpr std::string_view kDefaultMethod = "precise";

[[nodiscard]] constexpr const Method* method_named(std::string_view name) {
  for (const Method& method : kMethods) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

}  // namespace moiregauge::internal

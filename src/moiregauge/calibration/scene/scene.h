// SPDX-License-Identifier: Apache-2.0
// What stays the same during a run: the camera's lens, and where and how every marker really hangs.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/geometry/camera.h"
#include "moiregauge/geometry/pose.h"

namespace moiregauge::internal {

// Departure of a marker from the site: its place (a target's only if it is known when it rests: where it
// stands is what is measured), its turn, the scale of its print and its height.
struct MarkerShape {
  enum Parameter { kX, kY, kRotation, kScale, kHeight, kParameters };
  std::array<double, kParameters> value{};  // mm, mm, rad counter-clockwise, relative, mm above the reference plane
};
inline constexpr int kShapeParameters = MarkerShape::kParameters;

inline constexpr int kCameraParameters = 8;   // f cx cy k1 k2 p1 p2 k3
inline constexpr double kUnknownFocal = 1.0;  // relative: u of a focal length of which nothing is known
// What all markers share: the camera, and how much longer every print is along its x than along its y (relative; half
// of it on either axis). Printers feed paper and move ink by different means, and stretch both ways differently.
inline constexpr int kCommonParameters = kCameraParameters + 1, kStretchParameter = kCameraParameters;

// Where a marker's parameter stands among a scene's: behind what all share.
[[nodiscard]] constexpr int shape_row(std::size_t marker, int parameter) {
  return kCommonParameters + kShapeParameters * static_cast<int>(marker) + parameter;
}

// How much of the lens and the markers is solved, in ascending order.
struct SceneModel {
  bool radial = false;      // k1, k2
  bool tangential = false;  // p1, p2
  bool heights = false;     // of the references
  bool depth = false;       // of the targets
  [[nodiscard]] std::string name() const;
};
inline constexpr SceneModel kEverything{.radial = true, .tangential = true, .heights = true, .depth = true};

struct Scene {
  Camera camera;                     // fx = fy
  double stretch = 0.0;              // of every print: longer along its x than along its y, relative
  std::vector<MarkerShape> markers;  // one per site marker
  // Of the camera's eight and the stretch, then of five per marker; zero for what the model holds fixed.
  Eigen::MatrixXd covariance;
  // The same with all of them free within their priors, as the samples' u has it; empty where it was not made.
  Eigen::MatrixXd full_covariance;
  // What uncertainties are stated by: a parameter that the footage does not demand may yet be there.
  [[nodiscard]] const Eigen::MatrixXd& stated_covariance() const {
    return full_covariance.size() > 0 ? full_covariance : covariance;
  }
  SceneModel model;
  double chi2_dof = 0.0;        // of the data
  double penalised_cost = 0.0;  // data plus priors
  std::vector<long> key_frames;
  // From the first row's exposure to the last one's (below zero: from the picture's other end); 0: all at once. NaN
  // where frames have no times.
  double readout_s = 0.0, u_readout_s = 0.0;
  bool solved = false;  // false: nothing was solved, `problem` says why
  std::string problem;
};

// Returns whether the footage determines the camera: a lens was solved, and its focal length has a u of a tenth or less.
// A worse one gives neither angles nor a camera file. A plane model holds the lens at what was given.
[[nodiscard]] bool determines_camera(const Scene& scene);

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// Scene: everything that is constant during a run, that is the lens and the position and shape of every marker.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/geometry/camera.h"
#include "moiregauge/geometry/pose.h"

namespace moiregauge::internal {

// Corrections of a marker to the site: position, rotation and scale. Height and tilt are absolute. A target's position
// is corrected only if rest frames are known. The tilt rotates the print about its centre, by the rotation vector
// (kTiltX, kTiltY, 0) on the board.
struct MarkerShape {
  enum Parameter { kX, kY, kRotation, kScale, kHeight, kTiltX, kTiltY, kParameters };
  // mm, mm, rad counter-clockwise, relative, mm above the reference plane, rad, rad
  std::array<double, kParameters> value{};
};
inline constexpr int kShapeParameters = MarkerShape::kParameters;

inline constexpr int kCameraParameters = 8;   // f cx cy k1 k2 p1 p2 k3
inline constexpr double kUnknownFocal = 1.0;  // u of an unknown focal length, relative
// Parameters that all markers share: the camera, and the stretch of all gratings. Stretch is relative: a grating is
// longer by half of it along its x, and shorter by half along y. Printers feed paper and move ink by different means,
// so the axes differ.
inline constexpr int kCommonParameters = kCameraParameters + 1, kStretchParameter = kCameraParameters;

// Returns the index of a marker's parameter in the scene, after the shared parameters.
[[nodiscard]] constexpr int shape_row(std::size_t marker, int parameter) {
  return kCommonParameters + kShapeParameters * static_cast<int>(marker) + parameter;
}

// Parameters of lens and markers that are solved.
struct SceneModel {
  bool radial = false;      // k1, k2
  bool tangential = false;  // p1, p2
  bool heights = false;     // for the references
  bool depth = false;       // for the targets
  bool tilts = false;       // for all markers
  [[nodiscard]] std::string name() const;
};
inline constexpr SceneModel kEverything{.radial = true, .tangential = true, .heights = true, .depth = true};
// Returns all that may be there in a scene of this model. Prints are parallel to the plane unless the footage shows
// otherwise.
[[nodiscard]] constexpr SceneModel everything_with(const SceneModel& model) {
  SceneModel out = kEverything;
  out.tilts = model.tilts;
  return out;
}

struct Scene {
  Camera camera;                     // fx = fy
  double stretch = 0.0;              // all gratings: relatively longer along x than along y
  std::vector<MarkerShape> markers;  // one per site marker
  // Covariance of the camera's eight parameters and the stretch, then of seven per marker. Fixed parameters have zeros.
  Eigen::MatrixXd covariance;
  // The same with all parameters free within their priors, as in the samples' u. Empty if it was not computed.
  Eigen::MatrixXd full_covariance;
  // Returns the covariance for stated uncertainties. A parameter that the footage does not require may still be there.
  [[nodiscard]] const Eigen::MatrixXd& stated_covariance() const {
    return full_covariance.size() > 0 ? full_covariance : covariance;
  }
  SceneModel model;
  double chi2_dof = 0.0;        // the data's chi-squared per degree of freedom
  double penalised_cost = 0.0;  // data plus priors
  std::vector<long> key_frames;
  // Readout time and its u, s. Negative: the readout starts at the opposite end. 0: global shutter. NaN: frames have no
  // times.
  double readout_s = 0.0, u_readout_s = 0.0;
  bool solved = false;  // if false, `problem` states the reason
  std::string problem;
};

// Returns true if the footage determines the camera: a lens was solved, and f has a relative u of at most 0.1. A less
// certain one gives neither angles nor a camera file. A plane model keeps the given lens.
[[nodiscard]] bool determines_camera(const Scene& scene);

}  // namespace moiregauge::internal

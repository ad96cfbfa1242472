// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/print_error.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/calibration/scene/fitted_patch.h"

namespace moiregauge::internal {
namespace {

constexpr int kSize = PatchResidual::kSize;
using Matrix18 = Eigen::Matrix<double, kSize, kSize>;
using Vector18 = Eigen::Matrix<double, kSize, 1>;

constexpr double kMaxError_pitches = 0.05;  // beyond it the points are not those of this grating; chosen
constexpr int kHalvings = 40;               // bisection: reduces the interval by 1e12
constexpr double kBelieved = 100.0;         // degrees of freedom that favour the stated noise; chosen

// Returns the covariance of an error `own` in each coordinate of each point and `common` to all nine.
Matrix18 covariance_of(double own, double common) {
  Matrix18 m = own * own * Matrix18::Identity();
  m.topLeftCorner<kPatchPoints, kPatchPoints>().array() += common * common;
  m.bottomRightCorner<kPatchPoints, kPatchPoints>().array() += common * common;
  return m;
}

// Returns (C + M)^-1. C^-1 = information may be singular: an axis that the grating does not show stays unknown.
PatchInformation inflated(const PatchInformation& information, const Matrix18& covariance) {
  const Matrix18 a = Matrix18::Identity() + information * covariance;
  const PatchInformation out = a.partialPivLu().solve(information);
  return 0.5 * (out + out.transpose());
}

// Residual of one grating, whitened by noise, along the axes in which a print error is independent.
struct Whitened {
  Vector18 squared;   // squared residual along each axis
  Vector18 of_error;  // variance along it per mm^2 of print error
  [[nodiscard]] double chi2(double u_mm) const {
    return (squared.array() / (1.0 + u_mm * u_mm * of_error.array())).sum();
  }
};

// Prints that share one print error.
struct Group {
  std::vector<Whitened> patches;
  double dof = 0.0;
  double pitch_mm = 0.0;
};

Whitened whitened(const PatchResidual& residual, const PatchResidual::Design& design, double pitch_mm) {
  const Vector18 r = design.col(PatchColumn::kResidual);
  const Matrix18& root = residual.root();
  const Matrix18 error = root * covariance_of(1.0, 1.0) * root.transpose() / (pitch_mm * pitch_mm);
  const Eigen::SelfAdjointEigenSolver<Matrix18> eigen(error);
  const Vector18 along = eigen.eigenvectors().transpose() * r;
  return {along.cwiseAbs2(), eigen.eigenvalues().cwiseMax(0.0)};
}

// Returns the degrees of freedom of a target's points in one frame: their rank, less its shift and its part of the pose
// (and motion). That part is the trace of its block of the projection onto the pose, after eliminating the shift.
double dof_of_target(const PatchResidual& patch, const PatchResidual::Design& design, const BundleFrame& frame,
                     const FrameFit& fit, std::size_t marker) {
  const int row = fit.shift_row[marker];
  if (row < 0) return 0.0;
  const auto part = std::ranges::find(fit.shift_parts, marker, &ShiftPart::marker);
  Eigen::Matrix<double, kSize, Eigen::Dynamic, 0, kSize, kMaxPose> by_pose =
      design.middleCols<2>(PatchColumn::kShape) * part->by_pose;
  by_pose.leftCols<6>() += design.middleCols<6>(PatchColumn::kPose);
  if (frame.rows)
    by_pose.rightCols<kMotionParameters>() +=
        patch.root() * frame.rows->by_marker[marker].leftCols<kMotionParameters>();
  return patch.rank() - 2.0 - (by_pose * fit.pose_covariance).cwiseProduct(by_pose).sum();
}

// Returns true if targets share the print error of the references. What the path of a rolling shutter does not explain
// shows in all prints.
bool is_shared(std::span<const BundleFrame> frames) { return !frames.empty() && frames.front().rows.has_value(); }

// Returns the groups of prints: one per target, in the place of its site marker, and that of all references last.
std::vector<Group> groups_of(const Site& site, const Scene& scene, std::span<const BundleFrame> frames,
                             std::span<const FrameFit> fits, const Eigen::VectorXd& known) {
  const bool shared = is_shared(frames);
  std::vector<Group> groups(site.markers.size() + 1);
  Group& references = groups.back();
  references.dof = -known.sum();
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (!fits[k].ok) continue;
    references.dof += static_cast<double>(fits[k].dof);
    for (std::size_t i = 0; i < site.markers.size(); ++i) {
      const Marker& marker = site.markers[i];
      if (!frames[k].points[i] || !marker.grating) continue;
      const bool is_own = marker.role != Role::kReference && !shared;
      Group& group = is_own ? groups[i] : references;
      const PatchResidual patch(*frames[k].points[i], marker);
      const auto design = fitted_design(patch, scene, frames[k], fits[k], i);
      group.patches.push_back(whitened(patch, design, marker.grating->pitch_mm));
      group.pitch_mm = std::max(group.pitch_mm, marker.grating->pitch_mm);
      if (is_own) group.dof += dof_of_target(patch, design, frames[k], fits[k], i);
    }
  }
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (groups[i].patches.empty()) continue;
    groups[i].dof -= known.segment<kShapeParameters>(shape_row(i, 0)).sum();
    references.dof -= groups[i].dof;
  }
  return groups;
}

// Returns the print error in mm with which chi2 equals its degrees of freedom.
double error_of(const Group& group) {
  const auto chi2 = [&](double u_mm) {
    double sum = 0.0;
    for (const Whitened& patch : group.patches) sum += patch.chi2(u_mm);
    return sum;
  };
  if (!(group.dof > 0.0) || chi2(0.0) <= chi2_upper_quantile(group.dof)) return 0.0;
  double low = 0.0, high = kMaxError_pitches * group.pitch_mm;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (chi2(middle) > group.dof ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

bool PrintError::has_rough_prints() const {
  return references_mm > 0.0 || std::ranges::any_of(targets_mm, [](double u) { return u > 0.0; });
}

bool are_alike(const PrintError& a, const PrintError& b, double share) {
  const auto is_alike = [&](double one, double other) { return std::abs(one - other) <= share * other; };
  for (std::size_t i = 0; i < std::max(a.targets_mm.size(), b.targets_mm.size()); ++i) {
    const auto at = [i](const PrintError& e) { return i < e.targets_mm.size() ? e.targets_mm[i] : 0.0; };
    if (!is_alike(at(a), at(b))) return false;
  }
  return is_alike(a.references_mm, b.references_mm) && is_alike(a.marker_jitter_mm, b.marker_jitter_mm);
}

Eigen::VectorXd determined(std::span<const FrameFit> fits, const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols());
  for (const FrameFit& fit : fits) {
    if (fit.ok) add_scene_information(fit, information);
  }
  return information.cwiseProduct(covariance).rowwise().sum();  // the product's diagonal: both are symmetric
}

std::vector<BundleFrame> with_print_error(const Site& site, std::span<const BundleFrame> frames,
                                          const PrintError& error) {
  std::vector<BundleFrame> out(frames.begin(), frames.end());
  if (!error.exceeds_noise() && !(error.noise_share < 1.0)) return out;
  for (BundleFrame& frame : out) {
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      if (!frame.points[i] || !site.markers[i].grating) continue;
      PatchInformation& information = frame.points[i]->information;
      information /= error.noise_share * error.noise_share;
      const double own = error.of_marker(site, i);
      if (!(own > 0.0 || error.marker_jitter_mm > 0.0)) continue;
      const double pitch = site.markers[i].grating->pitch_mm;
      information = inflated(information, covariance_of(own / pitch, std::hypot(own, error.marker_jitter_mm) / pitch));
    }
  }
  return out;
}

PrintError print_error(const Site& site, const Scene& scene, std::span<const BundleFrame> frames,
                       std::span<const FrameFit> fits, const ScenePrior& prior) {
  const auto groups =
      groups_of(site, scene, frames, fits, determined(fits, scene_covariance(site, fits, prior, scene.model)));
  PrintError out;
  out.references_mm = error_of(groups.back());
  for (std::size_t i = 0; i < site.markers.size(); ++i)
    out.targets_mm.push_back(is_shared(frames) ? out.references_mm : error_of(groups[i]));
  return out;
}

double error_in_frame(const Site& site, const Scene& scene, const BundleFrame& frame, const FrameFit& fit,
                      std::size_t target) {
  const auto& grating = site.markers[target].grating;
  if (!frame.points[target] || !grating || fit.shift_row[target] < 0) return 0.0;
  if (fit.chi2[target] <= chi2_upper_quantile(kSize - 2.0)) return 0.0;  // most rows
  const PatchResidual patch(*frame.points[target], site.markers[target]);
  const auto design = fitted_design(patch, scene, frame, fit, target);
  return error_of({{whitened(patch, design, grating->pitch_mm)},
                   dof_of_target(patch, design, frame, fit, target),
                   grating->pitch_mm});
}

double noise_share(const Site& site, const SceneModel& model, std::span<const FrameFit> fits, const ScenePrior& prior) {
  double chi2 = 0.0, dof = -determined(fits, scene_covariance(site, fits, prior, model)).sum();
  for (const FrameFit& fit : fits) {
    if (fit.ok) chi2 += fit.chi2_sum, dof += static_cast<double>(fit.dof);
  }
  if (!(dof > 0.0)) return 1.0;
  return std::sqrt(std::min(1.0, (chi2 + kBelieved) / (dof + kBelieved)));
}

}  // namespace moiregauge::internal

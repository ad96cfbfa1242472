// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/print_error.h"

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

Whitened whitened(const BundleFrame& frame, std::size_t i, const Marker& marker, const Scene& scene,
                  const FrameFit& fit) {
  const PatchResidual residual(*frame.points[i], marker);
  const Vector18 r = fitted_design(residual, scene, frame, fit, i).col(PatchColumn::kResidual);
  const Matrix18& root = residual.root();
  const Matrix18 error =
      root * covariance_of(1.0, 1.0) * root.transpose() / (marker.grating->pitch_mm * marker.grating->pitch_mm);
  const Eigen::SelfAdjointEigenSolver<Matrix18> eigen(error);
  const Vector18 along = eigen.eigenvectors().transpose() * r;
  return {along.cwiseAbs2(), eigen.eigenvalues().cwiseMax(0.0)};
}

// Returns the number of scene parameters that the frames determine. With wide priors these are all free ones.
double determined(const Site& site, std::span<const FrameFit> fits, const ScenePrior& prior, const SceneModel& model) {
  const Eigen::MatrixXd covariance = scene_covariance(site, fits, prior, model);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols());
  for (const FrameFit& fit : fits) {
    if (fit.ok) add_scene_information(fit, information);
  }
  return information.cwiseProduct(covariance).sum();  // the trace of their product: both are symmetric
}

}  // namespace

std::vector<BundleFrame> with_print_error(const Site& site, std::span<const BundleFrame> frames,
                                          const PrintError& error) {
  std::vector<BundleFrame> out(frames.begin(), frames.end());
  const bool is_rough = error.points_mm > 0.0 || error.marker_jitter_mm > 0.0;
  if (!is_rough && !(error.noise_share < 1.0)) return out;
  for (BundleFrame& frame : out) {
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      if (!frame.points[i] || !site.markers[i].grating) continue;
      PatchInformation& information = frame.points[i]->information;
      information /= error.noise_share * error.noise_share;
      if (!is_rough) continue;
      const double pitch = site.markers[i].grating->pitch_mm;
      const Matrix18 covariance =
          covariance_of(error.points_mm / pitch, std::hypot(error.points_mm, error.marker_jitter_mm) / pitch);
      information = inflated(information, covariance);
    }
  }
  return out;
}

double print_error_mm(const Site& site, const Scene& scene, std::span<const BundleFrame> frames,
                      std::span<const FrameFit> fits, const ScenePrior& prior) {
  std::vector<Whitened> patches;
  double dof = -determined(site, fits, prior, scene.model), pitch = 0.0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (!fits[k].ok) continue;
    dof += static_cast<double>(fits[k].dof);
    for (std::size_t i = 0; i < site.markers.size(); ++i) {
      if (!frames[k].points[i] || !site.markers[i].grating) continue;
      patches.push_back(whitened(frames[k], i, site.markers[i], scene, fits[k]));
      pitch = std::max(pitch, site.markers[i].grating->pitch_mm);
    }
  }
  const auto chi2 = [&](double u_mm) {
    double sum = 0.0;
    for (const Whitened& patch : patches) sum += patch.chi2(u_mm);
    return sum;
  };
  if (!(dof > 0.0) || chi2(0.0) <= chi2_upper_quantile(dof)) return 0.0;
  double low = 0.0, high = kMaxError_pitches * pitch;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (chi2(middle) > dof ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double noise_share(const Site& site, const SceneModel& model, std::span<const FrameFit> fits, const ScenePrior& prior) {
  double chi2 = 0.0, dof = -determined(site, fits, prior, model);
  for (const FrameFit& fit : fits) {
    if (fit.ok) chi2 += fit.chi2_sum, dof += static_cast<double>(fit.dof);
  }
  if (!(dof > 0.0)) return 1.0;
  return std::sqrt(std::min(1.0, (chi2 + kBelieved) / (dof + kBelieved)));
}

}  // namespace moiregauge::internal

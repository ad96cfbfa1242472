// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/reference_slip.h"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

namespace moiregauge::internal {
namespace {

// Fall of chi2 that justifies a separate position in one frame. It has two unknowns, so noise alone exceeds 40 once in
// 10^8 (exp(-20)) for each frame.
constexpr double kOwnPlace = 40.0;

// Position of the reference in each frame that shows it, in the scene of the others, mm. Frames are in the order of
// their numbers, although the reference frame comes first in the footage.
struct Way {
  std::vector<long> frame;
  Eigen::VectorXd place;       // x and y of each frame in turn
  Eigen::MatrixXd covariance;  // from the frames' noise and the scene they share
};

Way way_of(const Site& site, const std::vector<FrameFit>& fits, std::span<const BundleFrame> frames,
           const Eigen::MatrixXd& scene, std::size_t marker) {
  std::vector<std::size_t> seen;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    if (fits[k].ok && fits[k].shift_row[marker] >= 0) seen.push_back(k);
  }
  std::ranges::sort(seen, {}, [&](std::size_t k) { return frames[k].frame; });
  const auto rows = 2 * static_cast<Eigen::Index>(seen.size());
  Way way{{}, Eigen::VectorXd(rows), Eigen::MatrixXd::Zero(rows, rows)};
  Eigen::MatrixXd sensitivity(rows, scene_parameters(site.markers.size()));
  Eigen::Index row = 0;
  for (const std::size_t k : seen) {
    way.frame.push_back(frames[k].frame);
    way.place.segment<2>(row) << fits[k].shift[marker].x, fits[k].shift[marker].y;
    way.covariance.block<2, 2>(row, row) = shift_covariance(fits[k], marker);
    sensitivity.middleRows<2>(row) = shift_sensitivity(fits[k], marker);
    row += 2;
  }
  way.covariance += sensitivity * scene * sensitivity.transpose();
  return way;
}

// Returns chi2 of the path about the best constant position. With `first` there are two positions, before that frame
// and from it on. With kInOneFrame that frame has its own position, because it was exposed while the reference moved.
enum class Slipping { kBetweenFrames, kInOneFrame };
double chi2_about(const Way& way, const Eigen::LLT<Eigen::MatrixXd>& root, std::size_t first = 0,
                  Slipping slipping = Slipping::kBetweenFrames) {
  const Eigen::Index rows = way.place.size();
  const auto step = static_cast<Eigen::Index>(first);
  const bool has_own_place = slipping == Slipping::kInOneFrame;
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(rows, has_own_place ? 6 : step > 0 ? 4 : 2);
  for (Eigen::Index k = 0; 2 * k < rows; ++k) {
    const Eigen::Index column = step == 0 || k < step ? 0 : has_own_place && k == step ? 4 : 2;
    design.block<2, 2>(2 * k, column).setIdentity();
  }
  const Eigen::MatrixXd a = root.matrixL().solve(design);
  const Eigen::VectorXd b = root.matrixL().solve(way.place);
  const Eigen::VectorXd x = (a.transpose() * a).ldlt().solve(a.transpose() * b);
  return (b - a * x).squaredNorm();
}

// Largest roughness of a smooth path. Independent positions in ten frames scatter by 0.2 about 1. A sine with a period of
// nine frames has 0.23. Chosen.
constexpr double kSmooth = 0.4;

double roughness_of(const Eigen::VectorXd& place) {
  const Eigen::Index frames = place.size() / 2;
  const Eigen::Map<const Eigen::Matrix2Xd> path(place.data(), 2, frames);
  const double about = (path.colwise() - path.rowwise().mean()).squaredNorm();
  const double steps = (path.rightCols(frames - 1) - path.leftCols(frames - 1)).squaredNorm();
  return about > 0.0 ? 0.5 * steps / about : 1.0;
}

// Returns the fall of chi2 that justifies a separate position in every frame.
double cost_of_free_path(long rows) { return 0.5 * kOwnPlace * static_cast<double>(rows); }

}  // namespace

bool ReferenceSlip::is_step() const {
  return roughness > kSmooth || free_fall - step_fall <= cost_of_free_path(free_rows);
}

double ReferenceSlip::left() const { return chi2 + (is_step() ? free_fall - step_fall : cost_of_free_path(free_rows)); }

double ReferenceSlip::unit() const {
  const double scene = dof > 0 ? chi2 / static_cast<double>(dof) : 1.0;
  const long left = free_rows - 2;
  const double about = left > 0 && is_step() ? (free_fall - step_fall) / static_cast<double>(left) : 1.0;
  return std::max({1.0, scene, about});
}

std::optional<ReferenceSlip> fit_reference_step(Site site, std::span<const BundleFrame> frames, ScenePrior prior,
                                                const Scene& start, std::size_t marker) {
  SceneModel model = start.model;
  site.markers[marker].role = Role::kTarget;
  auto& u = prior.u_markers[marker].value;
  u[MarkerShape::kX] = u[MarkerShape::kY] = 0.0;  // each frame determines its position
  model.depth = model.depth || model.heights;
  std::vector<BundleFrame> free(frames.begin(), frames.end());
  for (BundleFrame& frame : free) frame.at_rest = false;
  const BundleSolution solved = solve_bundle(site, free, prior, model, &start);
  if (!solved.scene.solved) return std::nullopt;
  ReferenceSlip slip;
  std::vector<FrameFit> fits;
  for (const BundleFrame& frame : solved.frames) {
    fits.push_back(fit_frame(site, solved.scene, frame));
    if (!fits.back().ok) continue;
    slip.chi2 += fits.back().chi2_sum;
    slip.dof += fits.back().dof;
  }
  const Way way =
      way_of(site, fits, solved.frames, scene_covariance(site, fits, prior, everything_with(model)), marker);
  if (way.frame.size() < 2) return std::nullopt;
  const Eigen::LLT<Eigen::MatrixXd> root(way.covariance);
  if (root.info() != Eigen::Success) return std::nullopt;
  slip.free_fall = chi2_about(way, root);
  slip.free_rows = static_cast<long>(way.place.size()) - 2;
  slip.roughness = roughness_of(way.place);
  const auto try_step = [&](std::size_t first, std::size_t settled, double left) {
    const double fall = slip.free_fall - left;
    if (fall > slip.step_fall) slip.step_fall = fall, slip.step = {way.frame[first - 1], way.frame[settled]};
  };
  for (std::size_t first = 1; first < way.frame.size(); ++first) {
    try_step(first, first, chi2_about(way, root, first));
    if (first + 1 < way.frame.size())
      try_step(first, first + 1, chi2_about(way, root, first, Slipping::kInOneFrame) + kOwnPlace);
  }
  return slip;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/bundle.h"

#include <cmath>
#include <memory>

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "moiregauge/calibration/free_parameters.h"
#include "moiregauge/calibration/patch_residual.h"

namespace moiregauge {
namespace {

constexpr int kShape = MarkerShape::kParameters;
// chi2 of a patch of 18 is 18 +- 6; one beyond this counts by its distance, not its square.
constexpr double kRobustFrom = 10.0;  // sqrt(chi2)

struct Blocks {
  std::array<double, kCameraParameters> camera{};
  std::vector<MarkerShape> markers;
  std::vector<Pose> poses;
  std::vector<std::vector<std::array<double, 2>>> shifts;  // by frame, then marker
};

using Reference18 = ceres::AutoDiffCostFunction<PatchResidual, PatchResidual::kSize, kCameraParameters, kShape, 6>;
using Target18 = ceres::AutoDiffCostFunction<PatchResidual, PatchResidual::kSize, kCameraParameters, kShape, 6, 2>;

// A block's prior: (value - mean) / u for those with u > 0; the rest held constant.
void add_prior(ceres::Problem& problem, double* block, int size, const double* mean, const double* u,
               std::span<const bool> is_free) {
  ceres::Matrix a = ceres::Matrix::Zero(size, size);
  ceres::Vector b(size);
  std::vector<int> constant;
  for (int i = 0; i < size; ++i) {
    b(i) = mean[i];
    if (u[i] > 0.0 && is_free[static_cast<std::size_t>(i)])
      a(i, i) = 1.0 / u[i];
    else
      constant.push_back(i);
  }
  if (static_cast<int>(constant.size()) == size) {
    problem.SetParameterBlockConstant(block);
    return;
  }
  problem.AddResidualBlock(new ceres::NormalPrior(a, b), nullptr, block);
  if (!constant.empty()) problem.SetManifold(block, new ceres::SubsetManifold(size, constant));
}

std::array<double, kCameraParameters> block_of(const Camera& c) {
  return {c.fx, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
}

Camera camera_of(const std::array<double, kCameraParameters>& b, const Camera& like) {
  Camera c = like;
  c.fx = c.fy = b[0];
  c.cx = b[1], c.cy = b[2], c.k1 = b[3], c.k2 = b[4], c.p1 = b[5], c.p2 = b[6], c.k3 = b[7];
  return c;
}

struct Sums {
  double chi2 = 0.0;
  long rows = 0;
};

void add_frame(ceres::Problem& problem, const Site& site, const BundleFrame& frame, std::size_t k, Blocks& blocks,
               Sums& sums, std::vector<ceres::ResidualBlockId>& data) {
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (!frame.points[i] || !site.markers[i].grating) continue;
    auto* residual = new PatchResidual(*frame.points[i], *site.markers[i].grating);
    auto* loss = new ceres::HuberLoss(kRobustFrom);
    double* shape = blocks.markers[i].value.data();
    double* pose = blocks.poses[k].turn.data();
    sums.rows += PatchResidual::kSize;
    if (site.markers[i].role == Role::kReference || frame.at_rest) {
      data.push_back(problem.AddResidualBlock(new Reference18(residual), loss, blocks.camera.data(), shape, pose));
    } else {
      data.push_back(problem.AddResidualBlock(new Target18(residual), loss, blocks.camera.data(), shape, pose,
                                              blocks.shifts[k][i].data()));
      sums.rows -= 2;
    }
  }
  sums.rows -= 6;
}

}  // namespace

static_assert(sizeof(Pose) == 6 * sizeof(double), "a pose is one block of six");

BundleSolution solve_bundle(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior,
                            const SceneModel& model, const Scene* start) {
  Blocks blocks;
  blocks.camera = block_of(start != nullptr ? start->camera : prior.camera);
  blocks.markers = start != nullptr ? start->markers : prior.markers;
  for (const BundleFrame& frame : frames) {
    blocks.poses.push_back(frame.pose);
    auto& shifts = blocks.shifts.emplace_back();
    for (const auto& d : frame.shift) shifts.push_back({d.x, d.y});
  }
  ceres::Problem problem;
  Sums sums;
  std::vector<ceres::ResidualBlockId> data;
  for (std::size_t k = 0; k < frames.size(); ++k) add_frame(problem, site, frames[k], k, blocks, sums, data);
  const auto mean = block_of(prior.camera);
  add_prior(problem, blocks.camera.data(), kCameraParameters, mean.data(), prior.u_camera.data(), free_camera(model));
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    double* shape = blocks.markers[i].value.data();
    if (!problem.HasParameterBlock(shape)) continue;
    add_prior(problem, shape, kShape, prior.markers[i].value.data(), prior.u_markers[i].value.data(),
              free_shape(model, site.markers[i].role));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = 100;
  options.num_threads = 1;  // the same bits everywhere
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  BundleSolution solution;
  solution.scene.camera = camera_of(blocks.camera, prior.camera);
  solution.scene.markers = blocks.markers;
  solution.scene.model = model;
  solution.scene.solved = summary.IsSolutionUsable() && blocks.camera[0] > 0.0;
  if (!solution.scene.solved) solution.scene.problem = "the bundle did not converge";
  solution.scene.penalised_cost = 2.0 * summary.final_cost;
  ceres::Problem::EvaluateOptions only_data;
  only_data.residual_blocks = data;
  double half_chi2 = 0.0;
  problem.Evaluate(only_data, &half_chi2, nullptr, nullptr, nullptr);
  solution.scene.chi2_dof = sums.rows > 0 ? 2.0 * half_chi2 / static_cast<double>(sums.rows) : 0.0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    BundleFrame frame = frames[k];
    frame.pose = blocks.poses[k];
    for (std::size_t i = 0; i < frame.shift.size(); ++i)
      frame.shift[i] = {blocks.shifts[k][i][0], blocks.shifts[k][i][1]};
    solution.frames.push_back(std::move(frame));
    solution.scene.key_frames.push_back(frames[k].frame);
  }
  return solution;
}

}  // namespace moiregauge

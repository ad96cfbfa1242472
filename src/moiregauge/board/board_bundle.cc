// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/board/board_bundle.h"

#include <algorithm>
#include <cmath>

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {
namespace {

// Huber's limit, in standard uncertainties of a point. Beyond it a point counts by its distance instead of its square.
// Chosen.
constexpr double kRobustFrom = 4.0;

// Prior u of the distortion at the corner of the image, relative to the half diagonal. It is four to ten times that of
// a measurement (scene_prior.cc), because photographs of a board determine the lens themselves. Chosen.
constexpr double kBoardRadial = 0.3, kBoardRadial2 = 0.2, kBoardRadial3 = 0.2, kBoardTangential = 0.02;
constexpr double kBoardPrincipal = 0.05;  // prior u of cx and cy, relative to the image's larger side; chosen

class PointResidual {
 public:
  PointResidual(const BoardPointSeen& point, double u_px) : point_(point), u_px_(u_px) {}
  template <typename T>
  bool operator()(const T* camera, const T* pose, T* residual) const {
    const T none[2]{T(0.0), T(0.0)};
    return (*this)(camera, pose, none, residual);
  }
  template <typename T>
  bool operator()(const T* camera, const T* pose, const T* offset, T* residual) const {
    const auto image = projected(camera, pose, {point_.board.x + offset[0], point_.board.y + offset[1], T(0.0)});
    residual[0] = (image[0] - point_.at.x) / u_px_;
    residual[1] = (image[1] - point_.at.y) / u_px_;
    return true;
  }

 private:
  BoardPointSeen point_;
  double u_px_;
};

using Cost = ceres::AutoDiffCostFunction<PointResidual, 2, kCameraParameters, 6>;
using PlaceCost = ceres::AutoDiffCostFunction<PointResidual, 2, kCameraParameters, 6, 2>;
static_assert(sizeof(Pose) == 6 * sizeof(double), "a pose is one block of six");

void hold_near_zero(ceres::Problem& problem, double* offset, double u_mm) {
  if (!problem.HasParameterBlock(offset)) return;
  if (u_mm > 0.0)
    problem.AddResidualBlock(new ceres::NormalPrior(ceres::Matrix::Identity(2, 2) / u_mm, ceres::Vector::Zero(2)),
                             nullptr, offset);
  else
    problem.SetParameterBlockConstant(offset);
}

}  // namespace

std::array<bool, kCameraParameters> free_of(const BoardModel& m) {
  return {true, true, true, m.radial, m.radial, m.tangential, m.tangential, m.k3};
}

BoardPrior board_prior(int width, int height, double f) {
  const double side = std::max(width, height), rho = 0.5 * std::hypot(width, height) / f, rho2 = rho * rho;
  return {{f, 0.5 * (width - 1), 0.5 * (height - 1), 0, 0, 0, 0, 0},
          {kUnknownFocal * f, kBoardPrincipal * side, kBoardPrincipal * side, kBoardRadial / rho2,
           kBoardRadial2 / (rho2 * rho2), kBoardTangential / rho, kBoardTangential / rho,
           kBoardRadial3 / (rho2 * rho2 * rho2)}};
}

BoardState solve_board(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                       const BoardState& start) {
  BoardState state = start;
  ceres::Problem problem;
  state.offset.resize(static_cast<std::size_t>(data.places), {0.0, 0.0});
  for (std::size_t v = 0; v < data.views.size(); ++v) {
    double* pose = state.poses[v].turn.data();
    for (std::size_t i = 0; i < data.views[v].size(); ++i) {
      auto* residual = new PointResidual(data.views[v][i], data.u_px[v][i]);
      auto* loss = new ceres::HuberLoss(kRobustFrom);
      if (data.place[v][i] == kNoPlace) {
        problem.AddResidualBlock(new Cost(residual), loss, state.camera.data(), pose);
      } else {
        double* offset = state.offset[static_cast<std::size_t>(data.place[v][i])].data();
        problem.AddResidualBlock(new PlaceCost(residual), loss, state.camera.data(), pose, offset);
      }
    }
  }
  for (auto& offset : state.offset) hold_near_zero(problem, offset.data(), data.print_mm);
  ceres::Matrix a = ceres::Matrix::Zero(kCameraParameters, kCameraParameters);
  ceres::Vector mean(kCameraParameters);
  const auto is_free = free_of(model);
  std::vector<int> held;
  for (int k = 0; k < kCameraParameters; ++k) {
    const auto i = static_cast<std::size_t>(k);
    mean(k) = prior.mean[i];
    if (is_free[i]) {
      a(k, k) = 1.0 / prior.u[i];
    } else {
      held.push_back(k);
      state.camera[i] = prior.mean[i];
    }
  }
  problem.AddResidualBlock(new ceres::NormalPrior(a, mean), nullptr, state.camera.data());
  if (!held.empty()) problem.SetManifold(state.camera.data(), new ceres::SubsetManifold(kCameraParameters, held));
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = 200;
  options.num_threads = 1;  // results must not depend on the number of cores
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  state.penalised_cost = 2.0 * summary.final_cost;
  state.solved = summary.IsSolutionUsable() && state.camera[0] > 0.0;
  return state;
}

Extent<frame::Image> residual_of(const BoardState& state, std::size_t view, const BoardPointSeen& point) {
  const Pose& p = state.poses[view];
  const std::array<double, 6> pose{p.turn[0], p.turn[1], p.turn[2], p.shift[0], p.shift[1], p.shift[2]};
  const auto image = projected(state.camera.data(), pose.data(), {point.board.x, point.board.y, 0.0});
  return {point.at.x - image[0], point.at.y - image[1]};
}

std::vector<std::size_t> patch_of(std::span<const BoardPointSeen> points) {
  double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
  for (const BoardPointSeen& p : points) {
    x0 = std::min(x0, p.board.x), x1 = std::max(x1, p.board.x);
    y0 = std::min(y0, p.board.y), y1 = std::max(y1, p.board.y);
  }
  const auto third = [](double at, double low, double high) {
    return high > low ? std::min<std::size_t>(2, static_cast<std::size_t>(3.0 * (at - low) / (high - low))) : 0;
  };
  std::vector<std::size_t> out;
  for (const BoardPointSeen& p : points) out.push_back(3 * third(p.board.y, y0, y1) + third(p.board.x, x0, x1));
  return out;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "moiregauge/board/board_bundle.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMinJackknifeViews = 3;  // two views give no useful scatter; chosen
constexpr double kPoseFreedom = 6.0;           // parameters of a pose

template <typename T>
void drop(std::vector<T>& values, std::size_t at) {
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(at));
}

double squares_of_view(const BoardState& state, std::size_t v, const std::vector<BoardPointSeen>& points) {
  double squares = 0.0;
  for (const BoardPointSeen& p : points) squares += std::pow(length(residual_of(state, v, p)), 2);
  return squares;
}

}  // namespace

CameraBlock jackknife_uncertainty(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                  const BoardState& state) {
  const std::size_t n = data.views.size();
  if (n < kMinJackknifeViews) return {};
  std::vector<CameraBlock> without;
  for (std::size_t v = 0; v < n; ++v) {
    BoardData others = data;
    BoardState start = state;
    drop(others.views, v), drop(others.u_px, v), drop(others.place, v), drop(start.poses, v);
    const BoardState solved = solve_board(others, prior, model, start);
    if (!solved.solved) return {};
    without.push_back(solved.camera);
  }
  CameraBlock u{};
  const double count = static_cast<double>(n);
  for (std::size_t k = 0; k < kCameraParameters; ++k) {
    double mean = 0.0, squares = 0.0;
    for (const CameraBlock& camera : without) mean += camera[k] / count;
    for (const CameraBlock& camera : without) squares += (camera[k] - mean) * (camera[k] - mean);
    u[k] = std::sqrt((count - 1.0) / count * squares);
  }
  return u;
}

std::vector<double> misfit_ratios(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                                  const BoardState& state) {
  const auto is_free = free_of(model);
  const auto parameters = static_cast<double>(std::count(is_free.begin(), is_free.end(), true));
  std::vector<double> ratios;
  for (std::size_t v = 0; v < data.views.size(); ++v) {
    const auto& points = data.views[v];
    BoardData one;
    one.views = {points};
    one.u_px = {data.u_px[v]};
    one.place = {std::vector<int>(points.size(), kNoPlace)};
    BoardState start;
    start.camera = state.camera;
    start.poses = {state.poses[v]};
    const BoardState own = solve_board(one, prior, model, start);
    const double rows = 2.0 * static_cast<double>(points.size());
    const double common = squares_of_view(state, v, points) / (rows - kPoseFreedom);
    const double alone = squares_of_view(own, 0, points) / std::max(1.0, rows - kPoseFreedom - parameters);
    ratios.push_back(own.solved && alone > 0.0 ? std::sqrt(common / alone) : 1.0);
  }
  return ratios;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/board/board_calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Geometry>

#include "moiregauge/board/board_start.h"
#include "moiregauge/board/board_work.h"
#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/calibration/scene/frame_pose.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMinPoints = 9;  // least points of a usable view; chosen
constexpr int kWeightRounds = 4;       // for weights, ellipses and outliers; from the second on little changes
// A view with a median residual this much larger than that of all views was indexed wrongly or shows another board.
// Chosen.
constexpr double kOddView = 5.0, kOddView_px = 0.5;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double rms_of(const BoardWork& work, std::size_t v) {
  double squares = 0.0;
  for (const BoardPointSeen& p : work.data.views[v]) squares += std::pow(length(residual_of(work.state, v, p)), 2);
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, work.data.views[v].size())));
}

// Solves with all parameters free, and the weights of the points in turn with them.
bool settle(BoardWork& work, const BoardModel& everything) {
  work.state = solve_board(work.data = data_of(work), work.prior, {}, work.state);
  for (int round = 0; round < kWeightRounds && work.state.solved; ++round) {
    work.state = solve_board(work.data, work.prior, everything, work.state);
    find_outliers(work);
    work.data = data_of(work);
    work.point_px = scatter_beyond_noise(work, everything);
    work.data = data_of(work);
  }
  if (work.state.solved) work.state = solve_board(work.data, work.prior, everything, work.state);
  return work.state.solved;
}

void begin(BoardWork& work, std::span<const BoardView> views, const std::vector<CalibratedView>& verdicts) {
  std::vector<IdealFromBoard> planes;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!verdicts[v].excluded.empty()) continue;
    work.views.push_back(&views[v]);
    work.is_outlier.emplace_back(views[v].points.size(), false);
    work.turns.push_back(0);
    work.place.emplace_back(views[v].points.size(), kNoPlace);
    planes.push_back(*plane_view(views[v]));
  }
  const int width = work.views.front()->width, height = work.views.front()->height;
  work.prior = board_prior(width, height, focal_length_of(planes, width, height));
  work.state.camera = work.prior.mean;
  for (const IdealFromBoard& plane : planes)
    work.state.poses.push_back(pose_of(plane, camera_of(work.prior.mean, width, height)));
}

// Images of one size are assumed to come from one camera. The most frequent size counts.
void leave_out_unlike(std::span<const BoardView> views, std::vector<CalibratedView>& verdicts) {
  std::map<std::pair<int, int>, int> sizes;
  for (const BoardView& view : views) ++sizes[{view.width, view.height}];
  const auto common = std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].points.size() < kMinPoints)
      verdicts[v].excluded = "no board was found";
    else if (std::pair{views[v].width, views[v].height} != common)
      verdicts[v].excluded = "it is " + std::to_string(views[v].width) + " x " + std::to_string(views[v].height) +
                             " px, the others " + std::to_string(common.first) + " x " + std::to_string(common.second);
    else if (!plane_view(views[v]))
      verdicts[v].excluded = "its points are on one line";
  }
}

bool leave_out_odd(const BoardWork& work, std::span<const BoardView> views, std::vector<CalibratedView>& verdicts) {
  if (work.views.size() < 3) return false;
  std::vector<double> all;
  const auto of_view = [&](std::size_t v) {
    std::vector<double> off;
    for (std::size_t i = 0; i < work.views[v]->points.size(); ++i)
      off.push_back(length(residual_of(work.state, v, work.views[v]->points[i])));
    return median(off);
  };
  for (std::size_t v = 0; v < work.views.size(); ++v) all.push_back(of_view(v));
  const double limit = std::max(kOddView_px, kOddView * median(all));
  bool any = false;
  for (std::size_t v = 0; v < work.views.size(); ++v) {
    if (all[v] <= limit) continue;
    verdicts[static_cast<std::size_t>(work.views[v] - views.data())].excluded =
        "it shows another board than the others, or was indexed wrongly";
    any = true;
  }
  return any;
}

// Selects the lens model by BIC (Schwarz 1978): a larger one must lower the cost by ln(n) per parameter, for n
// residuals.
BoardModel choose(BoardWork& work, const BoardOptions& options) {
  long rows = 0;
  for (const auto& view : work.data.views) rows += 2 * static_cast<long>(view.size());
  const double penalty = bic_penalty(rows);
  BoardModel chosen;
  BoardState best = solve_board(work.data, work.prior, chosen, work.state);
  for (const auto& [model, more] : {std::pair{BoardModel{.radial = true, .k3 = options.k3}, options.k3 ? 3 : 2},
                                    {BoardModel{.radial = true, .tangential = true, .k3 = options.k3}, 2}}) {
    const BoardState state = solve_board(work.data, work.prior, model, best);
    const bool of_chosen = model.tangential == chosen.tangential || chosen.radial;
    const int parameters = of_chosen ? more : more + (options.k3 ? 3 : 2);
    if (!state.solved || best.penalised_cost - state.penalised_cost < penalty * parameters) continue;
    chosen = model;
    best = state;
  }
  work.state = best;
  return chosen;
}

CalibratedView described(const BoardWork& work, std::size_t v, const Camera& camera) {
  CalibratedView view;
  const Pose& pose = work.state.poses[v];
  view.rms_px = rms_of(work, v);
  view.outliers = static_cast<int>(std::count(work.is_outlier[v].begin(), work.is_outlier[v].end(), true));
  const Eigen::Vector3d turn(pose.turn[0], pose.turn[1], pose.turn[2]);
  const Eigen::Vector3d normal =
      Eigen::AngleAxisd(turn.norm(), turn.norm() > 0.0 ? (turn / turn.norm()).eval() : Eigen::Vector3d::UnitX()) *
      Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d sight(pose.shift[0], pose.shift[1], pose.shift[2]);
  view.tilt_rad = std::acos(std::clamp(std::abs(normal.dot(sight)) / sight.norm(), 0.0, 1.0));
  view.null = board_null({camera.width, camera.height, work.data.views[v]}, camera);
  return view;
}

}  // namespace

tl::expected<BoardCalibration, std::string> calibrate_board(std::span<const BoardView> views,
                                                            const BoardOptions& options) {
  BoardCalibration out;
  out.views.resize(views.size());
  if (!views.empty()) leave_out_unlike(views, out.views);
  const BoardModel everything{.radial = true, .tangential = true, .k3 = options.k3};
  BoardWork work;
  for (bool again = true; again;) {
    if (std::all_of(out.views.begin(), out.views.end(), [](const auto& v) { return !v.excluded.empty(); }))
      return tl::unexpected(std::string("no photograph shows a board"));
    work = BoardWork{};
    begin(work, views, out.views);
    if (!settle(work, everything)) return tl::unexpected(std::string("no camera fits the points of the photographs"));
    again = leave_out_odd(work, views, out.views);
  }
  const BoardScatter noise_alone = scatter_of(work, everything, 0.0);
  solve_with_places(work, everything);
  out.patch_px = patch_scatter(work);
  out.u = uncertainty_of(work.data, work.prior, everything, work.state, out.patch_px);
  const CameraBlock between_views = jackknife_uncertainty(work.data, work.prior, everything, work.state);
  for (std::size_t k = 0; k < out.u.size(); ++k) out.u[k] = std::max(out.u[k], between_views[k]);
  const std::vector<double> misfits = misfit_ratios(work.data, work.prior, everything, work.state);
  const BoardModel chosen = choose(work, options);
  out.model = {.radial = chosen.radial, .tangential = chosen.tangential};
  out.k3 = chosen.k3;
  out.camera = camera_of(work.state.camera, work.views.front()->width, work.views.front()->height);
  out.chi2_dof = noise_alone.dof > 0.0 ? noise_alone.chi2 / noise_alone.dof : 0.0;
  out.point_px = work.point_px;
  out.print_mm = work.print_mm;
  out.matched = work.matched;
  double squares = 0.0;
  for (std::size_t v = 0; v < work.views.size(); ++v) {
    CalibratedView view = described(work, v, out.camera);
    view.misfit_ratio = misfits[v];
    out.views[static_cast<std::size_t>(work.views[v] - views.data())] = view;
    const auto n = work.data.views[v].size();
    squares += view.rms_px * view.rms_px * static_cast<double>(n);
    out.points += static_cast<int>(n);
  }
  out.rms_px = std::sqrt(squares / std::max(1, out.points));
  return out;
}

}  // namespace moiregauge::internal

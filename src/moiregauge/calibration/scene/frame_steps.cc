// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/frame_steps.h"

#include <vector>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/small_products.h"

namespace moiregauge::internal {
namespace {

// Columns of a patch: pose, motion of a rolling shutter, residual, shift.
template <int kMotion>
struct Columns {
  static constexpr int kOwn = 6 + kMotion, kResidual = kOwn, kShift = kOwn + 1, kAll = kOwn + 3;
  using Design = Eigen::Matrix<double, PatchResidual::kSize, kAll>;
  using Own = Eigen::Matrix<double, kOwn, kOwn>;
  using Sums = Eigen::Matrix<double, kOwn + 1, kOwn + 1>;
  using ShiftRows = Eigen::Matrix<double, 2, kOwn + 1>;
};

template <int kMotion>
typename Columns<kMotion>::Design design_of(const BundlePatch& patch, const TurnedPose& pose, const BundleState& at) {
  using FrameColumn = PatchResidual::FrameColumn;
  using Of = Columns<kMotion>;
  const auto shift = patch.shifts ? at.shifts[patch.frame][patch.marker] : Extent<frame::Board>{};
  const auto of_frame = patch.residual.frame_design(at.common, at.markers[patch.marker], pose, shift);
  typename Of::Design design;
  design.template leftCols<6>() = of_frame.template middleCols<6>(FrameColumn::kPose);
  design.col(Of::kResidual) = of_frame.col(FrameColumn::kResidual);
  design.template rightCols<2>() = of_frame.template middleCols<2>(FrameColumn::kShift);
  if constexpr (kMotion > 0) {
    design.template middleCols<kMotion>(6) = patch.rows->by_motion;
    design.col(Of::kResidual) += patch.rows->by_motion * at.motions[patch.frame];
  }
  return design;
}

// Applies the step of one frame to `to`. Returns false if its patches do not determine it.
template <int kMotion>
bool step_frame(std::span<const BundlePatch> patches, const BundleState& at, BundleState& to) {
  using Of = Columns<kMotion>;
  const std::size_t frame = patches.front().frame;
  const TurnedPose turned(at.poses[frame]);
  typename Of::Sums sums = Of::Sums::Zero();
  std::vector<typename Of::ShiftRows> shifts;  // one per patch that shifts
  for (const BundlePatch& patch : patches) {
    auto n = normal_matrix(design_of<kMotion>(patch, turned, at));
    n *= robust_weight(n(Of::kResidual, Of::kResidual));
    sums += n.template topLeftCorner<Of::kOwn + 1, Of::kOwn + 1>();
    if (!patch.shifts) continue;
    Eigen::Matrix2d own = n.template bottomRightCorner<2, 2>();
    own.diagonal().array() += kLeastShiftInformation;
    const typename Of::ShiftRows of_shift = n.template bottomLeftCorner<2, Of::kOwn + 1>();
    shifts.push_back(own.llt().solve(of_shift));
    sums -= of_shift.transpose().lazyProduct(shifts.back());
  }
  if constexpr (kMotion > 0) {
    const auto& information = patches.front().rows->information;
    sums.template block<kMotion, kMotion>(6, 6) += information;
    sums.col(Of::kResidual).template segment<kMotion>(6) += information * at.motions[frame];
  }
  const Eigen::LLT<typename Of::Own> llt(sums.template topLeftCorner<Of::kOwn, Of::kOwn>());
  if (llt.info() != Eigen::Success) return false;
  Eigen::Matrix<double, Of::kOwn + 1, 1> step;
  step << -llt.solve(sums.col(Of::kResidual).template head<Of::kOwn>()), 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    to.poses[frame].turn[k] += step(static_cast<Eigen::Index>(k));
    to.poses[frame].shift[k] += step(static_cast<Eigen::Index>(k) + 3);
  }
  if constexpr (kMotion > 0) to.motions[frame] += step.template segment<kMotion>(6);
  std::size_t next = 0;
  for (const BundlePatch& patch : patches) {
    if (!patch.shifts) continue;
    const Eigen::Vector2d by = -shifts[next++] * step;
    to.shifts[frame][patch.marker].x += by.x(), to.shifts[frame][patch.marker].y += by.y();
  }
  return true;
}

}  // namespace

std::optional<BundleState> step_of_frames(std::span<const BundlePatch> patches, const BundleState& at) {
  BundleState to = at;
  while (!patches.empty()) {
    std::size_t count = 0;
    while (count < patches.size() && patches[count].frame == patches.front().frame) ++count;
    const auto of_frame = patches.first(count);
    const bool ok =
        patches.front().rows ? step_frame<kMotionParameters>(of_frame, at, to) : step_frame<0>(of_frame, at, to);
    if (!ok) return std::nullopt;
    patches = patches.subspan(count);
  }
  return to;
}

}  // namespace moiregauge::internal

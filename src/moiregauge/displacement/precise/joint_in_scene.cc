// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/joint_in_scene.h"

#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "moiregauge/displacement/precise/precise_budget.h"

namespace moiregauge::internal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Returns L with L L^T the given positive semidefinite matrix. Columns of zeros are omitted.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
    if (covariance(k, k) > 0.0) used.push_back(k);
  }
  const auto size = static_cast<Eigen::Index>(used.size());
  const auto at = [&](Eigen::Index k) { return used[static_cast<std::size_t>(k)]; };
  Eigen::MatrixXd correlation(size, size);
  Eigen::VectorXd u(size);
  for (Eigen::Index k = 0; k < size; ++k) u(k) = std::sqrt(covariance(at(k), at(k)));
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) correlation(a, b) = covariance(at(a), at(b)) / (u(a) * u(b));
  }
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(correlation);
  const Eigen::VectorXd d = ldlt.vectorD().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd lower = ldlt.matrixL();
  const Eigen::MatrixXd small = u.asDiagonal() * (ldlt.transpositionsP().transpose() * (lower * d.asDiagonal()));
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(covariance.rows(), size);
  for (Eigen::Index k = 0; k < size; ++k) root.row(at(k)) = small.row(k);
  return root;
}

// Rows of a fit's shifts, and of the targets' values that they give.
struct RowPairs {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> shifts, rotations;  // in the fit, in the values
};

RowPairs rows_of(const std::vector<std::size_t>& targets, const FittedFrame& frame) {
  RowPairs out;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const int shift = frame.fit.shift_row[targets[t]], rotation = frame.rotations.row[targets[t]];
    if (shift >= 0) {
      out.shifts.emplace_back(shift, quantity_row(t, Quantity::kDx));
      out.shifts.emplace_back(shift + 1, quantity_row(t, Quantity::kDy));
    }
    if (rotation >= 0) out.rotations.emplace_back(rotation, quantity_row(t, Quantity::kRotation));
  }
  return out;
}

using Rows = std::vector<std::pair<Eigen::Index, Eigen::Index>>;

void add_block(Eigen::MatrixXd& to, const Rows& rows, double factor, const Eigen::MatrixXd& from) {
  for (const auto& [a, row] : rows) {
    for (const auto& [b, column] : rows) to(row, column) += factor * from(a, b);
  }
}

// Adds a fit's noise to `noise`.
void add_noise(const RowPairs& rows, const std::vector<std::size_t>& targets, const FittedFrame& frame,
               Eigen::MatrixXd& noise) {
  add_block(noise, rows.shifts, inflation(frame.fit), full_covariance(frame.fit));
  add_block(noise, rows.rotations, 1.0, frame.rotations.covariance);
  if (frame.u_motion.empty()) return;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const auto u = frame.u_motion[targets[t]];
    const Eigen::Index x = quantity_row(t, Quantity::kDx), y = quantity_row(t, Quantity::kDy);
    noise(x, x) += u.x * u.x;
    noise(y, y) += u.y * u.y;
  }
}

// Returns the codec's part of a frame's noise.
Eigen::MatrixXd codec_of(const RowPairs& rows, const std::vector<std::size_t>& targets, const FittedFrame& frame) {
  const Eigen::Index size = kQuantities * static_cast<Eigen::Index>(targets.size());
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(size, size), noise = both;
  FittedFrame alone;
  alone.fit = frame.by_noise;
  alone.rotations.row.assign(frame.rotations.row.size(), -1);
  add_block(both, rows.shifts, inflation(frame.fit), full_covariance(frame.fit));
  add_block(noise, rows_of(targets, alone).shifts, inflation(frame.fit), full_covariance(frame.by_noise));
  return both - noise;
}

// Adds `sign` times a frame's derivatives by the scene and by the readout time (last column).
void add_sensitivity(const RowPairs& rows, const FittedFrame& frame, double sign, Eigen::MatrixXd& k) {
  const Eigen::Index scene = k.cols() - 1;
  const Eigen::MatrixXd sensitivity = full_sensitivity(frame.fit);
  for (const auto& [from, to] : rows.shifts) {
    k.row(to).head(scene) += sign * sensitivity.row(from);
    if (from < frame.fit.by_readout.size()) k(to, scene) += sign * frame.fit.by_readout(from);
  }
  for (const auto& [from, to] : rows.rotations) {
    k.row(to).head(scene) += sign * frame.rotations.sensitivity.row(from);
    if (from < frame.rotations.by_readout.size()) k(to, scene) += sign * frame.rotations.by_readout(from);
  }
}

}  // namespace

JointInScene::JointInScene(const Site& site, const Eigen::MatrixXd& covariance, FittedFrame then, double u_readout_s)
    : site_(site), scene_root_(root_of(covariance)), then_(std::move(then)), u_readout_s_(u_readout_s) {
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (site.markers[i].role == Role::kTarget && site.markers[i].grating) targets_.push_back(i);
  }
}

JointErrors JointInScene::start() const {
  JointErrors joint;
  joint.targets = targets_;
  joint.u_position_mm = site_.known_to.position_mm;
  for (const std::size_t i : targets_) joint.positions.push_back(site_.markers[i].grating->centre);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(rows(), rows());
  add_noise(rows_of(targets_, then_), targets_, then_, noise);
  joint.constant = -root_of(noise);
  return joint;
}

FrameErrors JointInScene::errors_of(const FittedFrame& now) const {
  if (!now.fit.ok) return lost();
  FrameErrors out;
  const RowPairs at = rows_of(targets_, now), before = rows_of(targets_, then_);
  out.rotation_rad = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(targets_.size()), kNaN);
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const int a = now.rotations.row[targets_[t]], b = then_.rotations.row[targets_[t]];
    if (a >= 0 && b >= 0)
      out.rotation_rad(static_cast<Eigen::Index>(t)) = now.rotations.angle_rad(a) - then_.rotations.angle_rad(b);
  }
  out.noise = Eigen::MatrixXd::Zero(rows(), rows());
  add_noise(at, targets_, now, out.noise);
  if (now.by_noise.ok) out.bounded = codec_of(at, targets_, now);
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(rows(), scene_root_.rows() + 1);
  add_sensitivity(at, now, 1.0, k);
  add_sensitivity(before, then_, -1.0, k);
  out.varying.resize(rows(), scene_root_.cols() + 1);
  out.varying.leftCols(scene_root_.cols()) = k.leftCols(scene_root_.rows()) * scene_root_;
  out.varying.rightCols<1>() = u_readout_s_ * k.rightCols<1>();
  return out;
}

FrameErrors JointInScene::zero() const {
  FrameErrors out = lost();
  out.rotation_rad.setZero();
  return out;
}

FrameErrors JointInScene::lost() const {
  FrameErrors out;
  out.rotation_rad = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(targets_.size()), kNaN);
  out.noise = Eigen::MatrixXd::Zero(rows(), rows());
  out.varying = Eigen::MatrixXd::Zero(rows(), scene_root_.cols() + 1);
  out.constant_share = 0.0;
  return out;
}

}  // namespace moiregauge::internal

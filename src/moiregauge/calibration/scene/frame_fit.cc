// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/frame_fit.h"

#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/free_parameters.h"
#include "moiregauge/calibration/scene/normal_inverse.h"
#include "moiregauge/calibration/scene/patch_residual.h"
#include "moiregauge/calibration/scene/small_products.h"

namespace moiregauge::internal {
namespace {

constexpr int kRows = PatchResidual::kSize;
constexpr int kPasses = 4;  // largest number of Gauss-Newton steps, chosen
// Predicted fall of chi2 of a step that ends the iteration. The unknowns then moved by at most a thousandth of their u.
// The next step would be four orders smaller. Chosen.
constexpr double kSettled = 1e-6;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using PoseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxPose, kMaxPose>;
using PoseVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxPose, 1>;
using PoseByShift = Eigen::Matrix<double, Eigen::Dynamic, 2, 0, kMaxPose, 2>;
using OwnScene = Eigen::Matrix<double, kRows, kOwnParameters>;
using FrameColumn = PatchResidual::FrameColumn;

// Normal equations of one shift: with itself, with pose and motion, and with the scene.
struct ShiftNormal {
  std::size_t marker = 0;
  Eigen::Matrix2d own;
  PoseByShift across;
  Eigen::Vector2d right, by_readout = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, kOwnParameters> by_scene;
  Eigen::LLT<Eigen::Matrix2d> root;
};

// Normal equations of a frame. Pose and motion come first. Each target is connected with them and not with the others.
struct Normal {
  PoseMatrix pose;
  PoseVector right, by_readout;
  std::vector<ShiftNormal> shifts;
  Eigen::MatrixXd by_scene;
  std::vector<OwnInformation> own_scene;
  Eigen::VectorXd scene_by_readout, scene_slope;
  double bb = 0.0, rb = 0.0;  // the readout time with itself and with the residual
};

// Returns the index among all scene parameters of a grating's own parameter k.
int scene_column(std::size_t marker, int k) {
  return k < kCommonParameters ? k : k + kShapeParameters * static_cast<int>(marker);
}

// Rolling shutter: whitened derivatives by motion and readout time.
struct ByRows {
  Eigen::Matrix<double, kRows, kMotionParameters> motion;
  Eigen::Matrix<double, kRows, 1> readout;
};

// Derivatives of one grating's whitened residual. `scene` is filled in the last pass only.
struct PatchDesign {
  std::size_t marker = 0;
  PatchResidual::FrameDesign frame;
  OwnScene scene;
  const ByRows* rows = nullptr;  // null: global shutter
};

// The last pass adds the scene's part.
enum class Want { kStep, kSamples, kScene };

// Adds the part of a rolling shutter.
void add_rows(Normal& n, const PatchDesign& patch, ShiftNormal* shift) {
  const ByRows& rows = *patch.rows;
  const auto of_motion = product_of_columns(rows.motion, patch.frame);
  const auto of_readout = product_of_columns(patch.frame, rows.readout);
  n.pose.bottomLeftCorner<kMotionParameters, 6>() += of_motion.leftCols<6>();
  n.pose.topRightCorner<6, kMotionParameters>() = n.pose.bottomLeftCorner<kMotionParameters, 6>().transpose();
  n.pose.bottomRightCorner<kMotionParameters, kMotionParameters>() += normal_matrix(rows.motion);
  n.right.tail<kMotionParameters>() += of_motion.col(FrameColumn::kResidual);
  n.by_readout.head<6>() += of_readout.head<6>();
  n.by_readout.tail<kMotionParameters>() += product_of_columns(rows.motion, rows.readout);
  n.bb += rows.readout.squaredNorm();
  n.rb += of_readout(FrameColumn::kResidual);
  if (shift == nullptr) return;
  shift->across.bottomRows<kMotionParameters>() = of_motion.middleCols<2>(FrameColumn::kShift);
  shift->by_readout = of_readout.segment<2>(FrameColumn::kShift);
}

// Adds a grating. `shift`: its target's equations, or null. Returns the information about the grating's shift, with the
// pose known.
Eigen::Matrix2d add_patch(Normal& n, const PatchDesign& patch, ShiftNormal* shift) {
  const auto all = normal_matrix(patch.frame);
  const Eigen::Matrix2d own = all.block<2, 2>(FrameColumn::kShift, FrameColumn::kShift);
  n.pose.topLeftCorner<6, 6>() += all.topLeftCorner<6, 6>();
  n.right.head<6>() += all.block<6, 1>(0, FrameColumn::kResidual);
  if (shift != nullptr) {
    shift->marker = patch.marker;
    shift->own = own;
    shift->own.diagonal().array() += 1.0 / (kUnknownShift * kUnknownShift);
    shift->across.resize(n.pose.rows(), 2);
    shift->across.topRows<6>() = all.block<6, 2>(0, FrameColumn::kShift);
    shift->right = all.block<2, 1>(FrameColumn::kShift, FrameColumn::kResidual);
    shift->root.compute(shift->own);
  }
  if (patch.rows) add_rows(n, patch, shift);
  return own;
}

// Adds the scene's part of a grating, without its shift.
void add_scene(Normal& n, const PatchDesign& patch, ShiftNormal* shift, Want want) {
  Eigen::Matrix<double, Eigen::Dynamic, kOwnParameters, 0, kMaxPose, kOwnParameters> by_pose(n.pose.rows(),
                                                                                             kOwnParameters);
  const auto by_frame = product_of_columns(patch.frame, patch.scene);
  by_pose.topRows<6>() = by_frame.topRows<6>();
  if (patch.rows) by_pose.bottomRows<kMotionParameters>() = product_of_columns(patch.rows->motion, patch.scene);
  Eigen::Matrix<double, 2, kOwnParameters> solved = Eigen::Matrix<double, 2, kOwnParameters>::Zero();
  if (shift != nullptr) {
    shift->by_scene = by_frame.middleRows<2>(FrameColumn::kShift);
    solved = shift->root.solve(shift->by_scene);
    by_pose -= shift->across.lazyProduct(solved);
  }
  for (int k = 0; k < kOwnParameters; ++k) n.by_scene.col(scene_column(patch.marker, k)) += by_pose.col(k);
  if (want != Want::kScene) return;
  if (patch.rows) {
    auto with = product_of_columns(patch.scene, patch.rows->readout);
    if (shift != nullptr) with -= solved.transpose() * shift->by_readout;
    for (int k = 0; k < kOwnParameters; ++k) {
      n.scene_by_readout(scene_column(patch.marker, k)) += with(k);
      n.scene_slope(scene_column(patch.marker, k)) += by_frame(FrameColumn::kResidual, k);
    }
  }
  OwnInformation& own = n.own_scene.emplace_back(OwnInformation{patch.marker, normal_matrix(patch.scene)});
  if (shift != nullptr) own.information -= shift->by_scene.transpose().lazyProduct(solved);
}

// Equations of pose and motion without the shifts.
struct Reduced {
  PoseMatrix pose;
  PoseVector right;
};

Reduced without_shifts(const Normal& n) {
  Reduced out{n.pose, n.right};
  for (const ShiftNormal& s : n.shifts) {
    const Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kMaxPose> solved = s.root.solve(s.across.transpose());
    out.pose -= s.across.lazyProduct(solved);
    out.right -= solved.transpose().lazyProduct(s.right);
  }
  return out;
}

// Takes a Gauss-Newton step. Returns the fall of chi2 that it predicts, negative if the gratings do not determine it.
double take_step(FrameFit& fit, const Normal& n) {
  for (const ShiftNormal& s : n.shifts) {
    if (s.root.info() != Eigen::Success) return -1.0;
  }
  const Reduced reduced = without_shifts(n);
  const PoseVector scale = reduced.pose.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const PoseMatrix scaled = scale.asDiagonal() * reduced.pose * scale.asDiagonal();
  const Eigen::LDLT<PoseMatrix> ldlt(scaled);
  if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return -1.0;
  const PoseVector right = scale.cwiseProduct(reduced.right);
  const PoseVector step = scale.cwiseProduct(ldlt.solve(right));
  double fall = step.dot(n.right);
  for (int k = 0; k < 3; ++k) {
    fit.pose.turn[static_cast<std::size_t>(k)] -= step(k);
    fit.pose.shift[static_cast<std::size_t>(k)] -= step(3 + k);
  }
  for (const ShiftNormal& s : n.shifts) {
    const Eigen::Vector2d moved = s.root.solve(s.right - s.across.transpose() * step);
    fit.shift[s.marker].x -= moved.x(), fit.shift[s.marker].y -= moved.y();
    fall += moved.dot(s.right);
  }
  if (step.size() > 6) fit.motion -= step.tail<kMotionParameters>();
  return std::abs(fall);
}

// A frame's residuals and the layout of its unknowns: pose, shifts of the targets, motion while rows are read.
struct Unknowns {
  std::vector<std::optional<PatchResidual>> patches;  // one per site marker
  std::vector<std::optional<ByRows>> rows;            // the same, for a rolling shutter
  int references = 0;
  int shifts = 0;
  int pose = 6;  // with motion
};

Unknowns start(FrameFit& fit, const Site& site, const BundleFrame& frame) {
  const std::size_t markers = site.markers.size();
  fit.pose = frame.pose;
  fit.shift.assign(markers, {kNaN, kNaN});
  fit.shift_row.assign(markers, -1);
  fit.chi2.assign(markers, kNaN);
  fit.own_information.assign(markers, Eigen::Matrix2d::Zero());
  Unknowns out;
  out.patches.resize(markers), out.rows.resize(markers);
  for (std::size_t i = 0; i < markers; ++i) {
    if (!frame.points[i] || !site.markers[i].grating) continue;
    out.patches[i].emplace(*frame.points[i], site.markers[i]);
    if (frame.rows) {
      const PatchInformation by_columns = out.patches[i]->root().transpose();
      const auto columns = product_of_columns(by_columns, frame.rows->by_marker[i]);
      out.rows[i].emplace(ByRows{columns.leftCols<kMotionParameters>(), columns.col(kMotionParameters)});
    }
    out.references += site.markers[i].role == Role::kReference;
    fit.shift[i] = {0, 0};
    if (site.markers[i].role == Role::kReference || frame.at_rest) continue;
    fit.shift[i] = frame.shift[i];
    fit.shift_row[i] = 6 + 2 * out.shifts++;
  }
  if (frame.rows) {
    fit.motion = frame.motion;
    out.pose = kMaxPose;
  }
  return out;
}

// Returns the whitened design of a grating at the present unknowns.
PatchDesign design_of(const FrameFit& fit, std::size_t marker, const PatchResidual& residual, const Scene& scene,
                      Want want) {
  PatchDesign out;
  out.marker = marker;
  const CommonNumbers camera = numbers_of(scene);
  const TurnedPose pose(fit.pose);
  if (want == Want::kStep) {
    out.frame = residual.frame_design(camera, scene.markers[marker], pose, fit.shift[marker]);
    return out;
  }
  const auto all = residual.design(camera, scene.markers[marker], pose, fit.shift[marker]);
  out.scene = all.leftCols<kOwnParameters>();
  out.frame << all.middleCols<6>(PatchColumn::kPose), all.middleCols<2>(PatchColumn::kShape + MarkerShape::kX),
      all.col(PatchColumn::kResidual);
  return out;
}

// Returns the normal equations at the present unknowns, with those of the scene in the last pass. Sets chi2 and dof.
Normal equations_of(FrameFit& fit, const Unknowns& unknowns, const Scene& scene, const BundleFrame& frame, Want want) {
  const std::size_t markers = unknowns.patches.size();
  Normal n{PoseMatrix::Zero(unknowns.pose, unknowns.pose),
           PoseVector::Zero(unknowns.pose),
           PoseVector::Zero(unknowns.pose),
           {},
           {},
           {},
           {},
           {}};
  n.shifts.reserve(static_cast<std::size_t>(unknowns.shifts));
  if (want != Want::kStep) n.by_scene.setZero(unknowns.pose, scene_parameters(markers));
  if (want == Want::kScene && frame.rows) {
    n.scene_by_readout.setZero(scene_parameters(markers));
    n.scene_slope.setZero(scene_parameters(markers));
  }
  fit.chi2_sum = 0.0;
  fit.dof = -6 - 2 * unknowns.shifts;
  for (std::size_t i = 0; i < markers; ++i) {
    const auto& patch = unknowns.patches[i];
    if (!patch) continue;
    PatchDesign design = design_of(fit, i, *patch, scene, want);
    design.rows = unknowns.rows[i] ? &*unknowns.rows[i] : nullptr;
    if (design.rows != nullptr) design.frame.col(FrameColumn::kResidual) += design.rows->motion * fit.motion;
    ShiftNormal* shift = fit.shift_row[i] >= 0 ? &n.shifts.emplace_back() : nullptr;
    fit.own_information[i] = add_patch(n, design, shift);
    if (want != Want::kStep) add_scene(n, design, shift, want);
    fit.chi2[i] = design.frame.col(FrameColumn::kResidual).squaredNorm();
    fit.chi2_sum += fit.chi2[i];
    fit.dof += patch->rank();
  }
  if (frame.rows) {
    n.pose.bottomRightCorner<kMotionParameters, kMotionParameters>() += frame.rows->information;
    n.right.tail<kMotionParameters>() += frame.rows->information * fit.motion;
  }
  return n;
}

// Returns variances in the order of the rows: pose, shifts, motion. `pose`: covariance of pose and motion.
Eigen::VectorXd variances(const std::vector<ShiftPart>& parts, const PoseMatrix& pose) {
  const Eigen::Index motion = pose.rows() - 6;
  Eigen::VectorXd out(6 + 2 * static_cast<Eigen::Index>(parts.size()) + motion);
  out.head<6>() = pose.diagonal().head<6>();
  out.tail(motion) = pose.diagonal().tail(motion);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto by_pose = parts[k].by_pose.leftCols(pose.rows());
    const Eigen::Matrix2d all = parts[k].covariance + by_pose * pose * by_pose.transpose();
    out.segment<2>(6 + 2 * static_cast<Eigen::Index>(k)) = all.diagonal();
  }
  return out;
}

// Fills the rolling shutter's fields of the result. `inverse`: covariance of pose and motion. `still`: of the pose alone.
void conclude_rows(FrameFit& fit, const Normal& n, const RowDesign& rows, const PoseMatrix& inverse,
                   const PoseMatrix& still) {
  const Eigen::Index first = fit.variance.size() - kMotionParameters;
  fit.of_motion = Eigen::VectorXd::Zero(fit.variance.size());
  fit.of_motion.head(first) = (fit.variance.head(first) - variances(fit.shift_parts, still).head(first)).cwiseMax(0.0);
  PoseVector right = n.by_readout;
  for (std::size_t k = 0; k < n.shifts.size(); ++k)
    right += fit.shift_parts[k].by_pose.transpose() * n.shifts[k].by_readout;
  const PoseVector pose = -inverse * right;
  fit.by_readout.resize(fit.variance.size());
  fit.by_readout.head<6>() = pose.head<6>();
  fit.by_readout.tail<kMotionParameters>() = pose.tail<kMotionParameters>();
  double along = n.by_readout.dot(pose), slope = n.right.dot(pose);
  for (std::size_t k = 0; k < n.shifts.size(); ++k) {
    const ShiftPart& part = fit.shift_parts[k];
    const Eigen::Vector2d by = part.by_pose * pose - part.covariance * n.shifts[k].by_readout;
    fit.by_readout.segment<2>(6 + 2 * static_cast<Eigen::Index>(k)) = by;
    along += n.shifts[k].by_readout.dot(by), slope += n.shifts[k].right.dot(by);
  }
  fit.scene_slope = n.scene_slope;
  if (n.scene_by_readout.size() > 0) fit.scene_by_readout = n.scene_by_readout + n.by_scene.transpose() * pose;
  fit.readout_information = n.bb + along;
  fit.readout_slope = n.rb + slope;
  // Motion costs only the degrees of freedom that the gratings determine beyond its prior.
  const auto known = (rows.information * inverse.bottomRightCorner<kMotionParameters, kMotionParameters>()).trace();
  fit.dof -= std::lround(kMotionParameters - known);
}

PoseMatrix pose_inverse(const PoseMatrix& normal) { return inverse_of(normal); }

void conclude(FrameFit& fit, Normal n, const BundleFrame& frame) {
  const PoseMatrix reduced = without_shifts(n).pose;
  const PoseMatrix inverse = pose_inverse(reduced);
  fit.shift_parts.reserve(n.shifts.size());
  for (const ShiftNormal& s : n.shifts) {
    ShiftPart part;
    part.marker = s.marker;
    part.covariance = s.root.solve(Eigen::Matrix2d::Identity());
    part.by_own = -part.covariance * s.by_scene;
    part.by_pose = -part.covariance * s.across.transpose();
    fit.shift_parts.push_back(part);
  }
  fit.variance = variances(fit.shift_parts, inverse);
  fit.pose_sensitivity = -inverse * n.by_scene;
  if (frame.rows) conclude_rows(fit, n, *frame.rows, inverse, pose_inverse(reduced.topLeftCorner<6, 6>()));
  fit.pose_covariance = inverse;
  fit.by_scene = std::move(n.by_scene);
  fit.own_scene = std::move(n.own_scene);
}

}  // namespace

int scene_parameters(std::size_t markers) { return shape_row(markers, 0); }

FrameFit fit_frame(const Site& site, const Scene& scene, const BundleFrame& frame, FrameDetail detail) {
  FrameFit fit;
  const Unknowns unknowns = start(fit, site, frame);
  if (unknowns.references < 3) return fit;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double fall = take_step(fit, equations_of(fit, unknowns, scene, frame, Want::kStep));
    if (!(fall >= 0.0)) return fit;
    if (fall < kSettled) break;
  }
  const Want want = detail == FrameDetail::kScene ? Want::kScene : Want::kSamples;
  conclude(fit, equations_of(fit, unknowns, scene, frame, want), frame);
  fit.ok = std::isfinite(fit.chi2_sum);
  return fit;
}

namespace {

const ShiftPart& part_of(const FrameFit& fit, std::size_t marker) {
  return fit.shift_parts[static_cast<std::size_t>(fit.shift_row[marker] - 6) / 2];
}

}  // namespace

Eigen::Matrix2d shift_covariance(const FrameFit& fit, std::size_t marker) {
  const ShiftPart& part = part_of(fit, marker);
  return part.covariance + part.by_pose * fit.pose_covariance * part.by_pose.transpose();
}

Eigen::MatrixXd shift_sensitivity(const FrameFit& fit, std::size_t marker) {
  const ShiftPart& part = part_of(fit, marker);
  Eigen::MatrixXd out = part.by_pose * fit.pose_sensitivity;
  for (int k = 0; k < kOwnParameters; ++k) out.col(scene_column(marker, k)) += part.by_own.col(k);
  return out;
}

namespace {

// Returns the change of pose, shifts and motion per unit of pose and motion.
Eigen::MatrixXd all_by_pose(const FrameFit& fit) {
  const Eigen::Index poses = fit.pose_covariance.rows(), motion = poses - 6;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(fit.variance.size(), poses);
  out.topLeftCorner<6, 6>().setIdentity();
  out.bottomRightCorner(motion, motion).setIdentity();
  for (std::size_t k = 0; k < fit.shift_parts.size(); ++k)
    out.middleRows<2>(6 + 2 * static_cast<Eigen::Index>(k)) = fit.shift_parts[k].by_pose;
  return out;
}

}  // namespace

Eigen::MatrixXd full_covariance(const FrameFit& fit) {
  const Eigen::MatrixXd by_pose = all_by_pose(fit);
  Eigen::MatrixXd out = by_pose * fit.pose_covariance * by_pose.transpose();
  for (std::size_t k = 0; k < fit.shift_parts.size(); ++k) {
    const Eigen::Index row = 6 + 2 * static_cast<Eigen::Index>(k);
    out.block<2, 2>(row, row) += fit.shift_parts[k].covariance;
  }
  return out;
}

Eigen::MatrixXd full_sensitivity(const FrameFit& fit) {
  Eigen::MatrixXd out = all_by_pose(fit) * fit.pose_sensitivity;
  for (const ShiftPart& part : fit.shift_parts)
    out.middleRows<2>(fit.shift_row[part.marker]) = shift_sensitivity(fit, part.marker);
  return out;
}

void add_scene_information(const FrameFit& fit, Eigen::MatrixXd& information) {
  information.noalias() += fit.by_scene.transpose() * fit.pose_sensitivity;
  for (const OwnInformation& own : fit.own_scene) {
    for (int a = 0; a < kOwnParameters; ++a) {
      for (int b = 0; b < kOwnParameters; ++b)
        information(scene_column(own.marker, a), scene_column(own.marker, b)) += own.information(a, b);
    }
  }
}

Eigen::MatrixXd scene_covariance(const Site& site, std::span<const FrameFit> frames, const ScenePrior& prior,
                                 const SceneModel& model) {
  const int size = scene_parameters(site.markers.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (const FrameFit& f : frames) {
    if (f.ok) add_scene_information(f, information);
  }
  std::vector<int> used;
  const auto take = [&](int index, bool is_free, double u) {
    if (!is_free || !(u > 0.0)) return;
    information(index, index) += 1.0 / (u * u);
    used.push_back(index);
  };
  const auto common = free_common(model);
  const auto u_common = uncertainties_of(prior);
  for (int k = 0; k < kCommonParameters; ++k)
    take(k, common[static_cast<std::size_t>(k)], u_common[static_cast<std::size_t>(k)]);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const auto shape = free_shape(model, site.markers[i].role);
    for (int k = 0; k < kShapeParameters; ++k)
      take(shape_row(i, k), shape[static_cast<std::size_t>(k)], prior.u_markers[i].value[static_cast<std::size_t>(k)]);
  }
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd small(n, n);
  Eigen::VectorXd scale(n);
  for (Eigen::Index a = 0; a < n; ++a)
    scale(a) = 1.0 / std::sqrt(information(used[static_cast<std::size_t>(a)], used[static_cast<std::size_t>(a)]));
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b)
      small(a, b) =
          scale(a) * scale(b) * information(used[static_cast<std::size_t>(a)], used[static_cast<std::size_t>(b)]);
  }
  const Eigen::MatrixXd inverse = small.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b)
      covariance(used[static_cast<std::size_t>(a)], used[static_cast<std::size_t>(b)]) =
          scale(a) * scale(b) * inverse(a, b);
  }
  return covariance;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/patch_fit.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include <Eigen/Cholesky>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using Failure = PatchFitFailure;
using Field = Eigen::Matrix<double, kPatchPoints, 1>;
using BendColumns = Eigen::Matrix<double, 2 * kPatchPoints, 8>;
// A homography near the identity, in window coordinates: a0 a1 a2 b0 b1 b2 g h of
//     u + a0 + a1 u + a2 v - u (g u + h v),    v + b0 + b1 u + b2 v - v (g u + h v)
using Bend = Eigen::Matrix<double, 8, 1>;

// Chosen: with fewer pixels per unknown the residual is no estimate of the noise.
constexpr int kMinPixelsPerUnknown = 4;
// Limit of the last step, pitch. A fit that still moves by this much has found no grating. Chosen.
constexpr double kStillMoving = 0.1;
// Smallest variance that the template must explain per column, in sigma^2. Noise alone explains 1 +- 0.3. Chosen.
constexpr double kSeenPattern = 4.0;
// Limits of follow_patch, pitch. Passes with the normal equations of the reference frame leave a share of each step
// (share_left). They leave up to a hundredth of a change of blur and width, stated as the shift with an equal effect. A
// remainder that follows the camera distance does not average out over frames. 1e-5 pitch of it resembles 0.4 mm of
// depth at 8 m (decision 0042).
constexpr double kNear = 0.02;
constexpr double kLeft = 2e-5;
constexpr double kShapeConverged = 5e-4;
constexpr double kMaxFrozenStep = 0.002;  // beyond it, the frame's own normal equations are needed
// Upper bound of the share of a step that such a pass leaves. The second part is a row of pixels that enters or leaves
// at the window's edge, px. The third is a change of blur, relative to that of the fundamental's amplitude. They bound
// five simulated scenes: windows of 60 to 400 px, views of up to 40 deg, shares of up to 0.126 (decision 0053).
constexpr double kLeftAlways = 0.01, kLeftByEdge = 8.0, kLeftByBlur = 15.0;
// Step between blocks in the shift's pass before all rows. It only has to come near: noise of 1.6 in 80 grey levels
// leaves 1e-4 pitch. Chosen.
constexpr int kBlocksOfStart = 2;
constexpr int kMaxPasses = 3;  // for each kind; chosen

// Returns the matrix from a bend to its field at the nine points.
BendColumns made_bend_columns() {
  BendColumns columns = BendColumns::Zero();
  for (int n = 0; n < kPatchPoints; ++n) {
    const auto [u, v] = window_point(n);
    columns.row(n) << 1, u, v, 0, 0, 0, -u * u, -u * v;
    columns.row(kPatchPoints + n) << 0, 0, 0, 1, u, v, -u * v, -v * v;
  }
  return columns;
}

const BendColumns& bend_columns() {
  static const BendColumns columns = made_bend_columns();
  return columns;
}

// Returns the bend nearest to the correction (dx, dy) at the nine points, pitches, by least squares.
Bend bend_of(const PatchWindow& window, const Field& dx, const Field& dy) {
  static const Eigen::Matrix<double, 8, 2 * kPatchPoints> fit =
      (bend_columns().transpose() * bend_columns()).ldlt().solve(bend_columns().transpose());
  Eigen::Matrix<double, 2 * kPatchPoints, 1> field;
  field << dx / window.half_x, dy / window.half_y;
  return fit * field;
}

// Returns the grey level of the middle pixel. The first pass subtracts it, so that single precision sees small numbers.
double first_light(const LumaView& luma, const PixelBox& box) {
  const int x = (box.x0 + box.x1) / 2, y = (box.y0 + box.y1) / 2;
  return std::visit([x, y](const auto& picture) { return static_cast<double>(picture.at(x, y)); }, luma);
}

PrintFromImage bent_map(const PrintFromImage& map, const PatchWindow& window, const Bend& c) {
  Matrix3 change;
  change << 1.0 + c(1), c(2), c(0), c(4), 1.0 + c(5), c(3), c(6), c(7), 1.0;
  const auto to_window = window_from_print(window);
  return PrintFromImage(to_window.inverse().matrix() * change * to_window.matrix() * map.matrix());
}

// State of one fit over its passes: the map and the model's other parameters.
class Passes {
 public:
  Passes(const LumaView& luma, const PrintFromImage& start, const PatchToFit& patch)
      : luma_(luma), print_(patch.print), options_(patch.options), model_{start, patch.window} {}

  // Computes the pixel box of the window. Returns false if it leaves the image.
  [[nodiscard]] bool aim() {
    box_ = box_round(model_.map.inverse(), model_.window);
    return box_.x0 >= 0 && box_.y0 >= 0 && box_.x1 < width_of(luma_) && box_.y1 < height_of(luma_);
  }

  void begin(const PatchAtRest* at_rest) {
    if (at_rest == nullptr) {
      model_.light[0] = first_light(luma_, box_);
      return;
    }
    model_.light = at_rest->light;
    model_.contrast = model_.gain = at_rest->gain;
  }

  // Makes a pass over all rows. Without `known`, it computes normal equations with the contrast of the last pass.
  tl::expected<void, Failure> pass(const PatchSystem* known) {
    if (!aim()) return tl::unexpected(Failure::kOutsidePicture);
    if (known == nullptr && is_lit_) {
      for (double& part : model_.shape) part *= relative_;  // its unit contains the gain
      model_.gain = model_.contrast;
    }
    NormalMatrix normal;
    sums_ = sum_patch(luma_, model_, print_.nodes(), box_, known == nullptr ? &normal : nullptr);
    if (sums_.pixels < kMinPixelsPerUnknown * kColumns) return tl::unexpected(Failure::kTooFewPixels);
    if (known == nullptr) {
      own_ = PatchSystem::of(normal, sums_.pixels, options_);
      if (!own_) return tl::unexpected(Failure::kNoPattern);
    }
    return take(known == nullptr ? *own_ : *known);
  }

  // Fits a shift of the whole window (b0, g0, dX, dY) to these pixels.
  tl::expected<void, Failure> shift(const PixelSteps& steps) {
    if (!aim()) return tl::unexpected(Failure::kOutsidePicture);
    ShiftSums sums = sum_shift(luma_, model_, print_.nodes(), box_, steps);
    if (steps.rows * steps.blocks * sums.pixels < kMinPixelsPerUnknown * kColumns)
      return tl::unexpected(Failure::kTooFewPixels);
    Eigen::Matrix4d normal = sums.normal;
    for (const int axis : {2, 3}) {  // an axis that is not shown stays fixed
      if (axis == 2 ? options_.along_x : options_.along_y) continue;
      normal.row(axis).setZero(), normal.col(axis).setZero(), normal(axis, axis) = 1.0;
      sums.right(axis) = 0.0;
    }
    const Eigen::Vector4d per_length = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Eigen::Matrix4d> ldlt(per_length.asDiagonal() * normal * per_length.asDiagonal());
    const Eigen::Vector4d value = per_length.cwiseProduct(ldlt.solve(per_length.cwiseProduct(sums.right)));
    sums_.pixels = sums.pixels;
    sigma_ = std::sqrt(std::max(0.0, sums.left2 - value.dot(sums.right)) / (sums.pixels - kShiftColumns));
    const std::array<double, 2> place{value(2), value(3)};
    if (explained_by_print(value(1), place) < kSeenPattern * sigma_ * sigma_)
      return tl::unexpected(Failure::kNoPattern);
    model_.light[0] += value(0), model_.contrast[0] += value(1);
    if (!(model_.contrast[0] > 0.0)) return tl::unexpected(Failure::kNoPattern);
    relative_ = model_.gain[0] / model_.contrast[0];
    dx_.setConstant(relative_ * place[0]), dy_.setConstant(relative_ * place[1]);
    step_to_points();
    return {};
  }

  [[nodiscard]] double last_step() const { return last_step_; }
  // Returns true if the map's last step and the last change of shape leave less than they may. What the map cannot
  // take up stays in the field, the same in every pass, so that it is no step.
  [[nodiscard]] bool has_converged() const {
    return share_left() * last_bend_ < kLeft && shape_step_ < kShapeConverged;
  }
  [[nodiscard]] PatchAtRest at_rest() const { return {*own_, model_.light, model_.gain}; }
  [[nodiscard]] PatchFit fit(const PatchSystem* known) const;

 private:
  tl::expected<void, Failure> take(const PatchSystem& system) {
    const NormalVector value = system.solved(sums_);
    const double explained = value.dot(sums_.right);
    sigma_ = std::sqrt(std::max(0.0, sums_.left2 - explained) / (sums_.pixels - kColumns));
    const std::array<double, 2> place{value(kBaseColumns), value(kBaseColumns + kFieldColumns)};
    if (!is_lit_ && explained_by_print(value(3), place) < kSeenPattern * sigma_ * sigma_)
      return tl::unexpected(Failure::kNoPattern);
    is_lit_ = true;
    for (std::size_t k = 0; k < 3; ++k) {
      model_.light[k] += value(static_cast<Eigen::Index>(k));
      model_.contrast[k] += value(static_cast<Eigen::Index>(3 + k));
    }
    if (!(model_.contrast[0] > 0.0)) return tl::unexpected(Failure::kNoPattern);
    // The columns contain the earlier contrast.
    relative_ = model_.gain[0] / model_.contrast[0];
    for (std::size_t k = 0; k < model_.shape.size(); ++k)
      model_.shape[k] += value(static_cast<Eigen::Index>(kLightColumns + k));
    shape_step_ = relative_ * system.shift_like(value);
    const auto& at_points = values_at_points();
    dx_ = relative_ * (at_points * value.segment<kFieldColumns>(kBaseColumns));
    dy_ = relative_ * (at_points * value.tail<kFieldColumns>());
    step_to_points();
    return {};
  }

  void step_to_points() {
    last_step_ = std::max(dx_.cwiseAbs().maxCoeff(), dy_.cwiseAbs().maxCoeff());
    seen_through_ = model_.map;
    move();
  }

  // Returns the sum of squares that the template explains with this change of contrast and this shift (pitches). The
  // unit is grey levels^2 per column of the template.
  [[nodiscard]] double explained_by_print(double contrast, std::array<double, 2> place) const {
    const double level = std::pow((model_.contrast[0] + contrast) * print_.contrast(), 2);
    const double slope = std::pow(model_.gain[0] * place[0], 2) * print_.slope_power_x() +
                         std::pow(model_.gain[0] * place[1], 2) * print_.slope_power_y();
    return sums_.pixels * (level + slope) / (kColumns - 3);
  }

  // Moves the map by the homography nearest to the field. The next pass and the points keep the remainder.
  void move() {
    const PatchWindow& w = model_.window;
    const Bend bend = bend_of(w, dx_, dy_);
    const Eigen::Matrix<double, 2 * kPatchPoints, 1> field = bend_columns() * bend;
    last_bend_ = std::max(w.half_x * field.head<kPatchPoints>().cwiseAbs().maxCoeff(),
                          w.half_y * field.tail<kPatchPoints>().cwiseAbs().maxCoeff());
    model_.map = bent_map(model_.map, w, bend);
  }

  // Returns the largest share of a step that a pass with the normal equations of the reference frame leaves.
  [[nodiscard]] double share_left() const {
    const double width = std::min(box_.x1 - box_.x0, box_.y1 - box_.y0);
    const double blur = kTwoPi * kTwoPi * relative_ * std::max(std::abs(model_.shape[0]), std::abs(model_.shape[1]));
    return kLeftAlways + kLeftByEdge / width + kLeftByBlur * blur;
  }

  const LumaView& luma_;
  const PrintTemplate& print_;
  const PatchFitOptions& options_;
  PatchModel model_;
  PixelBox box_;
  PatchSums sums_;
  std::optional<PatchSystem> own_;
  bool is_lit_ = false;          // true if light and contrast are those of this frame
  PrintFromImage seen_through_;  // map of the last pass
  Field dx_, dy_;                // correction of the last pass at the nine points, pitches
  double last_bend_ = 0.0;       // the map's part of it, pitches
  double relative_ = 1.0, sigma_ = 0.0, last_step_ = 0.0;
  // Change of blur and width in the last pass, as the shift that changes the grey levels as much, pitches.
  double shape_step_ = 0.0;
};

PatchFit Passes::fit(const PatchSystem* known) const {
  const PatchSystem& system = known == nullptr ? *own_ : *known;
  PatchFit fit;
  const PatchWindow& w = model_.window;
  const auto back = seen_through_.inverse();
  for (int n = 0; n < kPatchPoints; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const PrintPoint p = grid_point(w, n);
    fit.image[i] = back(p);
    fit.print[i] = {p.x + dx_(n), p.y + dy_(n)};
  }
  fit.window_from_image = window_from_print(w) * seen_through_;
  fit.light = model_.light, fit.gain = model_.contrast;
  for (std::size_t a = 0; a < 2; ++a)
    fit.fundamental[a] = model_.contrast[0] * (1.0 - kTwoPi * kTwoPi * relative_ * model_.shape[a]);
  fit.sigma = sigma_;
  fit.last_step = last_step_;
  fit.pixels = sums_.pixels;
  if (sigma_ > 0.0) fit.information = system.information(sums_.pixels) / std::pow(relative_ * sigma_, 2);
  return fit;
}

// Fits with the frame's own normal equations. Windows of few pixels in few pitches need this: with those of the
// reference frame a corner does not converge. A fit that has not converged must not be used. Its residual is predicted
// from the step and can be far too small.
tl::expected<PatchFit, Failure> finish_with_own_equations(Passes& passes) {
  for (int k = 0; k < kMaxPasses; ++k) {
    if (const auto done = passes.pass(nullptr); !done) return tl::unexpected(done.error());
    if (passes.last_step() < kMaxFrozenStep) break;
  }
  if (!(passes.last_step() < kStillMoving)) return tl::unexpected(Failure::kNoPattern);
  return passes.fit(nullptr);
}

}  // namespace

tl::expected<FirstFit, Failure> fit_patch(const LumaView& luma, const PrintFromImage& start, const PatchToFit& patch) {
  Passes passes(luma, start, patch);
  if (!passes.aim()) return tl::unexpected(Failure::kOutsidePicture);
  passes.begin(nullptr);
  for (int k = 0; k < patch.options.passes; ++k) {
    if (const auto done = passes.pass(nullptr); !done) return tl::unexpected(done.error());
  }
  if (!(passes.last_step() < kStillMoving)) return tl::unexpected(Failure::kNoPattern);
  return FirstFit{passes.fit(nullptr), passes.at_rest()};
}

tl::expected<PatchFit, Failure> follow_patch(const LumaView& luma, const PrintFromImage& start, const PatchToFit& patch,
                                             const PatchAtRest& at_rest, Rows rows) {
  Passes passes(luma, start, patch);
  passes.begin(&at_rest);
  const PixelSteps steps{patch.options.row_step, rows == Rows::kAll ? kBlocksOfStart : 1};
  for (int k = 0; k < kMaxPasses; ++k) {
    if (const auto done = passes.shift(steps); !done) return tl::unexpected(done.error());
    if (passes.last_step() < (rows == Rows::kAll ? kNear : kMaxFrozenStep)) break;
  }
  for (int k = 0; rows == Rows::kAll && k < kMaxPasses; ++k) {
    if (const auto done = passes.pass(&at_rest.system); !done) return tl::unexpected(done.error());
    if (passes.has_converged()) break;
  }
  if (rows == Rows::kAll && !(passes.last_step() < kMaxFrozenStep)) return finish_with_own_equations(passes);
  if (!(passes.last_step() < kStillMoving)) return tl::unexpected(Failure::kNoPattern);
  return passes.fit(&at_rest.system);
}

PrintFromImage map_of(const PatchFit& fit, const PatchWindow& window) {
  Field dx, dy;
  for (int n = 0; n < kPatchPoints; ++n) {
    const PrintPoint at = grid_point(window, n), seen = fit.print[static_cast<std::size_t>(n)];
    dx(n) = seen.x - at.x, dy(n) = seen.y - at.y;
  }
  return bent_map(window_from_print(window).inverse() * fit.window_from_image, window, bend_of(window, dx, dy));
}

PixelBox box_round(const Homography<frame::Image, frame::Print>& image_from_print, const PatchWindow& w) {
  double x0 = 1e30, x1 = -1e30, y0 = 1e30, y1 = -1e30;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const ImagePoint p = image_from_print({w.centre.x + sx * w.half_x, w.centre.y + sy * w.half_y});
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    }
  }
  constexpr double kFar = 1e6;
  const auto whole = [kFar](double v) { return static_cast<int>(std::clamp(v, -kFar, kFar)); };
  return {whole(std::floor(x0)) - 1, whole(std::floor(y0)) - 1, whole(std::ceil(x1)) + 1, whole(std::ceil(y1)) + 1};
}

}  // namespace moiregauge::internal

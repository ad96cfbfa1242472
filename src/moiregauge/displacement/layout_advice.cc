// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/layout_advice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "moiregauge/calibration/scene/out_of_plane.h"
#include "moiregauge/planning/layout_bound.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Ratio of the bounds of both axes above which the user is warned. The cause is the layout, because a grating shows
// both axes alike. Chosen.
constexpr double kWeak = 2.5;
// Movement of the camera below which all frames show the gratings alike, so the lens bends them alike. Chosen.
constexpr double kHardlyTurns_deg = 0.25;
constexpr double kHardlyGoes = 0.005;  // relative to the camera's distance
constexpr Eigen::Index kK1 = 3;        // index of k1 among the camera's parameters

struct Span {
  double x = 0.0, y = 0.0;  // mm
};

Span references_span(const Site& site) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  BoardPoint low{kFar, kFar}, high{-kFar, -kFar};
  for (const Marker& marker : site.markers) {
    if (marker.role != Role::kReference) continue;
    const BoardPoint p = marker.grating ? marker.grating->centre : marker.circle->centre;
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return {high.x - low.x, high.y - low.y};
}

}  // namespace

std::optional<std::string> weak_axis_note(const Reference& reference) {
  double worst = kWeak;
  std::optional<std::size_t> target;
  Extent<frame::Board> u;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (reference.site.markers[i].role != Role::kTarget || !reference.site.markers[i].grating) continue;
    const auto bound = layout_bound(reference, i, Bound::kFull);
    const double ratio = std::max(bound.x / bound.y, bound.y / bound.x);
    if (ratio > worst) worst = ratio, target = i, u = bound;
  }
  if (!target) return std::nullopt;
  const Span span = references_span(reference.site);
  const bool is_flat = span.y < span.x;
  return fmt::format(
      "note: {} of target '{}' is at least {:.2g} um ({} {:.2g} um), because the references span only {:.2g} of their "
      "{} in {}. Move two references further {}",
      is_flat ? "u_dx" : "u_dy", reference.site.markers[*target].name, 1000.0 * (is_flat ? u.x : u.y),
      is_flat ? "u_dy" : "u_dx", 1000.0 * (is_flat ? u.y : u.x), is_flat ? span.y / span.x : span.x / span.y,
      is_flat ? "width" : "height", is_flat ? "height" : "width", is_flat ? "up or down" : "to the side");
}

std::optional<std::string> stretched_prints_note(const Site& site, const Calibration& calibration) {
  const double stretch = calibration.bundle.scene.stretch;
  if (!calibration.stretched) return std::nullopt;
  return fmt::format(
      "u includes {:.2g} % of the displacement: the gratings are {:.2f} % {} along x than along y (print scale known "
      "to {:.2g} %). Measure the rulers along both axes and give --print-scale",
      50.0 * std::abs(stretch), 100.0 * std::abs(stretch), stretch > 0.0 ? "longer" : "shorter",
      100.0 * site.known_to.print_scale);
}

std::optional<std::string> still_camera_note(const Scene& scene, std::span<const BundleFrame> frames) {
  std::array<double, 3> turns{}, goes{};
  const Pose& first = frames.front().pose;
  for (const BundleFrame& frame : frames) {
    for (std::size_t k = 0; k < 3; ++k) {
      turns[k] = std::max(turns[k], std::abs(frame.pose.turn[k] - first.turn[k]));
      goes[k] = std::max(goes[k], std::abs(frame.pose.shift[k] - first.shift[k]));
    }
  }
  const double turn_deg = std::hypot(turns[0], turns[1], turns[2]) * 360.0 / kTwoPi;
  if (turn_deg > kHardlyTurns_deg || std::hypot(goes[0], goes[1], goes[2]) > kHardlyGoes * std::abs(first.shift[2]))
    return std::nullopt;
  const std::string lens = scene.model.radial ? fmt::format(" (k1 {:.2g}, u {:.2g})", scene.camera.k1,
                                                            std::sqrt(scene.stated_covariance()(kK1, kK1)))
                                              : "";
  return fmt::format(
      "note: displacements are reliable, but do not reuse this run's lens{}: the camera hardly moved ({:.2g} deg). To "
      "calibrate a lens, move the camera on purpose",
      lens, turn_deg);
}

namespace {

// Largest change of a removed movement since the reference frame, along each axis.
struct LargestMovement {
  Eigen::Vector4d change = Eigen::Vector4d::Zero();
  const BundleFrame* highest = nullptr;  // frame of the largest height; null: no height was removed
};

LargestMovement largest_movement(std::span<const BundleFrame> frames, std::size_t marker) {
  LargestMovement most;
  for (const BundleFrame& frame : frames) {
    if (frame.removed.empty() || frames.front().removed.empty()) continue;
    const Eigen::Vector4d moved = (frame.removed[marker] - frames.front().removed[marker]).cwiseAbs();
    if (moved(MovementAxis::kHeight) > most.change(MovementAxis::kHeight)) most.highest = &frame;
    most.change = most.change.cwiseMax(moved);
  }
  return most;
}

// Returns the standard uncertainty of a target's largest height, mm. `noise_mm`: that by noise of one frame.
double u_of_height(const BundleSolution& solved, const LargestMovement& most, std::size_t marker, double noise_mm) {
  if (most.highest == nullptr) return std::sqrt(2.0) * noise_mm;
  const BundleFrame &now = *most.highest, &then = solved.frames.front();
  const Eigen::Vector3d turned = (now.removed[marker] - then.removed[marker]).tail<3>();
  const double u_size_mm = u_of_size(now.pose, then.pose, turned) * now.pose.shift[2];
  const Eigen::MatrixXd& covariance = solved.scene.stated_covariance();
  const double u_focal = covariance.size() > 0 ? std::sqrt(covariance(0, 0)) / solved.scene.camera.fx : 0.0;
  return std::hypot(std::sqrt(2.0) * noise_mm, u_size_mm, u_focal * most.change(MovementAxis::kHeight));
}

}  // namespace

std::vector<std::string> movement_notes(const Site& site, const MovementRemoval& removal,
                                        const BundleSolution& solved) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const TargetMovement& movement = removal.movement(i);
    const LargestMovement largest = largest_movement(solved.frames, i);
    const Eigen::Vector4d &most = largest.change, u = std::sqrt(2.0) * movement.u;
    if (movement.leaves_plane())
      out.push_back(
          fmt::format("note: '{}' moves towards or away from the camera, by up to {:.3g} mm (u {:.2g} mm). Its "
                      "displacement is corrected for it",
                      site.markers[i].name, most(MovementAxis::kHeight),
                      u_of_height(solved, largest, i, movement.u(MovementAxis::kHeight))));
    if (!movement.rotates()) continue;
    const RotationCentre& centre = removal.centre(i);
    const std::string point = centre.is_middle
                                  ? "the middle of its grating"
                                  : fmt::format("its grating_mm, known to {:.2g} mm on the print", centre.u_mm);
    out.push_back(fmt::format(
        "note: '{}' rotates, in its plane by up to {:.3g} mrad (u {:.2g} mrad). Its displacement is that of {}. Points "
        "100 mm from there move by up to {:.2g} mm more",
        site.markers[i].name, 1e3 * most(MovementAxis::kInPlane), 1e3 * u(MovementAxis::kInPlane), point,
        100.0 * most(MovementAxis::kInPlane)));
  }
  return out;
}

}  // namespace moiregauge::internal

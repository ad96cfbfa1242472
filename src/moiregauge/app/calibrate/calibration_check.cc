// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/calibrate/calibration_check.h"

#include <algorithm>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

// Relative u of f: above it f is poorly determined, and so is an angle measured with it.
constexpr double kPoorlyKnown = 0.02;  // (chosen)
// u of the principal point, relative to the larger side of the image (chosen). Above the first limit it is poorly
// determined. Above the second it could be anywhere in the image, and the solution is meaningless.
constexpr double kPoorCentre = 0.05, kUnknownCentre = 0.2;
constexpr double kUnknownFocalShare = 0.5;  // relative u of f: the same for the focal length
// Largest ratio of residuals with the common camera to those with a camera of the view's own. Views of one camera reach
// 2.0 (bent boards and prints of the real sets), views of mixed cameras more.
constexpr double kMaxMisfitRatio = 3.0;

struct Centre {
  const char* name;
  double u;  // px
};
Centre worse_centre(const BoardCalibration& s) {
  return s.u[1] >= s.u[2] ? Centre{"cx", s.u[1]} : Centre{"cy", s.u[2]};
}

double larger_side(const Camera& camera) { return std::max(camera.width, camera.height); }

std::vector<std::string> misfits_of(const CalibrateReport& report) {
  std::vector<std::string> names;
  for (std::size_t v = 0; v < report.solved.views.size(); ++v) {
    const CalibratedView& view = report.solved.views[v];
    if (view.excluded.empty() && view.misfit_ratio > kMaxMisfitRatio) names.push_back(report.names[v]);
  }
  return names;
}

std::size_t used_of(const BoardCalibration& s) {
  return static_cast<std::size_t>(
      std::count_if(s.views.begin(), s.views.end(), [](const CalibratedView& v) { return v.excluded.empty(); }));
}

}  // namespace

std::optional<std::string> calibrate_refusal(const CalibrateReport& report, const std::string& photos) {
  const BoardCalibration& s = report.solved;
  if (used_of(s) < 2)
    return fmt::format(
        "one photograph does not determine a camera: {} ({} given, 1 usable): give five to fifteen photographs of one "
        "board, tilted to each side",
        photos, s.views.size());
  if (const auto misfits = misfits_of(report); 3 * misfits.size() >= used_of(s))
    return fmt::format(
        "the photographs do not fit one camera: {} and {} of {} others: give photographs of one camera with fixed "
        "focus and zoom",
        misfits.front(), misfits.size() - 1, used_of(s) - 1);
  if (s.u[0] > kUnknownFocalShare * s.camera.fx)
    return fmt::format(
        "the photographs do not determine the focal length: {} (u is {:.0f} % of it): add photographs with the board "
        "tilted by 30 to 45 degrees, each to another side",
        photos, 100.0 * s.u[0] / s.camera.fx);
  if (const Centre c = worse_centre(s); c.u > kUnknownCentre * larger_side(s.camera))
    return fmt::format(
        "the photographs do not determine the principal point: {} (u of {} is {:.0f} px): add photographs with the "
        "board tilted by 30 to 45 degrees, each to another side",
        photos, c.name, c.u);
  if (const auto fold = s.camera.fold_px(); fold && s.k3)
    return fmt::format(
        "the solved lens folds inside the image: {} (k3, {:.0f} px from the principal point): remove --k3, or "
        "photograph the board in the image corners",
        photos, *fold);
  return std::nullopt;
}

std::vector<std::string> calibrate_warnings(const CalibrateReport& report) {
  const BoardCalibration& s = report.solved;
  std::vector<std::string> out;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    if (!s.views[v].excluded.empty())
      out.push_back(fmt::format("the photograph {} was not used: {}", report.names[v], s.views[v].excluded));
  }
  if (s.u[0] > kPoorlyKnown * s.camera.fx)
    out.push_back(
        fmt::format("the focal length is uncertain (u is {:.0f} % of it). Add photographs with the board tilted by 30 "
                    "to 45 degrees, each to another side",
                    100.0 * s.u[0] / s.camera.fx));
  if (const Centre c = worse_centre(s); c.u > kPoorCentre * larger_side(s.camera))
    out.push_back(
        fmt::format("the principal point is uncertain (u of {} is {:.0f} px). Add photographs with the board tilted by "
                    "30 to 45 degrees, each to another side",
                    c.name, c.u));
  if (const auto fold = s.camera.fold_px(); fold && !s.k3)
    out.push_back(fmt::format(
        "the camera is usable only within {:.0f} px of its principal point, where the solved lens folds. Add "
        "photographs with the board in the image corners",
        *fold));
  for (const std::string& name : misfits_of(report))
    out.push_back(
        fmt::format("the solved camera may be wrong: {} does not fit it (bent board or another camera). Check this "
                    "photograph or remove it",
                    name));
  return out;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/calibrate_text.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "moiregauge/io/config/camera_file.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::cli {
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

struct Parameter {
  const char* name;
  double value;
  double u;
  bool is_held;  // not needed, or not requested
};

std::array<Parameter, kCameraParameters> parameters_of(const BoardCalibration& s) {
  const Camera& c = s.camera;
  const bool r = !s.model.radial, t = !s.model.tangential;
  return {{{"f", c.fx, s.u[0], false},
           {"cx", c.cx, s.u[1], false},
           {"cy", c.cy, s.u[2], false},
           {"k1", c.k1, s.u[3], r},
           {"k2", c.k2, s.u[4], r},
           {"p1", c.p1, s.u[5], t},
           {"p2", c.p2, s.u[6], t},
           {"k3", c.k3, s.u[7], !s.k3}}};
}

// Formats the value with the digits of its uncertainty, which has two significant ones.
std::string with_u(const Parameter& p) {
  const int digits = p.u > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(p.u))), 0, 9) : 5;
  return fmt::format("{:>12.{}f}   u {:.{}f}{}", p.value, digits, p.u, digits,
                     p.is_held ? "   (not needed, fixed at 0)" : "");
}

std::string view_line(const std::string& name, const CalibratedView& v, std::size_t width) {
  if (!v.left_out.empty()) return fmt::format("{:<{}}  not used: {}\n", name, width, v.left_out);
  return fmt::format("{:<{}}  {:>5.1f} {:>8.3f} {:>9.3f} {:>7.3f} {:>10.3f} {:>7.3f}{}\n", name, width,
                     v.tilt_rad * 180.0 / kPi, v.rms_px, v.null.corners_seen, v.null.corners, v.null.lattice_seen,
                     v.null.lattice, v.outliers > 0 ? fmt::format("   {} points not used", v.outliers) : "");
}

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
    if (view.left_out.empty() && view.misfit_ratio > kMaxMisfitRatio) names.push_back(report.names[v]);
  }
  return names;
}

std::size_t used_of(const BoardCalibration& s) {
  return static_cast<std::size_t>(
      std::count_if(s.views.begin(), s.views.end(), [](const CalibratedView& v) { return v.left_out.empty(); }));
}

}  // namespace

std::string calibrate_text(const CalibrateReport& report) {
  const BoardCalibration& s = report.solved;
  std::string text = fmt::format("found: {}, {} points in {} of {} photographs of {} x {} px\n", report.pattern,
                                 s.points, used_of(s), s.views.size(), s.camera.width, s.camera.height);
  text += fmt::format("model: pinhole{}{}{}\n", s.model.radial ? " + radial" : "",
                      s.model.tangential ? " + tangential" : "", s.k3 ? " + k3" : "");
  for (const Parameter& p : parameters_of(s)) {
    if (p.u > 0.0 || !p.is_held) text += fmt::format("  {:<3}{}\n", p.name, with_u(p));
  }
  text += fmt::format("reprojection error: {:.3f} px rms (scatter: {:.3f} px per point", s.rms_px, s.point_px);
  if (s.print_mm > 0.0) text += fmt::format(", {:.4f} mm of the print, the same in {} views", s.print_mm, s.matched);
  text += fmt::format(", {:.3f} px per ninth of the board)\n", s.patch_px);
  std::size_t width = 4;
  for (const std::string& name : report.names) width = std::max(width, name.size());
  text += fmt::format("{:<{}}   tilt  rms, px   four corners, px    lattice, px\n", "", width);
  text += fmt::format("{:<{}}    deg             lens in     out    lens in     out\n", "view", width);
  for (std::size_t v = 0; v < s.views.size(); ++v) text += view_line(report.names[v], s.views[v], width);
  return text;
}

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
        "the solved lens folds inside the image: {} (k3, {:.0f} px from the principal point): remove --k3, or add "
        "photographs with the board in the image corners",
        photos, *fold);
  return std::nullopt;
}

std::vector<std::string> calibrate_warnings(const CalibrateReport& report) {
  const BoardCalibration& s = report.solved;
  std::vector<std::string> out;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    if (!s.views[v].left_out.empty())
      out.push_back(fmt::format("the photograph {} was not used: {}", report.names[v], s.views[v].left_out));
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

std::string camera_text(const CalibrateReport& report) { return write_camera(report.solved.camera, report.solved.u); }

}  // namespace moiregauge::internal::cli

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
  if (!v.excluded.empty()) return fmt::format("{:<{}}  not used: {}\n", name, width, v.excluded);
  return fmt::format("{:<{}}  {:>5.1f} {:>8.3f} {:>9.3f} {:>7.3f} {:>10.3f} {:>7.3f}{}\n", name, width,
                     v.tilt_rad * 180.0 / kPi, v.rms_px, v.null.corners_seen, v.null.corners, v.null.lattice_seen,
                     v.null.lattice, v.outliers > 0 ? fmt::format("   {} points not used", v.outliers) : "");
}

std::size_t used_of(const BoardCalibration& s) {
  return static_cast<std::size_t>(
      std::count_if(s.views.begin(), s.views.end(), [](const CalibratedView& v) { return v.excluded.empty(); }));
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

std::string camera_text(const CalibrateReport& report) { return write_camera(report.solved.camera, report.solved.u); }

}  // namespace moiregauge::internal::cli

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/truth_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iterator>

#include <fmt/format.h>

#include "moiregauge/io/config/toml_text.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

using simulator::Scenario;
using simulator::Track;

// Formats with 1e-8 mm resolution: two digits more than a nanometre. Minus zero becomes zero.
std::string millimetres(double value) {
  const std::string text = fmt::format("{:.8f}", value);
  return text == "-0.00000000" ? text.substr(1) : text;
}

std::string per_frame(const char* key, const Scenario& scenario, const Track& x, const Track& y, const Track& z) {
  std::string text = fmt::format("{} = [\n", key);
  for (long frame = 0; frame < scenario.frames; ++frame) {
    const double now = simulator::time_of(scenario, frame);
    text += fmt::format("  [{:.9f}, {:.9f}, {:.9f}],\n", x.at(now), y.at(now), z.at(now));
  }
  return text + "]\n";
}

}  // namespace

std::string truth_csv(const Scenario& scenario) {
  std::string text = "frame,time_s,marker,dx_mm,dy_mm\n";
  for (long frame = 0; frame < scenario.frames; ++frame) {
    for (const simulator::SceneMarker& marker : scenario.markers) {
      const bool moves = marker.dx.moves() || marker.dy.moves();
      if (!marker.listed || (marker.print.role == Role::kReference && !moves)) continue;
      const simulator::Truth truth = simulator::truth(scenario, frame, marker);
      const double since_first = simulator::time_of(scenario, frame) - simulator::time_of(scenario, 0);
      fmt::format_to(std::back_inserter(text), "{},{:.6f},{},{},{}\n", frame, since_first, marker.print.name,
                     millimetres(truth.dx_mm), millimetres(truth.dy_mm));
    }
  }
  return text;
}

std::string truth_camera_toml(const Scenario& scenario) {
  const simulator::Camera& c = scenario.camera;
  const simulator::Mount& m = scenario.mount;
  std::string text = "# Lengths in millimetres, angles in degrees. Camera: x right, y down, z forward.\n[camera]\n";
  text += fmt::format("width = {}\nheight = {}\nfx = {}\nfy = {}\ncx = {}\ncy = {}\n", c.width, c.height,
                      toml_real(c.fx), toml_real(c.fy), toml_real(c.cx), toml_real(c.cy));
  text += fmt::format("k1 = {}\nk2 = {}\np1 = {}\np2 = {}\nk3 = {}\n", toml_real(c.k1), toml_real(c.k2),
                      toml_real(c.p1), toml_real(c.p2), toml_real(c.k3));
  text += "\n# X_cam = Rx Ry Rz (X - pivot) + pivot + shift, in the middle of each frame's exposure.\n[truth]\n";
  text += fmt::format("distance_mm = {}\nboard_deg = [{}, {}, {}]\npivot_mm = [{}, {}, {}]\n", toml_real(m.distance_mm),
                      toml_real(m.board_x_deg), toml_real(m.board_y_deg), toml_real(m.board_z_deg),
                      toml_real(m.pivot_x_mm), toml_real(m.pivot_y_mm), toml_real(m.pivot_z_mm));
  text += per_frame("rotation_deg", scenario, m.rotation_x, m.rotation_y, m.rotation_z);
  if (m.shift_x.moves() || m.shift_y.moves() || m.shift_z.moves()) {
    text += per_frame("shift_mm", scenario, m.shift_x, m.shift_y, m.shift_z);
  } else {
    text += fmt::format("shift_mm = [[{}, {}, {}]]\n", toml_real(m.shift_x.at(0)), toml_real(m.shift_y.at(0)),
                        toml_real(m.shift_z.at(0)));
  }
  const simulator::Optics& o = scenario.optics;
  if (o.zoom.moves() || o.shift_x.moves() || o.shift_y.moves()) {
    text += "# Per frame: zoom relative to fx and fy, shift x (px), shift y (px).\n" +
            per_frame("zoom_shift", scenario, o.zoom, o.shift_x, o.shift_y);
  }
  return text;
}

tl::expected<void, std::string> write_text(const std::string& path, const std::string& text) {
  const std::string unfinished = path + ".part";
  std::FILE* file = std::fopen(unfinished.c_str(), "wb");
  const bool wrote = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const bool closed = file != nullptr && std::fclose(file) == 0;
  if (wrote && closed && std::rename(unfinished.c_str(), path.c_str()) == 0) return {};
  const std::string why = std::strerror(errno);
  if (file != nullptr) std::remove(unfinished.c_str());
  return tl::unexpected(fmt::format("{}: {}", path, why));
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/patch_rows.h"

namespace moiregauge {

RowField field_on(const PatchMap& map, double v) {
  RowField f;
  for (std::size_t i = 0; i < 3; ++i) {
    f.dx[i] = map.dx[i] + v * (map.dx[3 + i] + v * map.dx[6 + i]);
    f.dy[i] = map.dy[i] + v * (map.dy[3 + i] + v * map.dy[6 + i]);
  }
  return f;
}

RowMap row_map(const PatchJob& job, const RowField& f, double x, double y) {
  const Matrix3& h = job.h;
  const double u = (x - job.map.x0) / job.map.scale, per_px = 1.0 / job.map.scale, side = job.nodes->side;
  const double z = 1.0 / (h(2, 0) * x + h(2, 1) * y + h(2, 2)), bend = -h(2, 0) * z;
  const double px = (h(0, 0) * x + h(0, 1) * y + h(0, 2)) * z, py = (h(1, 0) * x + h(1, 1) * y + h(1, 2)) * z;
  const double slope_x = h(0, 0) * z + px * bend, slope_y = h(1, 0) * z + py * bend;
  RowMap row;
  row.x = {static_cast<float>(side * (px + f.dx[0] + u * (f.dx[1] + u * f.dx[2]))),
           static_cast<float>(side * (slope_x + per_px * (f.dx[1] + 2.0 * u * f.dx[2]))),
           static_cast<float>(side * (slope_x * bend + per_px * per_px * f.dx[2]))};
  row.y = {static_cast<float>(side * (py + f.dy[0] + u * (f.dy[1] + u * f.dy[2]))),
           static_cast<float>(side * (slope_y + per_px * (f.dy[1] + 2.0 * u * f.dy[2]))),
           static_cast<float>(side * (slope_y * bend + per_px * per_px * f.dy[2]))};
  const double v = (y - job.map.y0) / job.map.scale;
  const auto plane = [&](const std::array<double, 3>& c) {
    return std::array{static_cast<float>(c[0] + c[1] * u + c[2] * v), static_cast<float>(c[1] * per_px)};
  };
  row.light = plane(job.map.light);
  row.contrast = plane(job.map.contrast);
  row.gain = plane(job.map.gain);
  for (float& g : row.gain) g *= static_cast<float>(side);
  return row;
}

}  // namespace moiregauge

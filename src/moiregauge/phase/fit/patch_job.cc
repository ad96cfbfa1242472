// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/patch_job.h"

namespace moiregauge::internal {
namespace {

std::array<float, 3> in_floats(const PatchPlane& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

}  // namespace

PatchJob job_of(const PatchModel& model, const PrintNodes& nodes, const PixelBox& box, const PixelSteps& steps) {
  PatchJob job;
  job.x = (box.x0 + box.x1) / 2, job.y = (box.y0 + box.y1) / 2;
  const PatchWindow& w = model.window;
  Matrix3 from_middle;
  from_middle << 1, 0, job.x, 0, 1, job.y, 0, 0, 1;
  const Matrix3 h = window_from_print(w).matrix() * model.map.matrix() * from_middle;
  for (int i = 0; i < 9; ++i)
    job.uv_from_px[static_cast<std::size_t>(i)] = static_cast<float>(h(i / 3, i % 3) / h(2, 2));
  job.light = in_floats(model.light), job.contrast = in_floats(model.contrast), job.gain = in_floats(model.gain);
  job.shape = in_floats(model.shape);
  const double side = nodes.side;
  job.nodes = {static_cast<float>(side * w.centre.x), static_cast<float>(side * w.half_x),
               static_cast<float>(side * w.centre.y), static_cast<float>(side * w.half_y)};
  job.table = &nodes;
  job.box = box;
  job.steps = steps;
  return job;
}

}  // namespace moiregauge::internal

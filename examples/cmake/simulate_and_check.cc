// SPDX-License-Identifier: Apache-2.0
// Simulates a recording through a lens of one's own, and compares the plan with the measured uncertainty.
#include <cmath>
#include <cstdio>

#include <moiregauge/moiregauge.h>

int main() {
  using namespace moiregauge::literals;
  auto rig =
      moiregauge::Simulation::load("small-1xyz", {.settings = {"lens.k1=-0.1"}, .frames = 20, .markers_only = true});
  if (!rig) return std::fprintf(stderr, "error: %s\n", rig.error().message.c_str()), 1;
  const auto planned =
      moiregauge::plan({.site = rig->site(),
                        .camera = {.width = 1024, .height = 512, .fx = 3478, .fy = 3478, .cx = 511.5, .cy = 255.5},
                        .distance = 1.2_m});
  auto tracker = moiregauge::Tracker::create({.site = rig->site()});
  if (!planned || !tracker) return 1;
  double sum = 0.0, u = 0.0;
  for (long n = 0; n < rig->frames(); ++n) {
    const auto frame = tracker->update(rig->render(n), static_cast<double>(n) / rig->fps());
    if (!frame) return 1;
    const double error = frame->samples[0].dy_mm - rig->truth(n, "mid")->dy_mm;
    sum += error * error;
    u = frame->samples[0].u_dy_mm;
  }
  const double rms = std::sqrt(sum / static_cast<double>(rig->frames() - 1));
  std::printf("rms error %.5f mm, u stated %.5f mm, u planned %.5f mm\n", rms, u, planned->front().u_dy_mm);
  return rms < 3.0 * u ? 0 : 1;
}

// SPDX-License-Identifier: Apache-2.0
// Renders a drawn recording: frames as PNG, and truth.csv.
//   world DRAW_FILE OUT_DIR
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <stdexcept>
#include <string>

#include "studies/world/exposure.h"
#include "studies/world/sensor.h"

namespace {

using namespace world;

// Returns a target's mean position over one exposure of a sensor row, mm.
Vec3 mean_position(const Exposure& exposure, const Sheet& sheet, int frame, double row) {
  const auto times = exposure.times(frame, row);
  Vec3 sum;
  for (const double time_s : times) sum = sum + sheet.placement(time_s).origin_mm;
  return (1.0 / static_cast<double>(times.size())) * sum;
}

// Writes the positions of the targets relative to their position in frame 0.
// The frame's time is the exposure of the middle row: dx_mm, dy_mm.
// The exposure of the target's own row differs with a rolling shutter: row_dx_mm, row_dy_mm.
void write_truth(const Exposure& exposure, int frames, double fps, const std::string& path) {
  std::ofstream out(path);
  out << std::fixed << std::setprecision(7) << "frame,time_s,marker,dx_mm,dy_mm,row_dx_mm,row_dy_mm,dz_mm,x_px,y_px\n";
  const double middle = 0.5 * (exposure.camera().height() - 1);
  for (int frame = 0; frame < frames; ++frame) {
    for (const Sheet& sheet : exposure.sheets()) {
      if (!sheet.is_target()) continue;
      const Vec3 at = mean_position(exposure, sheet, frame, middle);
      const Ray pixel = exposure.pixel_of(at, frame / fps),
                pixel_0 = exposure.pixel_of(mean_position(exposure, sheet, 0, middle), 0.0);
      const Vec3 d = at - mean_position(exposure, sheet, 0, middle);
      const Vec3 r = mean_position(exposure, sheet, frame, pixel.y) - mean_position(exposure, sheet, 0, pixel_0.y);
      out << frame << ',' << frame / fps << ',' << sheet.name() << ',' << d.x << ',' << d.y << ',' << r.x << ',' << r.y
          << ',' << d.z << ',' << pixel.x << ',' << pixel.y << '\n';
    }
  }
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

void render(const std::string& draw_path, const std::string& folder) {
  const DrawFile draw(draw_path);
  const Exposure exposure(draw);
  Sensor sensor(draw);
  const int frames = static_cast<int>(draw.number("frames"));
  std::filesystem::create_directories(folder + "/frames");
  for (int frame = 0; frame < frames; ++frame) {
    char name[32];
    std::snprintf(name, sizeof name, "/frames/%06d.png", frame);
    write_png(folder + name, sensor.levels(exposure.frame(frame)), exposure.camera().width(), sensor.bits());
  }
  write_truth(exposure, frames, draw.number("fps"), folder + "/truth.csv");
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fputs("usage: world DRAW_FILE OUT_DIR\n", stderr);
    return 2;
  }
  try {
    render(words[1], words[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
  return 0;
}

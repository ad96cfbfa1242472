// SPDX-License-Identifier: Apache-2.0
// The light that a frame collects: rays through every pixel, averaged over the exposure, then blurred by the lens.
#pragma once

#include <vector>

#include "studies/world/draw.h"
#include "studies/world/optics.h"
#include "studies/world/prints.h"

namespace world {

// Grey values in row order, relative to a white sheet in full light.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> values;
  Picture(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  [[nodiscard]] float* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  [[nodiscard]] const float* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

// Lamps and sun: a gradient across the board, a soft shadow that moves, and flicker.
class Light {
 public:
  explicit Light(const DrawFile& draw);
  [[nodiscard]] double at(double x_mm, double y_mm, double time_s) const;
  [[nodiscard]] double flicker(double time_s) const;

 private:
  double gradient_x_, gradient_y_, flicker_share_, flicker_hz_, shadow_depth_, shadow_cos_, shadow_sin_,
      shadow_width_mm_;
  Track shadow_mm_;
};

// Renders the frames of one recording. Sheets are sampled 4 x 4 times per pixel, the wall far from them once.
class Exposure {
 public:
  explicit Exposure(const DrawFile& draw);
  [[nodiscard]] Picture frame(int number) const;
  // Returns the times of the samples of one exposure. The row is that of the sensor, in px.
  [[nodiscard]] std::vector<double> times(int number, double row) const;
  [[nodiscard]] const std::vector<Sheet>& sheets() const { return sheets_; }
  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] Ray pixel_of(const Vec3& board_mm, double time_s) const;

 private:
  struct Window {
    int left, top, right, bottom;  // px, right and bottom excluded
    std::vector<std::size_t> sheets;
  };
  struct Seen;  // what a row of pixels sees at one time
  [[nodiscard]] std::vector<Window> windows(int number) const;
  [[nodiscard]] Seen seen(const Window& window, double time_s) const;
  [[nodiscard]] double radiance(const Seen& seen, const Ray& ray) const;
  void render_row(const Seen& seen, int row, Picture& fine, const Window& area) const;
  void render_window(const Window& window, int number, Picture& out) const;
  [[nodiscard]] double defocus_px(const Window& window, int number) const;
  [[nodiscard]] double vignetting(const Ray& ray) const;

  static constexpr int kSub = 4;  // samples along each side of a pixel
  Camera camera_;
  Wall wall_;
  Light light_;
  std::vector<Sheet> sheets_;
  double fps_, exposure_s_, readout_s_, psf_px_, tail_share_, tail_px_, coma_x_, coma_y_;
  double focus_mm_, aperture_px_mm_, vignetting_;
  int time_samples_;
};

}  // namespace world

// SPDX-License-Identifier: Apache-2.0
#include "studies/world/exposure.h"

#include <algorithm>
#include <cmath>

#include "studies/world/blur.h"

namespace world {
// Board plane seen from the camera: (x, y, 1) in the plane's axes is `plane_from_ray` times the ray, up to its scale.
struct View {
  Mat3 plane_from_ray;
  [[nodiscard]] Ray at(const Ray& ray) const {
    const Vec3 p = plane_from_ray * Vec3{ray.x, ray.y, 1.0};
    return {p.x / p.z, p.y / p.z};
  }
};

namespace {

View view_of(const Camera::Pose& pose, const Placement& plane) {
  const Mat3 board_from_plane = {{plane.along_x, plane.along_y, plane.origin_mm - pose.position_mm}};
  return {inverse(pose.camera_from_board * board_from_plane)};
}

}  // namespace

struct Exposure::Seen {
  double time_s = 0.0;
  View wall, board;
  std::vector<View> views;
  std::vector<std::size_t> sheets;
};

Light::Light(const DrawFile& draw) : shadow_mm_(draw.track("light.shadow_mm")) {
  const auto gradient = draw.numbers("light.gradient_per_mm", 2), flicker = draw.numbers("light.flicker", 2);
  const auto shadow = draw.numbers("light.shadow", 3);
  gradient_x_ = gradient[0], gradient_y_ = gradient[1];
  flicker_share_ = flicker[0], flicker_hz_ = flicker[1];
  shadow_depth_ = shadow[0], shadow_cos_ = std::cos(shadow[1]), shadow_sin_ = std::sin(shadow[1]);
  shadow_width_mm_ = shadow[2];
}

double Light::at(double x_mm, double y_mm, double time_s) const {
  double value = std::max(0.1, 1.0 + gradient_x_ * x_mm + gradient_y_ * y_mm);
  if (shadow_depth_ > 0.0) {
    const double beyond = shadow_cos_ * x_mm + shadow_sin_ * y_mm - shadow_mm_.at(time_s);
    value *= 1.0 - shadow_depth_ * 0.5 * (1.0 + std::tanh(beyond / shadow_width_mm_));
  }
  return value;
}

double Light::flicker(double time_s) const { return 1.0 + flicker_share_ * std::sin(kTwoPi * flicker_hz_ * time_s); }

Exposure::Exposure(const DrawFile& draw) : camera_(draw), wall_(draw), light_(draw) {
  for (const std::string& name : draw.sheets()) sheets_.emplace_back(draw, name);
  fps_ = draw.number("fps");
  exposure_s_ = draw.number("exposure_s"), readout_s_ = draw.number("readout_s");
  time_samples_ = static_cast<int>(draw.number("time_samples"));
  const auto psf = draw.numbers("lens.psf", 5), focus = draw.numbers("lens.focus", 2);
  psf_px_ = psf[0], tail_share_ = psf[1], tail_px_ = psf[2], coma_x_ = psf[3], coma_y_ = psf[4];
  focus_mm_ = focus[0], aperture_px_mm_ = focus[1];
  vignetting_ = draw.number("lens.vignetting");
}

std::vector<double> Exposure::times(int number, double row) const {
  const double middle = number / fps_ + ((row + 0.5) / camera_.height() - 0.5) * readout_s_;
  std::vector<double> out;
  for (int i = 0; i < time_samples_; ++i) out.push_back(middle + exposure_s_ * ((i + 0.5) / time_samples_ - 0.5));
  return out;
}

Ray Exposure::pixel_of(const Vec3& board_mm, double time_s) const {
  const auto pose = camera_.pose(time_s);
  return camera_.pixel_of(pose.camera_from_board * (board_mm - pose.position_mm));
}

// The windows of sheets that overlap are joined, so every pixel is rendered once.
std::vector<Exposure::Window> Exposure::windows(int number) const {
  constexpr int kMargin = 6;  // px, beyond the paper: blur and motion within the exposure
  std::vector<Window> out;
  for (std::size_t i = 0; i < sheets_.size(); ++i) {
    double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
    for (const double shift_s : {-0.5 * (exposure_s_ + readout_s_), 0.0, 0.5 * (exposure_s_ + readout_s_)}) {
      const double time_s = number / fps_ + shift_s;
      const Placement plane = sheets_[i].placement(time_s);
      for (const Ray& c : sheets_[i].outline_mm()) {
        const Ray p = pixel_of(plane.origin_mm + c.x * plane.along_x + c.y * plane.along_y, time_s);
        left = std::min(left, p.x), right = std::max(right, p.x), top = std::min(top, p.y),
        bottom = std::max(bottom, p.y);
      }
    }
    Window w{std::max(0, static_cast<int>(left) - kMargin),
             std::max(0, static_cast<int>(top) - kMargin),
             std::min(camera_.width(), static_cast<int>(right) + kMargin + 2),
             std::min(camera_.height(), static_cast<int>(bottom) + kMargin + 2),
             {i}};
    if (w.left >= w.right || w.top >= w.bottom) continue;
    for (std::size_t k = 0; k < out.size();) {
      const Window& o = out[k];
      if (o.left >= w.right || w.left >= o.right || o.top >= w.bottom || w.top >= o.bottom) {
        ++k;
        continue;
      }
      w.left = std::min(w.left, o.left), w.top = std::min(w.top, o.top);
      w.right = std::max(w.right, o.right), w.bottom = std::max(w.bottom, o.bottom);
      w.sheets.insert(w.sheets.end(), o.sheets.begin(), o.sheets.end());
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(k));
      k = 0;
    }
    std::sort(w.sheets.begin(), w.sheets.end());  // a later sheet covers an earlier one
    out.push_back(w);
  }
  return out;
}

Exposure::Seen Exposure::seen(const Window& window, double time_s) const {
  const auto pose = camera_.pose(time_s);
  const auto plane_at = [&](double z_mm) { return view_of(pose, {{0, 0, z_mm}, {1, 0, 0}, {0, 1, 0}}); };
  Seen out{time_s, plane_at(wall_.z_mm()), plane_at(0.0), {}, window.sheets};
  for (const std::size_t i : window.sheets) out.views.push_back(view_of(pose, sheets_[i].placement(time_s)));
  return out;
}

double Exposure::radiance(const Seen& seen, const Ray& ray) const {
  for (std::size_t i = seen.sheets.size(); i-- > 0;) {
    const Ray p = seen.views[i].at(ray);
    const Surface surface = sheets_[seen.sheets[i]].at(p.x, p.y);
    if (surface.opacity >= 1.0) return surface.reflectance;
    if (surface.opacity <= 0.0) continue;
    Seen behind = seen;  // at the soft rim of a sheet only
    behind.sheets.resize(i), behind.views.resize(i);
    return surface.opacity * surface.reflectance + (1.0 - surface.opacity) * radiance(behind, ray);
  }
  const Ray p = seen.wall.at(ray);
  return wall_.reflectance(p.x, p.y);
}

double Exposure::vignetting(const Ray& ray) const {
  const double cos2 = 1.0 / (1.0 + ray.x * ray.x + ray.y * ray.y);
  return 1.0 + vignetting_ * (cos2 * cos2 - 1.0);
}

void Exposure::render_row(const Seen& seen, int row, Picture& fine, const Window& area) const {
  for (int column = area.left; column < area.right; ++column) {
    const Ray &a = camera_.corner(column, row), &b = camera_.corner(column + 1, row);
    const Ray &c = camera_.corner(column, row + 1), &d = camera_.corner(column + 1, row + 1);
    const Ray middle{0.25 * (a.x + b.x + c.x + d.x), 0.25 * (a.y + b.y + c.y + d.y)};
    const Ray on_board = seen.board.at(middle);
    const double light =
        vignetting(middle) * light_.at(on_board.x, on_board.y, seen.time_s) * light_.flicker(seen.time_s);
    for (int j = 0; j < kSub; ++j) {
      float* out = fine.row((row - area.top) * kSub + j) + static_cast<std::ptrdiff_t>(column - area.left) * kSub;
      const double v = (j + 0.5) / kSub;
      const Ray left{a.x + v * (c.x - a.x), a.y + v * (c.y - a.y)}, right{b.x + v * (d.x - b.x), b.y + v * (d.y - b.y)};
      for (int i = 0; i < kSub; ++i) {
        const double u = (i + 0.5) / kSub;
        out[i] += static_cast<float>(
            light * radiance(seen, {left.x + u * (right.x - left.x), left.y + u * (right.y - left.y)}));
      }
    }
  }
}

double Exposure::defocus_px(const Window& window, int number) const {
  const auto pose = camera_.pose(number / fps_);
  const Vec3 at = sheets_[window.sheets.front()].placement(number / fps_).origin_mm;
  const double distance_mm = (pose.camera_from_board * (at - pose.position_mm)).z;
  return aperture_px_mm_ * std::abs(1.0 / distance_mm - 1.0 / focus_mm_);
}

void Exposure::render_window(const Window& window, int number, Picture& out) const {
  const double sigma_px = std::hypot(psf_px_, defocus_px(window, number));
  const int halo = std::min(Camera::kBorder - 1, 2 + static_cast<int>(std::ceil(4.0 * sigma_px)));
  const Window area{window.left - halo, window.top - halo, window.right + halo, window.bottom + halo, window.sheets};
  Picture fine((area.right - area.left) * kSub, (area.bottom - area.top) * kSub);
  std::vector<Seen> all;
  for (int row = area.top; row < area.bottom; ++row) {
    if (all.empty() || readout_s_ != 0.0) {
      all.clear();
      for (const double time_s : times(number, row)) all.push_back(seen(window, time_s));
    }
    for (const Seen& one : all) render_row(one, row, fine, area);
  }
  const Picture pixels =
      blurred_to_pixels(fine, kSub, skewed_kernel(sigma_px * kSub, coma_x_), skewed_kernel(sigma_px * kSub, coma_y_));
  const float scale = 1.0F / static_cast<float>(time_samples_);
  for (int y = window.top; y < window.bottom; ++y) {
    for (int x = window.left; x < window.right; ++x) {
      out.row(y)[x] = scale * pixels.row(y - area.top)[x - area.left];
    }
  }
}

Picture Exposure::frame(int number) const {
  Picture out(camera_.width(), camera_.height());
  const Window nothing{0, 0, camera_.width(), camera_.height(), {}};
  Seen wall;
  for (int row = 0; row < camera_.height(); ++row) {
    const double time_s = number / fps_ + ((row + 0.5) / camera_.height() - 0.5) * readout_s_;
    if (row == 0 || readout_s_ != 0.0) wall = seen(nothing, time_s);
    double flicker = 0.0;
    for (const double t : times(number, row)) flicker += light_.flicker(t) / time_samples_;
    for (int column = 0; column < camera_.width(); ++column) {
      const Ray &a = camera_.corner(column, row), &d = camera_.corner(column + 1, row + 1);
      const Ray middle{0.5 * (a.x + d.x), 0.5 * (a.y + d.y)};
      const Ray p = wall.board.at(middle);
      out.row(row)[column] =
          static_cast<float>(flicker * vignetting(middle) * light_.at(p.x, p.y, time_s) * radiance(wall, middle));
    }
  }
  for (const Window& window : windows(number)) render_window(window, number, out);
  if (tail_share_ > 0.0) {
    Picture wide = out;
    blur(wide, skewed_kernel(tail_px_, 0.0), skewed_kernel(tail_px_, 0.0));
    const auto share = static_cast<float>(tail_share_);
    for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] += share * (wide.values[i] - out.values[i]);
  }
  return out;
}

}  // namespace world

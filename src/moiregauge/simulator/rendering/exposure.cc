// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/exposure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "moiregauge/simulator/rendering/texture.h"
#include "moiregauge/simulator/scenario/gaussian.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

// Returns the number of cells per side of a pixel. A Gaussian of equal variance replaces each square cell of side h.
// The error is the fourth moment: h^4 / 2880 times the fourth derivative. It is at most 5e-5 of the contrast for a
// point spread of 0.35 px or more.
int cells_for(double psf_sigma_px) {
  if (psf_sigma_px >= 1.2) return 1;
  if (psf_sigma_px >= 0.6) return 2;
  return psf_sigma_px >= 0.35 ? 4 : 8;
}

// A movement is averaged over one moment per 0.8 px, plus one. A single moment suffices for a short and straight
// movement. Its smear widens the point spread by less than 1e-3, and its mean position is the middle.
constexpr double kShort_px = 0.1;      // px, path
constexpr double kStraight_px = 1e-4;  // px, sag

int moments_for(Movement movement) {
  if (movement.way_px < kShort_px && movement.sag_px < kStraight_px) return 1;
  return std::min(200, 1 + static_cast<int>(std::ceil(movement.way_px / 0.8)));
}

std::vector<BoardPoint> outline(const PrintedMarker& print) {
  constexpr int kSteps = 8;  // points per side, because the lens bends the sides
  const BoardPoint a = print.low(), b = print.high();
  std::vector<BoardPoint> points;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = a.x + (b.x - a.x) * i / kSteps, y = a.y + (b.y - a.y) * i / kSteps;
    points.insert(points.end(), {{x, a.y}, {x, b.y}, {a.x, y}, {b.x, y}});
  }
  return points;
}

// Returns the exposure's times of start, end and all kinks of the movements. The quadrature is accurate only between
// kinks.
std::vector<double> pieces_of(const Scenario& scenario, const SceneMarker& marker, double from_s, double to_s) {
  const Mount& m = scenario.mount;
  std::vector<double> cuts{from_s, to_s};
  const Optics& o = scenario.optics;
  for (const Track* track :
       {&m.rotation_x, &m.rotation_y, &m.rotation_z, &m.shift_x, &m.shift_y, &m.shift_z, &o.zoom, &o.shift_x,
        &o.shift_y, &marker.dx, &marker.dy, &marker.dz, &marker.wander_x, &marker.wander_y}) {
    const std::vector<double> corners = track->corners(from_s, to_s);
    cuts.insert(cuts.end(), corners.begin(), corners.end());
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  return cuts;
}

// Returns sigma in px of point spread and Gaussian defocus at the middle of the exposure.
double gaussian_sigma(const Scenario& scenario, long frame) {
  const double defocus = scenario.sensor.defocus_px.at(time_of(scenario, frame));
  return defocus == 0.0 ? scenario.sensor.psf_sigma_px : std::hypot(scenario.sensor.psf_sigma_px, defocus);
}

// A defocus disc is a set of equal Gaussians on a spiral, with the variance of a disc in total, radius^2 / 4. Their
// distance is 1.5 sigma, which gives a ripple of 2 exp(-2 pi^2 / 1.5^2) = 3e-4.
constexpr double kSoft = 0.12;  // relative to the radius, sigma of the rim

std::vector<ImagePoint> disc_of(double radius_px, double sigma_px) {
  if (radius_px <= 0.0) return {};
  const double reach = radius_px * std::sqrt(1.0 - 4.0 * kSoft * kSoft), apart = 1.5 * sigma_px;
  const int count = std::clamp(static_cast<int>(std::ceil(kPi * reach * reach / (apart * apart))), 6, 200);
  std::vector<ImagePoint> points;
  for (int i = 0; i < count; ++i) {
    const double r = reach * std::sqrt((i + 0.5) / count), angle = i * 2.399963229728653;  // the golden angle
    points.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return points;
}

}  // namespace

Focus::Focus(const Scenario& scenario) {
  if (scenario.optics.focus_mm <= 0.0) return;
  half_radius_ = 0.25 * scenario.camera.fx * scenario.optics.aperture_mm;
  per_focus_ = 1.0 / scenario.optics.focus_mm;
}

ExposedMarker::ExposedMarker(const Scenario& scenario, const SceneMarker& marker, long frame)
    : ExposedMarker(
          scenario, marker, frame,
          PrintedMarker(marker, marker.fold_mm.at(time_of(scenario, frame)), own_seed(scenario, marker)),
          {scenario.light.white, scenario.light.white - scenario.light.black, 1.0, 0.0, own_seed(scenario, marker)}) {
  ink_ = marker.ink;
}

// The cover moves with the sheet, plus its own movement across it. At a share of 1 it extends beyond the sheet.
ExposedMarker ExposedMarker::cover_of(const Scenario& scenario, const SceneMarker& marker, long frame) {
  const PrintedMarker whole(marker);
  const Cover& cover = marker.cover;
  const double width = whole.high().x - whole.low().x, height = whole.high().y - whole.low().y, beyond = 0.1 * width;
  const BoardPoint low{whole.low().x - beyond, whole.low().y - beyond};
  const double right = cover.share < 1.0 ? whole.low().x + cover.share * width : whole.high().x + beyond;
  const double upper = cover.height_share < 1.0 ? whole.low().y + cover.height_share * height : whole.high().y + beyond;
  SceneMarker moving = marker;
  moving.wander_x = cover.x_mm;
  moving.wander_y = cover.y_mm;
  const Paper paper{cover.grey, 0.0, cover.opacity, cover.texture, own_seed(scenario, marker)};
  return {scenario, moving, frame, PrintedMarker(low, {right, upper}), paper};
}

ExposedMarker::ExposedMarker(const Scenario& scenario, const SceneMarker& marker, long frame, PrintedMarker print,
                             Paper paper)
    : print_(std::move(print)),
      camera_(scenario.camera),
      paper_(paper),
      focus_(scenario),
      disc_radius_px_(std::max(scenario.sensor.defocus_disc_px.at(time_of(scenario, frame)), 0.0)) {
  double sigma = gaussian_sigma(scenario, frame);
  if (disc_radius_px_ > 0.0) sigma = std::hypot(sigma, kSoft * disc_radius_px_);
  cells_ = cells_for(sigma);
  cell_variance_ = sigma * sigma + 1.0 / (12.0 * cells_ * cells_);
  reach_px_ = kGaussianReach * std::sqrt(cell_variance_) + std::sqrt(0.5);
  disc_ = disc_of(disc_radius_px_, sigma);
  find_window(scenario, marker, frame);
  choose_moments(scenario, marker, frame);
}

void ExposedMarker::choose_moments(const Scenario& scenario, const SceneMarker& marker, long frame) {
  const double now = time_of(scenario, frame);
  if (!scenario.sensor.exposes_row_by_row()) return choose_moments_about(scenario, marker, now);
  for (int y = top_; y < bottom_; ++y) {
    row_begins_.push_back(moments_.size());
    choose_moments_about(scenario, marker, now + delay_of_row(scenario, y));
  }
  row_begins_.push_back(moments_.size());
}

std::span<const ExposedMarker::Moment> ExposedMarker::moments_of_row(int y) const {
  const std::span<const Moment> all(moments_);
  if (row_begins_.empty()) return all;
  const auto row = static_cast<std::size_t>(y - top_);
  return all.subspan(row_begins_[row], row_begins_[row + 1] - row_begins_[row]);
}

void ExposedMarker::choose_moments_about(const Scenario& scenario, const SceneMarker& marker, double now) {
  const double half = 0.5 * scenario.sensor.exposure_s;
  if (half == 0.0) return add_moment_at(scenario, marker, now, 1.0);
  const std::vector<double> cuts = pieces_of(scenario, marker, now - half, now + half);
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    const double from = cuts[i - 1], length = cuts[i] - from;
    for (const Node& node : gauss_legendre(moments_for(movement(scenario, marker, from, cuts[i])))) {
      add_moment_at(scenario, marker, from + length * (0.5 + node.at), node.weight * length / (2.0 * half));
    }
  }
}

void ExposedMarker::add_moment_at(const Scenario& scenario, const SceneMarker& marker, double time_s, double weight) {
  const Matrix3 print_from_ray = inverse(camera_from_print(scenario, marker, time_s));
  if (disc_.empty()) return moments_.push_back({print_from_ray, weight});
  for (const ImagePoint offset : disc_) {
    // The ray of a pixel at this offset, without the change of distortion over the disc.
    const double x = offset.x / camera_.fx, y = offset.y / camera_.fy;
    Matrix3 shifted = print_from_ray;
    for (auto& row : shifted) row[2] += row[0] * x + row[1] * y;
    moments_.push_back({shifted, weight / static_cast<double>(disc_.size())});
  }
}

// Returns the longer path of two opposite corners, and the larger sag.
Movement ExposedMarker::movement(const Scenario& scenario, const SceneMarker& marker, double from_s,
                                 double to_s) const {
  constexpr int kLegs = 8;
  Movement longest;
  for (const BoardPoint corner : {print_.low(), print_.high()}) {
    double way = 0.0;
    ImagePoint first, middle, before;
    for (int i = 0; i <= kLegs; ++i) {
      const double time = from_s + (to_s - from_s) * i / kLegs;
      const ImagePoint here = image_of(camera_, ray_of(camera_from_print(scenario, marker, time), corner));
      if (i > 0) way += length(here - before);
      if (i == 0) first = here;
      if (i == kLegs / 2) middle = here;
      before = here;
    }
    const ImagePoint chord{0.5 * (first.x + before.x), 0.5 * (first.y + before.y)};
    longest.way_px = std::max(longest.way_px, way);
    longest.sag_px = std::max(longest.sag_px, length(middle - chord));
  }
  return longest;
}

void ExposedMarker::find_window(const Scenario& scenario, const SceneMarker& marker, long frame) {
  double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9, defocus = 0.0;
  const double fields = scenario.sensor.interlaced ? 1.0 / scenario.sensor.fps : 0.0;
  const double span = scenario.sensor.exposure_s + scenario.sensor.readout_s + fields;
  const int looks = scenario.sensor.exposes_row_by_row() ? 16 : 2;
  for (int look = 0; look <= looks; ++look) {
    const double time = time_of(scenario, frame) + span * (static_cast<double>(look) / looks - 0.5);
    const Matrix3 seen = camera_from_print(scenario, marker, time);
    for (const BoardPoint point : outline(print_)) {
      const double depth_mm = product(seen, Vector3{point.x, point.y, 1.0})[2];
      if (depth_mm <= 1.0) return;  // too close to the camera, or behind it: the window remains empty
      defocus = std::max(defocus, focus_.variance(1.0 / depth_mm));
      const ImagePoint pixel = image_of(camera_, ray_of(seen, point));
      x0 = std::min(x0, pixel.x);
      x1 = std::max(x1, pixel.x);
      y0 = std::min(y0, pixel.y);
      y1 = std::max(y1, pixel.y);
    }
  }
  const double blur = std::sqrt(cell_variance_ + defocus);
  const double margin = 3.0 + kGaussianReach * blur + disc_radius_px_;
  left_ = static_cast<int>(std::clamp(std::floor(x0 - margin), 0.0, static_cast<double>(camera_.width)));
  right_ = static_cast<int>(std::clamp(std::ceil(x1 + margin), 0.0, static_cast<double>(camera_.width)));
  top_ = static_cast<int>(std::clamp(std::floor(y0 - margin), 0.0, static_cast<double>(camera_.height)));
  bottom_ = static_cast<int>(std::clamp(std::ceil(y1 + margin), 0.0, static_cast<double>(camera_.height)));
}

void ExposedMarker::lay_over(int y, std::span<double> row) const {
  const std::span<const Moment> moments = moments_of_row(y);
  Ray start{(left_ - camera_.cx) / camera_.fx, (y - camera_.cy) / camera_.fy};
  for (int x = left_; x < right_; ++x) {
    const RayPatch sight = ray_through(camera_, {static_cast<double>(x), static_cast<double>(y)}, start);
    start = {sight.ray.x + sight.dx_du, sight.ray.y + sight.dy_du};
    double paper = 0.0, level = 0.0;
    for (const Moment& moment : moments) see(moment, sight, paper, level);
    double& grey = row[static_cast<std::size_t>(x)];
    grey = grey * (1.0 - paper_.opacity * paper) + paper_.opacity * level;
  }
}

void ExposedMarker::see(const Moment& moment, const RayPatch& sight, double& paper, double& level) const {
  const Matrix3& m = moment.print_from_ray;
  const Vector3 w = product(m, Vector3{sight.ray.x, sight.ray.y, 1.0});
  const double scale = 1.0 / w[2];
  const BoardPoint centre{w[0] * scale, w[1] * scale};
  // Derivatives of the point on the sheet in mm, by the ray, then by pixels.
  const double xa = (m[0][0] - centre.x * m[2][0]) * scale, xb = (m[0][1] - centre.x * m[2][1]) * scale;
  const double ya = (m[1][0] - centre.y * m[2][0]) * scale, yb = (m[1][1] - centre.y * m[2][1]) * scale;
  const double xu = xa * sight.dx_du + xb * sight.dy_du, xv = xa * sight.dx_dv + xb * sight.dy_dv;
  const double yu = ya * sight.dx_du + yb * sight.dy_du, yv = ya * sight.dx_dv + yb * sight.dy_dv;
  const double xx = xu * xu + xv * xv, xy = xu * yu + xv * yv, yy = yu * yu + yv * yv;
  const double defocus = focus_.variance(w[2]), variance = cell_variance_ + defocus;
  const Blur blur{variance * xx, variance * xy, variance * yy};
  const double longest = std::sqrt(0.5 * (xx + yy + std::sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy)));
  const Seen seen =
      print_.seen({centre, xu, xv, yu, yv, cells_, (reach_px_ + kGaussianReach * std::sqrt(defocus)) * longest}, blur);
  paper += moment.weight * seen.paper;
  double white = paper_.white, contrast = paper_.contrast;
  if (paper_.texture != 0.0) white += paper_.texture * roughness(paper_.seed, centre.x, centre.y);
  if (ink_.is_uneven()) {
    const auto uneven = [&](std::uint64_t what, double length_mm) {
      return grain(paper_.seed + what, centre.x / length_mm, centre.y / length_mm);
    };
    contrast *= 1.0 + ink_.mottle * uneven(2, ink_.mottle_length_mm);
    white += ink_.grain * uneven(3, ink_.grain_length_mm);
  }
  level += moment.weight * (seen.paper * white - seen.ink * contrast);
}

}  // namespace moiregauge::internal::simulator

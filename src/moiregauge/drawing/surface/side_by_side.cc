// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/surface/side_by_side.h"

#include <algorithm>
#include <cmath>

#include <cairo.h>

#include "moiregauge/drawing/surface/surface.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kWidest = 1920;     // px, of the page: every player can show it
constexpr int kBetweenParts = 4;  // px between the images
constexpr int kMaxSamples = 3;    // per pixel side; larger frames are undersampled (chosen)
constexpr double kRing = 0.6;     // width of the stretched area, in target sizes (chosen)
constexpr double kStack = 2.0;    // aspect ratio above which the images are stacked (chosen)
constexpr std::uint8_t kNothing = 96, kGround = 24, kInk = 240;

// Returns the interpolated grey level. Black outside the image, because extrapolation would be false.
double grey_at(ImageView<std::uint8_t> picture, ImagePoint p) {
  if (!(p.x >= 0.0 && p.y >= 0.0 && p.x <= picture.width - 1 && p.y <= picture.height - 1)) return 0.0;
  const int x = std::min(static_cast<int>(p.x), picture.width - 2),
            y = std::min(static_cast<int>(p.y), picture.height - 2);
  const double fx = p.x - x, fy = p.y - y;
  const auto* row = picture.data + y * picture.stride + x;
  const auto* next = row + picture.stride;
  return (1.0 - fy) * ((1.0 - fx) * row[0] + fx * row[1]) + fy * ((1.0 - fx) * next[0] + fx * next[1]);
}

int even(double value) { return 2 * std::max(1, static_cast<int>(std::lround(0.5 * value))); }

double outside(double distance, double half) { return std::max(0.0, std::abs(distance) - half); }

// Writes white text on a dark strip, reduced to fit.
void write_text(Image<std::uint8_t>& page, int x0, int width, int height, const std::string& words) {
  Image<std::uint8_t> strip(width, height, kGround);
  const Surface surface = grey_surface(strip.view());
  const Context context(cairo_create(surface.get()), cairo_destroy);
  choose_font(context.get(), 0.62 * height, Weight::kNormal);
  cairo_text_extents_t box;
  cairo_text_extents(context.get(), words.c_str(), &box);
  const double room = width - 0.5 * height;
  if (box.x_advance > room) cairo_set_font_size(context.get(), 0.62 * height * room / box.x_advance);
  cairo_move_to(context.get(), 0.25 * height, 0.72 * height);
  const double ink = kInk / 255.0;
  cairo_set_source_rgb(context.get(), ink, ink, ink);
  cairo_show_text(context.get(), words.c_str());
  cairo_surface_flush(surface.get());
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  if (data == nullptr) return;
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) page.at(x0 + x, y) = data[static_cast<std::ptrdiff_t>(y) * stride + 4 * x + 1];
}

// Returns the distance to the nearest other marker, mm, which must not be stretched.
double free_round(const Site& site, std::size_t target) {
  const Grating& own = *site.markers[target].grating;
  double free = 1e9;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (i == target) continue;
    const auto see = [&](BoardPoint centre, double width, double height) {
      const double x = outside(centre.x - own.centre.x, 0.5 * (own.width_mm + width));
      const double y = outside(centre.y - own.centre.y, 0.5 * (own.height_mm + height));
      free = std::min(free, std::hypot(x, y));
    };
    if (const auto& g = site.markers[i].grating) see(g->centre, g->width_mm, g->height_mm);
    if (const auto& c = site.markers[i].circle) see(c->centre, c->diameter_mm, c->diameter_mm);
  }
  return free;
}

}  // namespace

SideBySide::SideBySide(const Reference& reference, double exaggeration, double longest_mm)
    : exaggeration_(exaggeration) {
  const bool stacked = reference.width > kStack * reference.height;
  const double widest = stacked ? kWidest : 0.5 * (kWidest - kBetweenParts);
  scale_ = std::min(1.0, widest / reference.width);
  part_width_ = even(scale_ * reference.width);
  part_height_ = even(scale_ * reference.height);
  letters_px_ = even(std::clamp(part_width_ / 32.0, 16.0, 30.0));
  width_ = stacked ? part_width_ : 2 * part_width_ + kBetweenParts;
  height_ = stacked ? 2 * (part_height_ + letters_px_) : part_height_ + letters_px_;
  still_x_ = stacked ? 0 : part_width_ + kBetweenParts;
  still_y_ = stacked ? part_height_ + 2 * letters_px_ : letters_px_;
  samples_ = std::clamp(static_cast<int>(std::ceil(1.0 / scale_ - 0.2)), 1, kMaxSamples);
  for (int y = 0; y < part_height_; ++y)
    for (int x = 0; x < part_width_; ++x)
      for (int k = 0; k < samples_ * samples_; ++k) {
        const int column = k % samples_, row = k / samples_;
        const double dx = (column + 0.5) / samples_, dy = (row + 0.5) / samples_;
        places_.push_back(reference.view.board({(x + dx) / scale_ - 0.5, (y + dy) / scale_ - 0.5}));
      }
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    if (marker.role != Role::kTarget || !marker.grating) continue;
    const Grating& g = *marker.grating;
    const double c = std::abs(std::cos(g.angle_rad)), s = std::abs(std::sin(g.angle_rad));
    const double ring = std::max(kRing * std::min(g.width_mm, g.height_mm), 2.0 * (exaggeration - 1.0) * longest_mm);
    targets_.push_back({g.centre, 0.5 * (c * g.width_mm + s * g.height_mm), 0.5 * (s * g.width_mm + c * g.height_mm),
                        std::min(ring, std::max(1e-6, free_round(reference.site, i)))});
  }
}

std::uint8_t SideBySide::still_pixel(ImageView<std::uint8_t> filmed, const View& view, std::size_t at,
                                     const std::vector<DrawnMotion>& moves) const {
  const auto samples = static_cast<std::size_t>(samples_ * samples_);
  double sum = 0.0;
  for (std::size_t k = at * samples; k < (at + 1) * samples; ++k) {
    BoardPoint place = places_[k];
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      if (!moves[t].is_known) continue;
      const Target& target = targets_[t];
      const auto drawn = exaggeration_ * moves[t].displacement;
      const double off = std::hypot(outside(places_[k].x - target.centre.x - drawn.x, target.half_width_mm),
                                    outside(places_[k].y - target.centre.y - drawn.y, target.half_height_mm));
      if (off >= target.ring_mm) continue;
      const double share = 0.5 * (1.0 + std::cos(kPi * off / target.ring_mm));
      place = place + share * (moves[t].apparent - drawn);
    }
    sum += grey_at(filmed, view(place));
  }
  return static_cast<std::uint8_t>(std::lround(sum / static_cast<double>(samples)));
}

Image<std::uint8_t> SideBySide::draw(ImageView<std::uint8_t> filmed, const View* view,
                                     const std::vector<DrawnMotion>& moves, const std::string& words_filmed,
                                     const std::string& words_still) const {
  Image<std::uint8_t> page(width_, height_, kGround);
  const double step = 1.0 / (scale_ * samples_);
  for (int y = 0; y < part_height_; ++y) {
    for (int x = 0; x < part_width_; ++x) {
      double sum = 0.0;
      for (int k = 0; k < samples_ * samples_; ++k) {
        const int column = x * samples_ + k % samples_, row = y * samples_ + k / samples_;
        sum += grey_at(filmed, {(column + 0.5) * step - 0.5, (row + 0.5) * step - 0.5});
      }
      page.at(x, y + letters_px_) = static_cast<std::uint8_t>(std::lround(sum / (samples_ * samples_)));
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(part_width_) + static_cast<std::size_t>(x);
      page.at(still_x_ + x, still_y_ + y) = view == nullptr ? kNothing : still_pixel(filmed, *view, at, moves);
    }
  }
  write_text(page, 0, part_width_, letters_px_, words_filmed);
  if (still_x_ > 0) {
    write_text(page, still_x_, part_width_, letters_px_, words_still);
    return page;
  }
  Image<std::uint8_t> strip(part_width_, letters_px_);
  write_text(strip, 0, part_width_, letters_px_, words_still);
  for (int y = 0; y < letters_px_; ++y)
    std::copy_n(strip.row(y).begin(), part_width_, page.row(still_y_ - letters_px_ + y).begin());
  return page;
}

double best_exaggeration(double longest_mm, double u_mm, double size_mm) {
  constexpr double kShare = 0.25, kNoiseShare = 0.05, kMax = 10000.0;
  if (!(longest_mm > 0.0)) return 1.0;
  const double most = std::min({kMax, kShare * size_mm / longest_mm, u_mm > 0.0 ? kNoiseShare * size_mm / u_mm : kMax});
  double best = 1.0;
  for (double power = 1.0; power <= kMax; power *= 10.0)
    for (const double digit : {1.0, 2.0, 5.0})
      if (digit * power <= most) best = std::max(best, digit * power);
  return best;
}

}  // namespace moiregauge::internal

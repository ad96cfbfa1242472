// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/echo.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace moiregauge::internal {
namespace {

constexpr int kPixels = 20000;           // per grating and frame; chosen
constexpr int kFramePixels = 60000;      // over all gratings of a frame; bounds the time. Chosen.
constexpr std::size_t kMoments = 4;      // lags of one to three frames
constexpr double kReplaced_px = 2.0;     // movement from which on other pixels are used. Chosen.
constexpr double kMargin_px = 3.0;       // more than that, so that all pixels stay inside the window
constexpr double kMoves_px = 0.03;       // below, an edge of 100 grey levels/px changes by less than kChange
constexpr double kNear_px = 0.5;         // largest d_k. Structure is nearly linear over it. Chosen.
constexpr double kChange = 3.0;          // grey levels, of which whole levels show a share of 0.1 a third of the time
constexpr int kMinChanged = 100;         // pixels
constexpr double kVisible_px = 0.3;      // smallest D. A beyond the fit's columns has third order in D.
constexpr int kMinForEdges = 300;        // pixels, for 17 unknowns
constexpr double kMaxShareError = 0.05;  // u of one frame's share. Chosen.
constexpr double kAlikeError = 0.02;     // frames of a smaller u weigh alike, so that no single one decides. Chosen.
constexpr double kDetermined = 1e-3;     // relative determinant of beta and s
constexpr double kMinFrames = 5.0;       // with movement: a single jump of the target decides nothing
// A test is decided when u is far below the smallest share that matters. Chosen.
constexpr double kDecidedByEdges = 0.003, kDecidedByNoise = 0.008;
constexpr double kDecidingFrames = 12.0;
constexpr int kMostFrames = 400;  // with movement, examined in vain. Chosen.

constexpr double kUnknowns = 2.0;  // beta and s
constexpr int kNuisances = 16;
using Row = Eigen::Matrix<double, kNuisances + 1, 1>;
using Normal = Eigen::Matrix<double, kNuisances + 1, kNuisances + 1>;

// Adds the products of one grating and frame. Means over the lags eliminate alpha.
struct Product {
  double distance2 = 0.0;  // px^2
  double is_last = 0.0;    // 1 for k = 1
  double value = 0.0;      // 1
};
void add_products(const std::vector<Product>& products, double weight, EchoSums& sums) {
  Product mean;
  const double share = 1.0 / static_cast<double>(products.size());
  for (const Product& one : products)
    mean.distance2 += share * one.distance2, mean.is_last += share * one.is_last, mean.value += share * one.value;
  for (const Product& one : products) {
    const double d2 = one.distance2 - mean.distance2, last = one.is_last - mean.is_last, y = one.value - mean.value;
    sums.normal[0] += weight * d2 * d2, sums.normal[1] += weight * d2 * last, sums.normal[2] += weight * last * last;
    sums.right[0] += weight * d2 * y, sums.right[1] += weight * last * y;
    sums.squares += weight * y * y;
  }
  sums.equations += static_cast<double>(products.size() - 1);
}

// Returns the factor by which few degrees of freedom enlarge u, so that 4 u are as rare as 4 sigma. Student's t is
// expanded for large degrees of freedom (Abramowitz and Stegun 26.7.5).
double enlargement_of_few(double freedom) { return 1.0 + 4.25 / freedom + 16.0 / (freedom * freedom); }

// Returns the effective number of frames whose edges moved.
double frames_of(const EchoSums& sums) {
  return sums.squared_weights > 0.0 ? sums.weights * sums.weights / sums.squared_weights : 0.0;
}

double mean_of_products(const std::vector<double>& a, const std::vector<double>& b, const std::vector<bool>& use) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (use[i]) sum += a[i] * b[i], count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

bool is_inside(PrintPoint p, const PatchWindow& w) {
  return std::abs(p.x - w.centre.x) <= w.half_x && std::abs(p.y - w.centre.y) <= w.half_y;
}

// Returns the image of the window's centre, linearly about the middle of the nine points, px.
ImagePoint centre_of(const PatchFit& fit, const PatchWindow& window) {
  const auto along_x = fit.image[5] - fit.image[3], along_y = fit.image[7] - fit.image[1];
  const double x = (window.centre.x - fit.print[4].x) / (fit.print[5].x - fit.print[3].x);
  const double y = (window.centre.y - fit.print[4].y) / (fit.print[7].y - fit.print[1].y);
  return {fit.image[4].x + x * along_x.x + y * along_y.x, fit.image[4].y + x * along_x.y + y * along_y.y};
}

// Returns the columns that the fit has, and those of the movement: even, then odd.
Row row_of(const PrintTemplate& print, PrintPoint now, PrintPoint before, PrintPoint at) {
  const PrintLevel level = print.at(now);
  const double past = print.at(before).t;
  const double mirrored = print.at({2.0 * now.x - before.x, 2.0 * now.y - before.y}).t;
  Row row;
  row << 1.0, at.x, at.y, level.t, at.x * level.t, at.y * level.t, level.dx, level.dy, at.x * level.dx, at.y * level.dx,
      at.x * level.dy, at.y * level.dy, level.dxx, level.dyy, level.dx * level.dx + level.dy * level.dy,
      past + mirrored - 2.0 * level.t, past - mirrored;
  return row;
}

}  // namespace

EchoShare share_by_edges(const EchoSums& sums) {
  const double frames = frames_of(sums);
  if (!(frames >= kMinFrames)) return {};
  const double mean = sums.shares / sums.weights;
  const double variance = std::max(0.0, sums.squared_shares / sums.weights - mean * mean);
  return {mean, enlargement_of_few(frames - 1.0) * std::sqrt(variance / (frames - 1.0))};
}

EchoShare share_by_noise(const EchoSums& sums) {
  if (sums.equations < 2.0 * kMinFrames) return {};
  const auto& [bb, bs, ss] = sums.normal;
  const double determinant = bb * ss - bs * bs;
  if (!(determinant > kDetermined * bb * ss)) return {};
  const double beta = (ss * sums.right[0] - bs * sums.right[1]) / determinant;
  const double share = (bb * sums.right[1] - bs * sums.right[0]) / determinant;
  const double squares = sums.squares - beta * sums.right[0] - share * sums.right[1];
  const double freedom = sums.equations - kUnknowns;
  const double few = enlargement_of_few(freedom);
  // The noise of the products is known. What exceeds it is known by their scatter only.
  const double variance = 1.0 + few * few * std::max(0.0, squares / freedom - 1.0);
  return {share, std::sqrt(variance * bb / determinant)};
}

namespace {

bool is_decided(const EchoSums& sums) {
  return (frames_of(sums) >= kDecidingFrames && share_by_edges(sums).u < kDecidedByEdges) ||
         share_by_noise(sums).u < kDecidedByNoise;
}

}  // namespace

bool EchoWatch::is_finished() const { return is_decided(sums_) || examined_ >= kMostFrames; }

void EchoWatch::add(const LightPicture& picture, const std::vector<SeenPrint>& prints) {
  if (is_finished()) return;
  std::vector<bool> is_seen(tracks_.size());
  FrameShare share;
  std::size_t pixels = 0;
  for (const SeenPrint& print : prints) {
    if (tracks_.size() <= print.marker) tracks_.resize(print.marker + 1), is_seen.resize(print.marker + 1);
    Track& track = tracks_[print.marker];
    if (pixels >= kFramePixels) break;
    is_seen[print.marker] = true;
    if (!follow(picture, print, track)) continue;
    pixels += track.pixels.size();
    add_edges(print, track, share);
    add_noise(print.step, track);
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!is_seen[i]) tracks_[i].moments.clear();
  }
  examined_ += pixels > 0;
  add_share(share);
}

bool EchoWatch::follow(const LightPicture& picture, const SeenPrint& print, Track& track) {
  const PatchWindow& window = print.model->window;
  Moment now{centre_of(*print.fit, window), {}, {}, {}};
  const bool moved = std::any_of(track.moments.begin(), track.moments.end(),
                                 [&](const Moment& then) { return length(now.centre - then.centre) > kMoves_px; });
  if (moved) {
    now.map = map_of(*print.fit, window);
    if (track.pixels.empty() || length(now.centre - track.placed) > kReplaced_px)
      place(picture.luma, window, now, track);
    predict(picture, print, track, now);
  }
  track.moments.insert(track.moments.begin(), std::move(now));
  if (track.moments.size() > kMoments) track.moments.pop_back();
  return moved;
}

// Chooses the pixels of the window. Residuals at other pixels are dropped.
void EchoWatch::place(const LumaView& luma, const PatchWindow& window, const Moment& now, Track& track) {
  const PixelBox whole = box_round(now.map->inverse(), window);
  const PixelBox box{std::max(0, whole.x0), std::max(0, whole.y0), std::min(width_of(luma) - 1, whole.x1),
                     std::min(height_of(luma) - 1, whole.y1)};
  const double area = std::max(1.0, double(box.x1 - box.x0 + 1) * double(box.y1 - box.y0 + 1));
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(area / kPixels))));
  const double pitch_px = std::sqrt(area / (4.0 * window.half_x * window.half_y));
  const double margin = kMargin_px / pitch_px;
  const PatchWindow inner{window.centre, window.half_x - margin, window.half_y - margin};
  track.pixels.clear();
  track.placed = now.centre;
  for (int y = box.y0; y <= box.y1; y += step) {
    for (int x = box.x0; x <= box.x1; x += step) {
      if (is_inside((*now.map)(ImagePoint{double(x), double(y)}), inner)) track.pixels.push_back({x, y});
    }
  }
  for (Moment& moment : track.moments) moment.residuals.clear(), moment.predicted.clear();
}

// Predicts the grey levels as the fit does, without width of lines.
void EchoWatch::predict(const LightPicture& picture, const SeenPrint& print, const Track& track, Moment& now) {
  const PatchFit& fit = *print.fit;
  const std::array<double, 2> blur = blur_of(fit);
  now.predicted.reserve(track.pixels.size()), now.residuals.reserve(track.pixels.size());
  std::visit(
      [&](const auto& luma) {
        for (const Pixel& pixel : track.pixels) {
          const auto grey = luma.at(pixel.x, pixel.y);
          const double light = picture.light.empty() ? double(grey) : double(picture.light[grey]);
          const ImagePoint at{double(pixel.x), double(pixel.y)};
          const PrintLevel level = print.model->print.at((*now.map)(at));
          const auto [background, contrast] = fit.light_and_contrast(at);
          const double predicted = background + contrast * level.t + blur[0] * level.dxx + blur[1] * level.dyy;
          now.predicted.push_back(predicted), now.residuals.push_back(light - predicted);
        }
      },
      picture.luma);
}

void EchoWatch::add_share(const FrameShare& share) {
  if (!(share.weight > 1.0 / (kMaxShareError * kMaxShareError))) return;
  const double found = std::clamp(share.weighted / share.weight, -1.0, 1.0);
  const double weight = 1.0 / (1.0 / share.weight + kAlikeError * kAlikeError);
  sums_.weights += weight, sums_.squared_weights += weight * weight;
  sums_.shares += weight * found, sums_.squared_shares += weight * found * found;
}

void EchoWatch::add_edges(const SeenPrint& print, const Track& track, FrameShare& share) {
  if (track.moments.size() < 2) return;
  const Moment &now = track.moments[0], &before = track.moments[1];
  if (!before.map || !(length(now.centre - before.centre) > kVisible_px)) return;
  const PatchWindow& window = print.model->window;
  const auto to_window = window_from_print(window);
  Normal normal = Normal::Zero();
  Row right = Row::Zero();
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < track.pixels.size(); ++i) {
    const ImagePoint at{double(track.pixels[i].x), double(track.pixels[i].y)};
    const PrintPoint here = (*now.map)(at), there = (*before.map)(at);
    if (!is_inside(there, window) || !is_inside({2.0 * here.x - there.x, 2.0 * here.y - there.y}, window)) continue;
    const auto in_window = to_window(here);
    const Row row = row_of(print.model->print, here, there, {in_window.x, in_window.y});
    normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right += row * now.residuals[i];
    squares += now.residuals[i] * now.residuals[i];
    ++count;
  }
  if (count < kMinForEdges) return;
  const Eigen::LDLT<Normal, Eigen::Lower> solver(normal);
  const Row x = solver.solve(right);
  const double sigma2 = std::max(0.0, squares - right.dot(x)) / (count - kNuisances - 1);
  // Variance of the odd column's factor over sigma2.
  const double odd = solver.solve(Row::Unit(kNuisances))(kNuisances);
  const double gain = print.fit->gain[0];
  if (!(sigma2 > 0.0 && odd > 0.0 && gain > 0.0)) return;
  const double weight = gain * gain / (4.0 * sigma2 * odd);
  share.weight += weight, share.weighted += weight * 2.0 * x(kNuisances) / gain;
}

void EchoWatch::add_noise(double step, const Track& track) {
  const Moment& now = track.moments[0];
  std::vector<double> distance;
  for (std::size_t k = 1; k < track.moments.size(); ++k) {
    const Moment& then = track.moments[k];
    const double d = length(now.centre - then.centre);
    if (then.residuals.size() != now.residuals.size() || d > kNear_px) break;
    distance.push_back(d);
  }
  if (distance.size() < 2) return;
  std::vector<bool> use(now.residuals.size());
  for (std::size_t i = 0; i < use.size(); ++i)
    use[i] = std::abs(now.predicted[i] - track.moments[1].predicted[i]) >= kChange * step;
  const auto count = std::count(use.begin(), use.end(), true);
  if (count < kMinChanged) return;
  const double whole = mean_of_products(now.residuals, now.residuals, use);
  if (!(whole > 0.0)) return;
  std::vector<Product> products;
  for (std::size_t k = 0; k < distance.size(); ++k) {
    const double product = mean_of_products(now.residuals, track.moments[k + 1].residuals, use);
    products.push_back({distance[k] * distance[k], k == 0 ? 1.0 : 0.0, product / whole});
  }
  add_products(products, static_cast<double>(count), sums_);
}

}  // namespace moiregauge::internal

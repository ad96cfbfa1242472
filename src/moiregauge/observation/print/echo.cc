// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/echo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kPixels = 20000;        // per grating and frame; chosen
constexpr int kFramePixels = 60000;   // over all gratings of a frame; bounds the time. Chosen.
constexpr int kTile = 16;             // px. Large gratings count in tiles, because pixels need their neighbours.
constexpr std::size_t kMoments = 8;   // lags of one to seven frames
constexpr double kReplaced_px = 4.0;  // movement from which on other pixels are used: three lags of 1.2 px. Chosen.
constexpr double kMoves_px = 0.03;    // below, an edge of 100 grey levels/px changes by less than kChange
constexpr int kNeighbours = 3;        // px, largest e
constexpr double kChange = 3.0;       // grey levels, of which whole levels show a share of 0.1 a third of the time
// Largest mean square of the residuals, in that of the grating's best fit. Blur by a vibration returns with its phase,
// and looks like an echo: with three frames per period, a share of 0.3 without an average. Chosen.
constexpr double kNoiseOnly = 1.2;
constexpr int kMinChanged = 100;     // pixels
constexpr double kVisible_px = 0.3;  // smallest D. A beyond the fit's columns has third order in D.
// The same behind a codec that predicts. Its own lag is 0.12 px at most (quantiser.h). Without an average the shares are
// then below 0.004 (tests/studies/averaged_study.py).
constexpr double kVisiblePredicted_px = 1.0;
// Range of D for the images before and after. Half a pitch apart they are the image itself, upside down.
constexpr double kBothSides_px = 2.0, kBothSidesPitches = 0.25;  // chosen
constexpr int kMinForEdges = 300;                                // pixels, for 17 unknowns
constexpr double kMaxShareError = 0.05;                          // u of one frame's share. Chosen.
// The same for both sides. Sinusoidal gratings with a larger u showed shares of 0.02 to 0.19 without an average. Two
// equal frames show 0.1.
constexpr double kMaxBothError = 0.01;
constexpr int kMostFrames = 400;     // with movement, examined in vain. Chosen.
constexpr int kMostPredicted = 120;  // the same behind a codec that predicts, and for the blur. Chosen.
// u of the blur's slope. Equal frames differ from the longest exposure by eight times as much.
constexpr double kKnownBlur = 0.01;
constexpr int kNuisances = 16;
using Row = Eigen::Matrix<double, kNuisances + 1, 1>;
using Normal = Eigen::Matrix<double, kNuisances + 1, kNuisances + 1>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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

// Returns the mean square of the residuals inside the window.
double mean_square(const std::vector<double>& residuals) {
  double sum = 0.0, count = 0.0;
  for (const double r : residuals) {
    if (!std::isnan(r)) sum += r * r, count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

// Pixels whose prediction changed, and the mean square of their residuals.
struct Changed {
  std::vector<std::size_t> index;
  double square = 0.0;
};
Changed changed_pixels(const std::vector<double>& now, const std::vector<double>& before,
                       const std::vector<double>& residuals, double change) {
  Changed changed;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (std::abs(now[i] - before[i]) >= change)  // false outside the window
      changed.index.push_back(i), changed.square += residuals[i] * residuals[i];
  }
  changed.square /= std::max(1.0, static_cast<double>(changed.index.size()));
  return changed;
}

// Returns the index of the pixel (ex, ey) before each chosen one, or -1. `pixels` are sorted by rows, `chosen` by index.
template <typename Pixel>
std::vector<std::ptrdiff_t> neighbours_of(const std::vector<Pixel>& pixels, const std::vector<std::size_t>& chosen,
                                          int ex, int ey) {
  std::vector<std::ptrdiff_t> neighbours;
  neighbours.reserve(chosen.size());
  std::size_t at = 0;
  for (const std::size_t i : chosen) {
    const std::pair other(pixels[i].y - ey, pixels[i].x - ex);
    const auto place = [&] { return std::pair(pixels[at].y, pixels[at].x); };
    while (at < pixels.size() && place() < other) ++at;
    neighbours.push_back(at < pixels.size() && place() == other ? static_cast<std::ptrdiff_t>(at) : -1);
  }
  return neighbours;
}

// Returns the mean product of the residuals of chosen pixels now and of their neighbours then. Nothing: too few pixels.
std::optional<double> mean_product(const std::vector<double>& now, const std::vector<double>& then,
                                   const std::vector<std::size_t>& chosen,
                                   const std::vector<std::ptrdiff_t>& neighbours) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (neighbours[i] < 0) continue;
    const double residual = then[static_cast<std::size_t>(neighbours[i])];
    if (!std::isnan(residual)) sum += now[chosen[i]] * residual, ++count;
  }
  return count >= kMinChanged ? std::optional(sum / count) : std::nullopt;
}

// Returns the length of a pitch in the image, px. NaN: it is not shown.
double pitch_px_of(const PatchFit& fit) {
  const double across = fit.print[5].x - fit.print[3].x;
  return across > 0.0 ? length(fit.image[5] - fit.image[3]) / across : kNaN;
}

// Returns the direction of a print's x axis in the image, of length 1.
ImagePoint x_axis_of(const PatchFit& fit) {
  const auto along = fit.image[5] - fit.image[3];
  const double size = length(along);
  return size > 0.0 ? ImagePoint{along.x / size, along.y / size} : ImagePoint{1.0, 0.0};
}

}  // namespace

void EchoWatch::add(const LightPicture& picture, const std::vector<SeenPrint>& prints) {
  if (is_finished()) return;
  std::vector<bool> is_seen(tracks_.size());
  SharesOfGratings shares;
  std::size_t pixels = 0;
  bool any_moved = false;
  ++frame_;
  for (const SeenPrint& print : prints) {
    if (tracks_.size() <= print.marker) tracks_.resize(print.marker + 1), is_seen.resize(print.marker + 1);
    Track& track = tracks_[print.marker];
    if (pixels >= kFramePixels) break;
    is_seen[print.marker] = true;
    if (!follow(picture, print, track, !has_shares_)) continue;
    any_moved = true;
    if (!has_blur_) add_blur_of(print, track);
    if (has_shares_) continue;
    pixels += track.pixels.size();
    const double visible_px = picture.is_predicted ? kVisiblePredicted_px : kVisible_px;
    if (const auto edges = share_by_edges_of(print, track, visible_px)) add_edges(print.marker, *edges, shares);
    if (picture.shows_noise) add_noise(print, track);
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!is_seen[i]) tracks_[i].moments.clear();
  }
  examined_ += any_moved;
  predicted_ += any_moved && picture.is_predicted;
  add_frame(shares);
  if (shares.both_weight > 0.0) both_sides_.push_back(shares.both_sides / shares.both_weight);
  if (!has_shares_) sums_.both_sides = share_of_both_sides(both_sides_);
  if (!has_blur_ && any_moved) sums_.blur = blur_slope(blurs_);
  has_shares_ = has_shares_ || is_decided(sums_) || examined_ >= kMostFrames || predicted_ >= kMostPredicted;
  has_blur_ = has_blur_ || sums_.blur.u <= kKnownBlur || examined_ >= kMostPredicted;
}

bool EchoWatch::follow(const LightPicture& picture, const SeenPrint& print, Track& track, bool needs_shares) {
  const PatchWindow& window = print.model->window;
  Moment now{.centre = centre_of(*print.fit, window), .map = {}, .residuals = {}, .predicted = {}, .along = {}};
  const bool moved = std::any_of(track.moments.begin(), track.moments.end(),
                                 [&](const Moment& then) { return length(now.centre - then.centre) > kMoves_px; });
  if (moved) now.map = map_of(*print.fit, window);
  if (moved && needs_shares) {
    if (track.pixels.empty() || length(now.centre - track.placed) > kReplaced_px)
      place(picture.luma, window, now, track);
    predict(picture, print, track, now);
  }
  track.moments.insert(track.moments.begin(), std::move(now));
  if (track.moments.size() > kMoments) track.moments.pop_back();
  return moved;
}

// Chooses the pixels that the window covers until it has moved too far. Residuals at other pixels are dropped.
void EchoWatch::place(const LumaView& luma, const PatchWindow& window, const Moment& now, Track& track) {
  const PixelBox whole = box_round(now.map->inverse(), window);
  const int more = static_cast<int>(kReplaced_px);
  const PixelBox box{std::max(0, whole.x0 - more), std::max(0, whole.y0 - more),
                     std::min(width_of(luma) - 1, whole.x1 + more), std::min(height_of(luma) - 1, whole.y1 + more)};
  const double area = std::max(1.0, double(box.x1 - box.x0 + 1) * double(box.y1 - box.y0 + 1));
  // Step of the tiles that are used, along both axes.
  const int every = std::max(1, static_cast<int>(std::ceil(area / kPixels)));
  track.pixels.clear();
  track.placed = now.centre;
  for (int y = box.y0; y <= box.y1; ++y) {
    for (int x = box.x0; x <= box.x1; ++x) {
      if (((x - box.x0) / kTile + (y - box.y0) / kTile) % every == 0) track.pixels.push_back({x, y});
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
          const PrintPoint on_print = (*now.map)(at);
          if (!is_inside(on_print, print.model->window)) {
            now.predicted.push_back(kNaN), now.residuals.push_back(kNaN);
            continue;
          }
          const PrintLevel level = print.model->print.at(on_print);
          const auto [background, contrast] = fit.light_and_contrast(at);
          const double predicted = background + contrast * level.t + blur[0] * level.dxx + blur[1] * level.dyy;
          now.predicted.push_back(predicted), now.residuals.push_back(light - predicted);
        }
      },
      picture.luma);
}

void EchoWatch::add_frame(const SharesOfGratings& shares) {
  if (!(shares.weight > 1.0 / (kMaxShareError * kMaxShareError))) return;
  FrameShare frame{shares.weighted / shares.weight, 1.0 / std::sqrt(shares.weight), 0.0, 0.0};
  const double norm = std::hypot(shares.direction.x, shares.direction.y);
  if (norm > 0.0) frame.x = frame.u * shares.direction.x / norm, frame.y = frame.u * shares.direction.y / norm;
  internal::add_share(frame, sums_);
}

// Fits the share by the edges of a grating. Nothing if it did not move, or shows too little.
std::optional<EchoWatch::EdgeShare> EchoWatch::share_by_edges_of(const SeenPrint& print, const Track& track,
                                                                 double visible_px) {
  if (track.moments.size() < 2) return {};
  const Moment &now = track.moments[0], &before = track.moments[1];
  if (!before.map || !(length(now.centre - before.centre) > visible_px)) return {};
  const PatchWindow& window = print.model->window;
  const auto to_window = window_from_print(window);
  Normal normal = Normal::Zero();
  Row right = Row::Zero();
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < track.pixels.size(); ++i) {
    const ImagePoint at{double(track.pixels[i].x), double(track.pixels[i].y)};
    const PrintPoint here = (*now.map)(at), there = (*before.map)(at);
    if (std::isnan(now.residuals[i]) || !is_inside(there, window) ||
        !is_inside({2.0 * here.x - there.x, 2.0 * here.y - there.y}, window))
      continue;
    const auto in_window = to_window(here);
    const Row row = row_of(print.model->print, here, there, {in_window.x, in_window.y});
    normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right += row * now.residuals[i];
    squares += now.residuals[i] * now.residuals[i];
    ++count;
  }
  if (count < kMinForEdges) return {};
  const Eigen::LDLT<Normal, Eigen::Lower> solver(normal);
  const Row x = solver.solve(right);
  const double sigma2 = std::max(0.0, squares - right.dot(x)) / (count - kNuisances - 1);
  // Variances of the factors of both columns over sigma2.
  const double odd = solver.solve(Row::Unit(kNuisances))(kNuisances);
  const double even = solver.solve(Row::Unit(kNuisances - 1))(kNuisances - 1);
  const double gain = print.fit->gain[0];
  if (!(sigma2 > 0.0 && odd > 0.0 && gain > 0.0)) return {};
  const auto went = now.centre - before.centre;
  // If the movement hardly changes the pattern but for its amplitude, errors of the template add to the share.
  const bool is_between = length(went) > kBothSides_px && length(went) < kBothSidesPitches * pitch_px_of(*print.fit);
  const bool shows_both = is_between && even > 0.0 && std::sqrt(sigma2 * even) / gain < kMaxBothError;
  return EdgeShare{2.0 * x(kNuisances) / gain,
                   2.0 * std::sqrt(sigma2 * odd) / gain,
                   shows_both ? x(kNuisances - 1) / gain : kNaN,
                   {went.x / length(went), went.y / length(went)}};
}

void EchoWatch::add_edges(std::size_t marker, const EdgeShare& edges, SharesOfGratings& shares) {
  const double weight = 1.0 / (edges.u * edges.u);
  shares.weight += weight, shares.weighted += weight * edges.share;
  if (!std::isnan(edges.both_sides)) shares.both_weight += weight, shares.both_sides += weight * edges.both_sides;
  shares.direction.x += weight * edges.direction.x, shares.direction.y += weight * edges.direction.y;
  add_grating(marker, edges.share, edges.u, sums_);
}

// The amplitude of a grating falls by exp(-2 pi^2 variance / P^2). It contains changes of light, which u covers. An
// average lies in the middle of its images. So the movement is that of both sides, as the root of the mean square.
void EchoWatch::add_blur_of(const SeenPrint& print, Track& track) {
  const PatchFit& fit = *print.fit;
  const double pitch_px = pitch_px_of(fit);
  Moment& now = track.moments[0];
  now.along = x_axis_of(fit);
  for (std::size_t axis = 0; axis < 2; ++axis)
    now.variance[axis] = -std::log(fit.fundamental[axis]) / (2.0 * kPi * kPi) * pitch_px * pitch_px;
  if (track.moments.size() < 3) return;
  const Moment& middle = track.moments[1];
  const auto axes = [&](Extent<frame::Image> went) {
    const ImagePoint x = middle.along;
    return std::array<double, 2>{went.x * x.x + went.y * x.y, went.y * x.x - went.x * x.y};
  };
  const auto before = axes(middle.centre - track.moments[2].centre), after = axes(now.centre - middle.centre);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double moved = std::sqrt(0.5 * (before[axis] * before[axis] + after[axis] * after[axis]));
    if (moved <= kLargestBlurred * pitch_px && std::isfinite(middle.variance[axis]))
      blurs_.push_back({frame_ - 1, 2 * print.marker + axis, moved, middle.variance[axis]});
  }
}

// Adds products of this frame's residuals with those of earlier frames, at the same pixels and at neighbours.
void EchoWatch::add_noise(const SeenPrint& print, Track& track) {
  Moment& now = track.moments[0];
  // The fit of a blurred frame may have a template of its own. Its sigma is then that of the noise.
  const double sigma = print.fit->sigma;
  if (sigma > 0.0) track.least_square = std::min(track.least_square, sigma * sigma);
  if (!(mean_square(now.residuals) <= kNoiseOnly * track.least_square)) return now.residuals.clear();
  const auto is_alike = [&](const Moment& then) { return then.residuals.size() == now.residuals.size(); };
  if (track.moments.size() < 2 || !is_alike(track.moments[1])) return;
  const Changed changed =
      changed_pixels(now.predicted, track.moments[1].predicted, now.residuals, kChange * print.step);
  if (changed.index.size() < kMinChanged || !(changed.square > 0.0)) return;
  const ImagePoint along = x_axis_of(*print.fit);
  std::vector<NoiseProduct> same, others;
  for (int ey = -kNeighbours; ey <= kNeighbours; ++ey) {
    for (int ex = -kNeighbours; ex <= kNeighbours; ++ex) {
      const bool is_same = ex == 0 && ey == 0;
      std::vector<std::ptrdiff_t> neighbours;
      for (std::size_t k = 1; k < track.moments.size() && is_alike(track.moments[k]); ++k) {
        const Moment& then = track.moments[k];
        const auto since = now.centre - then.centre;
        const double x = since.x - ex, y = since.y - ey;
        if (std::hypot(x, y) > kLargestDistance_px) continue;
        if (neighbours.empty()) neighbours = neighbours_of(track.pixels, changed.index, ex, ey);
        const auto product = mean_product(now.residuals, then.residuals, changed.index, neighbours);
        if (!product) continue;
        (is_same ? same : others)
            .push_back(
                {x * along.x + y * along.y, y * along.x - x * along.y, is_same && k == 1, *product / changed.square});
      }
    }
  }
  const double weight = static_cast<double>(changed.index.size());
  add_products(print.marker, same, weight, sums_);
  add_products(print.marker, others, weight, sums_);
}

}  // namespace moiregauge::internal

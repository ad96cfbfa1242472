// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/print_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "moiregauge/observation/print/print_origin.h"
#include "moiregauge/observation/print/visibility.h"
#include "moiregauge/phase/fit/print_bins.h"

namespace moiregauge::internal {
namespace {

using Failure = PatchFitFailure;

// A slope power below this part of the other axis': lines, not a weak second grating.
constexpr double kNoSlope = 1e-3;
// Template and map are learned in turn. A template takes up a share of what is wrong with the map: of a wrong scale
// over n periods all but 1 / n^2 is seen, so each round leaves about a tenth. The first rounds, with few harmonics, go
// on until the map stands still; then the window grows, and the last rounds learn all harmonics. What a template leaves
// over pushes the map by the same little in every round (1e-5 to 6e-5 pitch, mostly along, where the two may drift
// together): a map that moves as it did before has nothing more to learn either.
constexpr int kMaxRounds = 12;
constexpr double kStandsStill = 1e-6;  // pitches
constexpr double kAsBefore = 0.03;     // of the movement
constexpr int kFirstOrders = 5;

// To move a print as a whole, to within a hundredth of a pitch, not every row need be seen: three to a pitch, and never
// so few that printed edges fall between them.
constexpr double kRowsPerPitch = 3.0;
constexpr int kMaxRowStep = 4;

// A template that leaves this share less than the fundamentals alone is worth its harmonics: the rms residual of some
// thousand pixels is known to 1 %.
constexpr double kTemplateHelps = 0.02;

constexpr std::array kTemplateWords{std::pair{TemplateUse::kAuto, std::string_view("auto")},
                                    std::pair{TemplateUse::kOn, std::string_view("on")},
                                    std::pair{TemplateUse::kOff, std::string_view("off")}};

// As many whole pitches as the window holds, at least one: over these the harmonics are orthogonal to the fundamentals.
double whole_pitches(double half) { return std::max(0.5, 0.5 * std::floor(2.0 * half)); }

// To begin with: so much smaller than the site's print that it may hang half a pitch from where the site has it.
PatchWindow safe_window(const Grating& grating, double mm_per_px) {
  const auto half = [&](double size) {
    const double whole = 0.5 * size / grating.pitch_mm, edge = kPrintEdgePx * mm_per_px / grating.pitch_mm;
    return std::max(std::min(whole - edge, 0.8), whole - edge - 0.5);
  };
  return {{0, 0}, half(grating.width_mm), half(grating.height_mm)};
}

// Grey levels of the window's pixels, light and contrast taken out by an earlier fit if there is one.
template <typename Grey>
void gather_grey(const ImageView<Grey>& picture, const PrintFromImage& map, const PatchWindow& w, const PatchFit* light,
                 PrintBins& bins) {
  const PixelBox box = box_round(map.inverse(), w);
  const int first_x = std::max(0, box.x0), last_x = std::min(picture.width - 1, box.x1);
  const int first_y = std::max(0, box.y0), last_y = std::min(picture.height - 1, box.y1);
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) {
      const ImagePoint at{double(x), double(y)};
      const PrintPoint p = map(at);
      if (!(std::abs(p.x - w.centre.x) <= w.half_x && std::abs(p.y - w.centre.y) <= w.half_y)) continue;
      double grey = picture.at(x, y);
      if (light != nullptr) grey = (grey - light->background(at)) / light->contrast(at);
      bins.add(p, grey);
    }
  }
}

// How far the print reaches to one side: strips beyond the window are taken in while they look like the template.
constexpr double kStrip = 0.05;        // pitches
constexpr double kSameAsInside = 1.6;  // rms residual of a strip against that of the window
constexpr double kMaxBeyond = 0.6;     // pitches beyond the site's size

struct Side {
  int axis;     // 0: x, 1: y
  double sign;  // towards
  // How far a window reaches on this side, from the print's origin.
  [[nodiscard]] double edge(const PatchWindow& w) const {
    return axis == 0 ? w.half_x + sign * w.centre.x : w.half_y + sign * w.centre.y;
  }
};

template <typename Grey>
double reach(const ImageView<Grey>& picture, const PrintFromImage& map, const PatchWindow& w, const PatchFit& fit,
             const PrintTemplate& print, Side side, double most) {
  const auto back = map.inverse();
  const double from = side.edge(w), across = 0.9 * (side.axis == 0 ? w.half_y : w.half_x);
  const double middle = side.axis == 0 ? w.centre.y : w.centre.x;
  // Points along every strip, about one a pixel; grey levels of the nearest pixel at its own print coordinates.
  const double step = 0.7 * kStrip;
  double good = from;
  for (double at = from; at < most; at += kStrip) {
    double sum = 0.0;
    int count = 0;
    for (double t = -across; t <= across; t += step) {
      const double along = side.sign * (at + 0.5 * kStrip);
      const PrintPoint p = side.axis == 0 ? PrintPoint{along, middle + t} : PrintPoint{middle + t, along};
      const ImagePoint q = back(p);
      const int x = static_cast<int>(std::lround(q.x)), y = static_cast<int>(std::lround(q.y));
      if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return good;
      const ImagePoint pixel{double(x), double(y)};
      const double expected = fit.background(pixel) + fit.contrast(pixel) * print.at(map(pixel)).t;
      const double off = static_cast<double>(picture.at(x, y)) - expected;
      sum += off * off;
      ++count;
    }
    if (std::sqrt(sum / count) > kSameAsInside * fit.sigma) return good;
    good = at + kStrip;
  }
  return good;
}

template <typename Grey>
PatchWindow grown(const ImageView<Grey>& picture, const PrintFromImage& map, const PatchWindow& w, const PatchFit& fit,
                  const PrintTemplate& print, const Grating& grating, double pixel) {
  const double most_x = 0.5 * grating.width_mm / grating.pitch_mm + kMaxBeyond;
  const double most_y = 0.5 * grating.height_mm / grating.pitch_mm + kMaxBeyond;
  // A strip's last good pixel may be half a pixel from its edge, and half a pixel of edge goes unnoticed in a strip.
  const auto limit = [&](Side side) {
    const double most = side.axis == 0 ? most_x : most_y;
    return std::max(side.edge(w), reach(picture, map, w, fit, print, side, most) - pixel);
  };
  const double right = limit({0, 1.0}), left = limit({0, -1.0}), up = limit({1, 1.0}), down = limit({1, -1.0});
  return {{0.5 * (right - left), 0.5 * (up - down)}, 0.5 * (right + left), 0.5 * (up + down)};
}

// The nine points say where the print is; a homography through them is the map corrected.
std::optional<PrintFromImage> corrected(const PatchFit& fit) {
  const auto h = fit_homography<frame::Print, frame::Image>(fit.image, fit.print);
  if (!h) return std::nullopt;
  return *h;
}

}  // namespace

Homography<frame::Print, frame::Board> print_from_board(const Grating& grating, Extent<frame::Board> moved) {
  const double c = std::cos(grating.angle_rad) / grating.pitch_mm, s = std::sin(grating.angle_rad) / grating.pitch_mm;
  const double x = grating.centre.x + moved.x, y = grating.centre.y + moved.y;
  Matrix3 h;
  h << c, s, -c * x - s * y, -s, c, s * x - c * y, 0, 0, 1;
  return Homography<frame::Print, frame::Board>(h);
}

std::optional<PrintFromImage> local_map(const View& view, const Grating& grating, Extent<frame::Board> moved) {
  const auto board_from_print = print_from_board(grating, moved).inverse();
  const double half_x = 0.5 * grating.width_mm / grating.pitch_mm, half_y = 0.5 * grating.height_mm / grating.pitch_mm;
  const std::array<PrintPoint, 4> print{{{-half_x, -half_y}, {half_x, -half_y}, {half_x, half_y}, {-half_x, half_y}}};
  std::array<ImagePoint, 4> image;
  std::ranges::transform(print, image.begin(), [&](PrintPoint p) { return view(board_from_print(p)); });
  const auto h = fit_homography<frame::Print, frame::Image>(std::span<const ImagePoint>(image),
                                                            std::span<const PrintPoint>(print));
  if (!h) return std::nullopt;
  return *h;
}

namespace {

// As many harmonics as pixels carry, and no more than those in the window can tell apart (six to each unknown).
int order_of(const PatchWindow& w, double pitch_px) {
  const double pixels = 4.0 * w.half_x * w.half_y * pitch_px * pitch_px;
  const int most = static_cast<int>(std::floor(0.5 * (std::sqrt(pixels / 6.0) - 1.0)));
  return std::clamp(most, 1, highest_order(pitch_px));
}

}  // namespace

namespace {

// The state of learning, one round after the other.
class Learning {
 public:
  Learning(const LumaView& luma, const Grating& grating, PrintFromImage map, double mm_per_px, bool in_light)
      : in_light_(in_light),
        luma_(&luma),
        grating_(&grating),
        map_(std::move(map)),
        pixel_(mm_per_px / grating.pitch_mm) {
    window_ = safe_window(grating, mm_per_px);
  }

  // How far the map moved, pitches.
  tl::expected<double, Failure> round(int most_orders) {
    PrintBins bins(std::min(most_orders, order_of(window_, 1.0 / pixel_)));
    std::visit([&](const auto& picture) { gather_grey(picture, map_, window_, fit_ ? &*fit_ : nullptr, bins); },
               *luma_);
    auto print = bins.fit();
    if (!print) return tl::unexpected(Failure::kTooFewPixels);
    const double px = print->slope_power_x(), py = print->slope_power_y();
    PatchFitOptions options;
    options.along_x = px > kNoSlope * py;
    options.along_y = py > kNoSlope * px;
    options.has_width = !in_light_ && print->order() > 1;
    model_ = PrintModel{*std::move(print), window_, options, std::nullopt, std::nullopt, {}, {}, 0.0};
    auto fitted = fit_patch(*luma_, map_, window_, model_->print, options);
    if (!fitted) return tl::unexpected(fitted.error());
    fit_ = std::move(fitted->fit);
    model_->at_rest = std::move(fitted->at_rest);
    if (!options.along_x || !options.along_y) return 0.0;
    const auto better = corrected(*fit_);
    if (!better) return 0.0;
    double moved = 0.0;
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      const PrintPoint was = map_(fit_->image[n]), is = (*better)(fit_->image[n]);
      moved = std::max(moved, std::hypot(is.x - was.x, is.y - was.y));
    }
    map_ = *better;
    return moved;
  }

  tl::expected<void, Failure> until_it_stands_still(int most_orders) {
    double before = 0.0;
    for (int k = 0; k < kMaxRounds; ++k) {
      const auto moved = round(most_orders);
      if (!moved) return tl::unexpected(moved.error());
      if (*moved < kStandsStill || std::abs(*moved - before) < kAsBefore * *moved) break;
      before = *moved;
    }
    return {};
  }

  void grow() {
    window_ = std::visit(
        [&](const auto& picture) { return grown(picture, map_, window_, *fit_, model_->print, *grating_, pixel_); },
        *luma_);
  }

  // Whole pitches only.
  void trim() {
    window_.half_x = std::min(window_.half_x, whole_pitches(window_.half_x));
    window_.half_y = std::min(window_.half_y, whole_pitches(window_.half_y));
  }

  // Grey levels, rms residual of what the template was not learned from: harmonics also fit the noise of their pixels.
  [[nodiscard]] double sigma() const {
    const double side = 2.0 * model_->print.order() + 1.0;
    return fit_->sigma / std::sqrt(std::max(0.1, 1.0 - side * side / fit_->pixels));
  }
  [[nodiscard]] const PrintFromImage& map() const { return map_; }
  [[nodiscard]] const PrintModel& model() const { return *model_; }

 private:
  bool in_light_;
  const LumaView* luma_;  // pointers, so that a state can be copied
  const Grating* grating_;
  PrintFromImage map_;
  double pixel_;  // pitches
  PatchWindow window_;
  std::optional<PatchFit> fit_;
  std::optional<PrintModel> model_;
};

constexpr int kAllOrders = 1 << 20;

// A view through circles that are known to some millimetres only may be stretched or sheared by a third: more than
// alternating fits find back from.
constexpr double kStretched = 0.02;

PrintFromPrint lattice_seen(const LumaView& luma, const View& view, const Grating& grating,
                            Extent<frame::Board> moved) {
  const PatchWindow window = safe_window(grating, view.mm_per_px(grating.centre + moved));
  PrintFromPrint found;
  for (int round = 0; round < 2; ++round) {
    const auto presence = presence_round(luma, view, grating, window, moved, found, 0);
    if (!presence) return {};
    found = presence->lattice(window, 0, 0, axes_of(grating)) * found;
  }
  const Matrix3 change = found.matrix() / found.matrix()(2, 2) - Matrix3::Identity();
  const double stretch = change.topLeftCorner<2, 2>().cwiseAbs().maxCoeff();
  return stretch > kStretched && stretch < kMaxStretched ? found : PrintFromPrint{};
}

// The print by all of its harmonics, or by its fundamentals.
tl::expected<Learning, Failure> chosen(Learning with_template, TemplateUse use) {
  if (use == TemplateUse::kOn) return with_template;
  Learning fundamentals = with_template;
  const auto done = fundamentals.until_it_stands_still(1);
  const bool helps = !done || with_template.sigma() < (1.0 - kTemplateHelps) * fundamentals.sigma();
  if (!helps) return fundamentals;
  if (use == TemplateUse::kAuto) return with_template;
  fundamentals.trim();
  if (const auto again = fundamentals.until_it_stands_still(1); !again) return tl::unexpected(again.error());
  return fundamentals;
}

}  // namespace

std::string_view word_for(TemplateUse use) {
  for (const auto& [value, word] : kTemplateWords) {
    if (value == use) return word;
  }
  return {};
}

std::optional<TemplateUse> template_use_named(std::string_view word) {
  for (const auto& [value, its_word] : kTemplateWords) {
    if (its_word == word) return value;
  }
  return std::nullopt;
}

namespace {

// A print that shows no symmetry point: what the site means by its place is anywhere within about that, pitches.
constexpr double kNoSymmetry = 0.25;
// Nearer to half the way between two symmetry points it cannot be said which of them the site means.
constexpr double kClearlyOne = 0.35;  // of their spacing

void take_own_origin(PrintModel& model, double within) {
  const auto origin = nearest_symmetry(model.print, model.options.along_x, model.options.along_y);
  if (!origin) {
    model.u_origin = kNoSymmetry;
    return;
  }
  const double off = std::hypot(origin->at.x, origin->at.y);
  if (off > within || off > kClearlyOne * origin->spacing) {
    model.u_origin = off;
    return;
  }
  model.u_origin = origin->u;
  model.print = with_origin(model.print, origin->at);
  model.window.centre = {model.window.centre.x - origin->at.x, model.window.centre.y - origin->at.y};
  Matrix3 shift = Matrix3::Identity();
  shift(0, 2) = -origin->at.x, shift(1, 2) = -origin->at.y;
  model.correction = PrintFromPrint(shift) * model.correction;
}

}  // namespace

tl::expected<PrintModel, PatchFitFailure> learn_print(const LumaView& luma, const View& view, const Grating& grating,
                                                      TemplateUse use, double origin_within, bool in_light) {
  const auto map = local_map(view, grating, {});
  if (!map) return tl::unexpected(Failure::kOutsidePicture);
  const auto start = lattice_seen(luma, view, grating, {});
  Learning learning(luma, grating, start * *map, view.mm_per_px(grating.centre), in_light);
  if (const auto done = learning.until_it_stands_still(kFirstOrders); !done) return tl::unexpected(done.error());
  // A few harmonics leave so much over that an edge would pass for print: the window grows by all of them.
  if (const auto done = learning.round(kAllOrders); !done) return tl::unexpected(done.error());
  learning.grow();
  if (const auto done = learning.until_it_stands_still(kAllOrders); !done) return tl::unexpected(done.error());
  auto taken = chosen(std::move(learning), use);
  if (!taken) return tl::unexpected(taken.error());
  PrintModel model = taken->model();
  const double pitch_px = grating.pitch_mm / view.mm_per_px(grating.centre);
  model.options.row_step = std::clamp(static_cast<int>(pitch_px / kRowsPerPitch), 1, kMaxRowStep);
  model.correction = taken->map() * map->inverse();
  if (origin_within > 0.0) take_own_origin(model, origin_within);
  model.outline = learn_outline(luma, view, grating, model.window, model.correction);
  return model;
}

tl::expected<PatchFit, PatchFitFailure> read_points(const LumaView& luma, const View& view, const Grating& grating,
                                                    Extent<frame::Board> moved, const PrintModel& model, Rows rows) {
  const auto map = local_map(view, grating, moved);
  if (!map) return tl::unexpected(Failure::kOutsidePicture);
  const auto start = model.correction * *map;
  if (model.at_rest) return follow_patch(luma, start, model.window, model.print, model.options, *model.at_rest, rows);
  auto first = fit_patch(luma, start, model.window, model.print, model.options);
  if (!first) return tl::unexpected(first.error());
  return std::move(first->fit);
}

}  // namespace moiregauge::internal

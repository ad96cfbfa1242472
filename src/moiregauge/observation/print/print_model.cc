// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/print_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "moiregauge/observation/print/print_origin.h"
#include "moiregauge/observation/print/print_pixels.h"
#include "moiregauge/observation/print/visibility.h"

namespace moiregauge::internal {
namespace {

using Failure = PatchFitFailure;

// Slope power relative to that of the other axis. With less, the grating has lines along one axis and no weak second
// grating. Chosen.
constexpr double kNoSlope = 1e-3;
// Limits of the rounds that fit template and map alternately. A template absorbs a share of the map's errors: over n
// periods, each round leaves about 1 / n^2 of a wrong scale. Rounds with few harmonics end when the map is constant.
// Then the window grows, and the last rounds have all harmonics. Template and map then drift together by 1e-5 to 6e-5
// pitch per round. So a map that moves as in the previous round has converged, too. Chosen.
constexpr int kMaxRounds = 12;
constexpr double kUnmoved = 1e-6;   // pitches
constexpr double kAsBefore = 0.03;  // relative to the movement
constexpr int kFirstOrders = 5;

// Rows for the shift of a window to a hundredth of a pitch: three per pitch. More than four apart, they could skip
// printed edges. Chosen.
constexpr double kRowsPerPitch = 3.0;
constexpr int kMaxRowStep = 4;

// Share by which a template must lower the rms residual of the fundamentals. The rms residual of some thousand pixels
// is known to 1 %. Chosen.
constexpr double kTemplateHelps = 0.02;
// Share of the residual of the first round of fundamentals, below which a template helps without more rounds. Chosen.
constexpr double kClearlyHelps = 0.5;

constexpr std::array kTemplateWords{std::pair{TemplateUse::kAuto, std::string_view("auto")},
                                    std::pair{TemplateUse::kOn, std::string_view("on")},
                                    std::pair{TemplateUse::kOff, std::string_view("off")}};

// Returns half of the whole pitches in the window, at least half a pitch. Over whole pitches the harmonics are
// orthogonal to the fundamentals.
double whole_pitches(double half) { return std::max(0.5, 0.5 * std::floor(2.0 * half)); }

// Returns the first window. It remains inside the grating even if that is half a pitch off its stated position.
PatchWindow safe_window(const Grating& grating, double mm_per_px) {
  const auto half = [&](double size) {
    const double whole = 0.5 * size / grating.pitch_mm, edge = kPrintEdgePx * mm_per_px / grating.pitch_mm;
    return std::max(std::min(whole - edge, 0.8), whole - edge - 0.5);
  };
  return {{0, 0}, half(grating.width_mm), half(grating.height_mm)};
}

// Limits of the grating's extent to one side. Strips beyond the window belong to it as long as they match the template.
// Chosen.
constexpr double kStrip = 0.05;        // pitches
constexpr double kSameAsInside = 1.6;  // rms residual of a strip relative to that of the window
constexpr double kMaxBeyond = 0.6;     // pitches beyond the stated size

constexpr double kShareOfLines = 0.9;  // length of the window relative to that of lines

struct Side {
  int axis;     // 0: x, 1: y
  double sign;  // +1 or -1
  // Returns the distance of the window's edge on this side from the grating's origin, pitches.
  [[nodiscard]] double edge(const PatchWindow& w) const {
    return axis == 0 ? w.half_x + sign * w.centre.x : w.half_y + sign * w.centre.y;
  }
};

// Returns the corrected map: a homography through the nine points.
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

// Returns the highest order of the template. The pixels must resolve it, and each unknown needs six pixels in the
// window.
int order_of(const PatchWindow& w, double pitch_px) {
  const double pixels = 4.0 * w.half_x * w.half_y * pitch_px * pitch_px;
  const int most = static_cast<int>(std::floor(0.5 * (std::sqrt(pixels / 6.0) - 1.0)));
  return std::clamp(most, 1, highest_order(pitch_px));
}

}  // namespace

namespace {

// State of the learning, round by round.
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

  // Makes a round and returns the movement of the map, pitches.
  tl::expected<double, Failure> round(int most_orders) {
    PrintBins bins(std::min(most_orders, order_of(window_, 1.0 / pixel_)));
    std::visit([&](const auto& picture) { gather_grey(picture, map_, window_, fit_ ? &*fit_ : nullptr, bins); },
               *luma_);
    auto learned = bins.fit(model_ ? &model_->print : nullptr);
    if (!learned) return tl::unexpected(Failure::kTooFewPixels);
    const double px = learned->slope_power_x(), py = learned->slope_power_y();
    PatchFitOptions options;
    const Axes shown = axes_of(*grating_);
    options.along_x = shown.x && px > kNoSlope * py;
    options.along_y = shown.y && py > kNoSlope * px;
    if (!options.along_x || !options.along_y) learned = averaged_along_lines(*learned, options.along_x);
    options.has_width = !in_light_ && learned->order() > 1;
    model_ = PrintModel{PrintTemplate(*std::move(learned)), window_, options, std::nullopt, std::nullopt, {}, {}, 0.0};
    auto fitted = fit_patch(*luma_, map_, {window_, model_->print, options});
    if (!fitted) return tl::unexpected(fitted.error());
    fit_ = std::move(fitted->fit);
    model_->at_rest = std::move(fitted->at_rest);
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

  tl::expected<void, Failure> until_converged(int most_orders) {
    double before = 0.0;
    for (int k = 0; k < kMaxRounds; ++k) {
      const auto moved = round(most_orders);
      if (!moved) return tl::unexpected(moved.error());
      if (*moved < kUnmoved || std::abs(*moved - before) < kAsBefore * *moved) break;
      before = *moved;
    }
    return {};
  }

  // Extends the window over the grating. The window cannot follow movement along lines, so its ends stay inside them.
  void grow() {
    const PatchWindow before = window_;
    window_ = std::visit([this](const auto& picture) { return grown(picture); }, *luma_);
    if (!model_->options.along_x) window_.half_x = std::max(before.half_x, kShareOfLines * window_.half_x);
    if (!model_->options.along_y) window_.half_y = std::max(before.half_y, kShareOfLines * window_.half_y);
  }

  // Reduces the window to whole pitches.
  void trim() {
    window_.half_x = std::min(window_.half_x, whole_pitches(window_.half_x));
    window_.half_y = std::min(window_.half_y, whole_pitches(window_.half_y));
  }

  // Returns the rms residual of pixels that the template was not learned from, grey levels. The harmonics also fit the
  // noise of their own pixels.
  [[nodiscard]] double sigma() const {
    const double side = 2.0 * model_->print.order() + 1.0;
    return fit_->sigma / std::sqrt(std::max(0.1, 1.0 - side * side / fit_->pixels));
  }
  [[nodiscard]] const PrintFromImage& map() const { return map_; }
  [[nodiscard]] const PrintModel& model() const { return *model_; }

 private:
  // Returns the distance up to which the strips on one side match the template, pitches. No strip begins beyond `most`.
  template <typename Grey>
  [[nodiscard]] double reach(const ImageView<Grey>& picture, Side side, double most) const;
  // Returns the window extended by the strips that match the template.
  template <typename Grey>
  [[nodiscard]] PatchWindow grown(const ImageView<Grey>& picture) const;

  bool in_light_;
  const LumaView* luma_;  // pointers, so that a state can be copied
  const Grating* grating_;
  PrintFromImage map_;
  double pixel_;  // pitches
  PatchWindow window_;
  std::optional<PatchFit> fit_;
  std::optional<PrintModel> model_;
};

template <typename Grey>
double Learning::reach(const ImageView<Grey>& picture, Side side, double most) const {
  const auto back = map_.inverse();
  const double from = side.edge(window_), across = 0.9 * (side.axis == 0 ? window_.half_y : window_.half_x);
  const double middle = side.axis == 0 ? window_.centre.y : window_.centre.x;
  // Points along every strip, about one per pixel. Grey levels are those of the nearest pixel, compared at its own
  // grating coordinates.
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
      const double expected = fit_->background(pixel) + fit_->contrast(pixel) * model_->print.at(map_(pixel)).t;
      const double off = static_cast<double>(picture.at(x, y)) - expected;
      sum += off * off;
      ++count;
    }
    if (std::sqrt(sum / count) > kSameAsInside * fit_->sigma) return good;
    good = at + kStrip;
  }
  return good;
}

template <typename Grey>
PatchWindow Learning::grown(const ImageView<Grey>& picture) const {
  const double most_x = 0.5 * grating_->width_mm / grating_->pitch_mm + kMaxBeyond;
  const double most_y = 0.5 * grating_->height_mm / grating_->pitch_mm + kMaxBeyond;
  // The last good pixel of a strip may be half a pixel from its edge. Half a pixel of edge is invisible in a strip.
  const auto limit = [&](Side side) {
    const double most = side.axis == 0 ? most_x : most_y;
    return std::max(side.edge(window_), reach(picture, side, most) - pixel_);
  };
  const double right = limit({0, 1.0}), left = limit({0, -1.0}), up = limit({1, 1.0}), down = limit({1, -1.0});
  return {{0.5 * (right - left), 0.5 * (up - down)}, 0.5 * (right + left), 0.5 * (up + down)};
}

constexpr int kAllOrders = 1 << 20;

// Smallest change of scale or shear that starts from the phases. A view through circles known to some millimetres may
// stretch or shear by a third, from where alternating fits do not converge. Chosen.
constexpr double kStretched = 0.02;

PrintFromPrint lattice_seen(const LumaView& luma, const Grating& grating, const PrintFromImage& map, double mm_per_px) {
  const PatchWindow window = safe_window(grating, mm_per_px);
  PrintFromPrint found;
  for (int round = 0; round < 2; ++round) {
    const VisibilityMap presence = presence_round(luma, grating, found * map, window);
    found = presence.lattice(window, 0, 0, axes_of(grating)) * found;
  }
  const Matrix3 change = found.matrix() / found.matrix()(2, 2) - Matrix3::Identity();
  const double stretch = change.topLeftCorner<2, 2>().cwiseAbs().maxCoeff();
  return stretch > kStretched && stretch < kMaxStretched ? found : PrintFromPrint{};
}

// Returns the template with all harmonics, or with the fundamentals, by `use`.
tl::expected<Learning, Failure> chosen(Learning with_template, TemplateUse use) {
  if (use == TemplateUse::kOn) return with_template;
  Learning fundamentals = with_template;
  const auto first = fundamentals.round(1);
  // Later rounds lower the residual by a few per cent at most.
  const bool surely_helps = first && with_template.sigma() < kClearlyHelps * fundamentals.sigma();
  if (surely_helps && use == TemplateUse::kAuto) return with_template;
  fundamentals = with_template;
  const auto done = fundamentals.until_converged(1);
  const bool helps = !done || with_template.sigma() < (1.0 - kTemplateHelps) * fundamentals.sigma();
  if (!helps) return fundamentals;
  if (use == TemplateUse::kAuto) return with_template;
  fundamentals.trim();
  if (const auto again = fundamentals.until_converged(1); !again) return tl::unexpected(again.error());
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

// Uncertainty of the origin of a grating without a symmetry point, pitches. Chosen.
constexpr double kNoSymmetry = 0.25;
// Largest distance of the origin from a symmetry point. Near one half it is unknown which point the site states.
constexpr double kClearlyOne = 0.35;  // relative to their spacing

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
  model.print = PrintTemplate(with_origin(model.print, origin->at));
  model.window.centre = {model.window.centre.x - origin->at.x, model.window.centre.y - origin->at.y};
  Matrix3 shift = Matrix3::Identity();
  shift(0, 2) = -origin->at.x, shift(1, 2) = -origin->at.y;
  model.correction = PrintFromPrint(shift) * model.correction;
}

}  // namespace

tl::expected<PrintModel, PatchFitFailure> learn_print(const LumaView& luma, const View& view, const Grating& grating,
                                                      const LearnOptions& options) {
  const auto map = local_map(view, grating, {});
  if (!map) return tl::unexpected(Failure::kOutsidePicture);
  const double mm_per_px = view.mm_per_px(grating.centre);
  const auto start = lattice_seen(luma, grating, *map, mm_per_px);
  Learning learning(luma, grating, start * *map, mm_per_px, options.in_light);
  if (const auto done = learning.until_converged(kFirstOrders); !done) return tl::unexpected(done.error());
  // With a few harmonics the residuals are large, and an edge would count as grating. The window therefore grows with
  // all harmonics.
  if (const auto done = learning.round(kAllOrders); !done) return tl::unexpected(done.error());
  learning.grow();
  if (const auto done = learning.until_converged(kAllOrders); !done) return tl::unexpected(done.error());
  auto taken = chosen(std::move(learning), options.use);
  if (!taken) return tl::unexpected(taken.error());
  PrintModel model = taken->model();
  const double pitch_px = grating.pitch_mm / mm_per_px;
  model.options.row_step = std::clamp(static_cast<int>(pitch_px / kRowsPerPitch), 1, kMaxRowStep);
  model.correction = taken->map() * map->inverse();
  if (options.origin_within > 0.0) take_own_origin(model, options.origin_within);
  model.outline = learn_outline(luma, view, grating, model.window, model.correction);
  return model;
}

tl::expected<PatchFit, PatchFitFailure> read_points(const LumaView& luma, const View& view, const MovedGrating& at,
                                                    const PrintModel& model, Rows rows) {
  const auto map = local_map(view, at.grating, at.moved);
  if (!map) return tl::unexpected(Failure::kOutsidePicture);
  const auto start = model.correction * *map;
  const PatchToFit patch{model.window, model.print, model.options};
  if (model.at_rest) return follow_patch(luma, start, patch, *model.at_rest, rows);
  auto first = fit_patch(luma, start, patch);
  if (!first) return tl::unexpected(first.error());
  return std::move(first->fit);
}

}  // namespace moiregauge::internal

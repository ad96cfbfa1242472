// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/disc_centre.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>
#include <variant>

#include "moiregauge/image/fetch_row.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// All limits are chosen.
constexpr double kPaper = 1.25;  // radii: a disc is surrounded by paper to here
constexpr double kInside = 0.7;  // radii: blur does not reach inside
constexpr int kMaxLooks = 4;
// The first look only starts the next one, so it reads every third row.
constexpr int kFirstRows = 3;
constexpr double kLarge = 40.0;  // px: smallest diameter of which every second row may suffice
constexpr int kRowsAhead = 6;
// px: largest last movement of the centroid.
constexpr double kConverged_px = 0.1;
constexpr double kSameArea = 0.05;    // relative
constexpr double kMinContrast = 0.4;  // relative to the earlier contrast

struct DiscLook {
  ImagePoint centre;
  double area = 0.0;      // pixels with the contrast of the disc's middle
  double contrast = 0.0;  // grey levels, middle minus paper
};

// Integer sums: pixels, grey levels, and both times x. x counts from the first column of interest.
struct DiscSums {
  std::int64_t pixels = 0, x = 0, grey = 0, grey_x = 0;
};

// Pixels of one row with |x - at| <= half. There are none if half2 < 0.
struct Span {
  int from = 0, to = -1;  // both ends included
  Span(double at, double half2) {
    if (half2 < 0.0) return;
    const double half = std::sqrt(half2);
    from = static_cast<int>(std::ceil(at - half)), to = static_cast<int>(std::floor(at + half));
  }
  [[nodiscard]] int pixels() const { return std::max(0, to - from + 1); }
};

// Length of a piece of a row. 16 bits then contain a column number and 32 bits every sum, so the compiler's vectors are
// full.
constexpr int kPiece = 64;
constexpr std::array<std::int16_t, kPiece> kColumns = [] {
  std::array<std::int16_t, kPiece> columns{};
  for (int i = 0; i < kPiece; ++i) columns[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(i);
  return columns;
}();

template <typename Grey>
void add(std::span<const Grey> row, Span span, int x0, DiscSums& sums) {
  using Small = std::conditional_t<sizeof(Grey) == 1, std::int16_t, std::int32_t>;
  using Sum = std::conditional_t<sizeof(Grey) == 1, std::int32_t, std::int64_t>;
  for (int x = span.from; x <= span.to; x += kPiece) {
    const Grey* const grey = row.data() + x;
    const int count = std::min(kPiece, span.to - x + 1);
    Sum sum = 0, sum_x = 0;
    for (int i = 0; i < count; ++i) {
      sum += static_cast<Sum>(grey[i]);
      sum_x += static_cast<Sum>(static_cast<Small>(grey[i])) * kColumns[static_cast<std::size_t>(i)];
    }
    sums.grey += sum, sums.grey_x += sum_x + std::int64_t{x - x0} * sum;
  }
  const std::int64_t n = span.pixels();
  sums.pixels += n, sums.x += n * (span.from + span.to - 2 * x0) / 2;
}

// Adds pixels and grey levels only.
template <typename Grey>
void add_grey(std::span<const Grey> row, Span span, DiscSums& sums) {
  std::int32_t sum = 0;
  for (int x = span.from; x <= span.to; ++x) sum += row[static_cast<std::size_t>(x)];
  sums.grey += sum, sums.pixels += span.pixels();
}

template <typename Grey>
std::optional<DiscLook> look_at_disc(const ImageView<Grey>& picture, ImagePoint at, double radius, int row_step) {
  const double reach = kPaper * radius;
  const int x0 = static_cast<int>(std::floor(at.x - reach)), x1 = static_cast<int>(std::ceil(at.x + reach));
  const int y0 = static_cast<int>(std::floor(at.y - reach)), y1 = static_cast<int>(std::ceil(at.y + reach));
  if (!(x0 >= 0 && y0 >= 0 && x1 < picture.width && y1 < picture.height)) return std::nullopt;
  const double inner2 = std::pow(kInside * radius, 2), ring2 = std::pow(0.5 * (1.0 + kPaper) * radius, 2);
  // The window, the window without certain paper, and certain disc.
  DiscSums all, disc, middle;
  double all_y = 0.0, grey_y = 0.0;
  for (int y = y0; y <= y1; y += row_step) {
    const auto row = picture.row(y);
    if (y + kRowsAhead <= y1) fetch_row(picture, y + kRowsAhead, x0, x1);
    const double dy = y - at.y;
    const std::int64_t pixels = all.pixels, grey = all.grey;
    add<Grey>(row, {at.x, reach * reach - dy * dy}, x0, all);
    all_y += dy * static_cast<double>(all.pixels - pixels), grey_y += dy * static_cast<double>(all.grey - grey);
    add_grey<Grey>(row, {at.x, ring2 - dy * dy}, disc);
    add_grey<Grey>(row, {at.x, inner2 - dy * dy}, middle);
  }
  const std::int64_t papers = all.pixels - disc.pixels;
  if (middle.pixels == 0 || papers == 0) return std::nullopt;
  const double paper = static_cast<double>(all.grey - disc.grey) / static_cast<double>(papers);
  DiscLook out;
  out.contrast = static_cast<double>(middle.grey) / static_cast<double>(middle.pixels) - paper;
  if (out.contrast == 0.0) return std::nullopt;
  // Moments of (g - paper) / contrast, which is 1 on the disc and 0 on its paper.
  const auto above_paper = [paper](std::int64_t grey, std::int64_t of) {
    return static_cast<double>(grey) - paper * static_cast<double>(of);
  };
  out.area = above_paper(all.grey, all.pixels) / out.contrast;  // in the rows that were read
  if (!(out.area > 0.0)) return std::nullopt;
  const double weight = 1.0 / (out.contrast * out.area);
  out.centre = {x0 + weight * above_paper(all.grey_x, all.x), at.y + weight * (grey_y - paper * all_y)};
  return out;
}

}  // namespace

std::optional<ImagePoint> disc_centre(const LumaView& luma, ImagePoint expected, double diameter_px,
                                      const DetectedCircle& like, Rows rows) {
  const double radius = 0.5 * diameter_px;
  ImagePoint at = expected;
  for (int k = 0; k < kMaxLooks; ++k) {
    const int row_step = k == 0 ? kFirstRows : rows == Rows::kAll || diameter_px < kLarge ? 1 : 2;
    const auto seen =
        std::visit([&](const auto& picture) { return look_at_disc(picture, at, radius, row_step); }, luma);
    if (!seen || !(seen->contrast * like.contrast > 0.0) || !(length(seen->centre - at) < radius)) return std::nullopt;
    const double moved = length(seen->centre - at);
    at = seen->centre;
    if (k == 0 || moved > kConverged_px) continue;
    const bool same = std::abs(row_step * seen->area / (kPi * radius * radius) - 1.0) < kSameArea &&
                      std::abs(seen->contrast) > kMinContrast * std::abs(like.contrast);
    return same ? std::optional(at) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal

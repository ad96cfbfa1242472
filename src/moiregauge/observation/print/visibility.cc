// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>
#include <optional>
#include <variant>

#include "moiregauge/observation/raster/raster.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kPerPitch = 8;  // points per pitch; chosen
constexpr int kPerCell = kPerPitch / 2;
// Smallest mean grey level that a visibility is relative to. With less, noise in the dark would resemble a grating.
// Chosen.
constexpr double kDarkest = 4.0;

// Running sums over a grid of points: 1, I, and I times cosine and sine of both fundamentals.
constexpr std::size_t kSums = 6;
using CellSums = std::array<double, kSums>;

class Table {
 public:
  Table(int columns, int rows) : wide_(columns + 1), sums_(static_cast<std::size_t>((columns + 1) * (rows + 1))) {}
  // Sets the points in order, row by row.
  void set(int i, int j, const CellSums& here) {
    CellSums& to = at(i + 1, j + 1);
    for (std::size_t k = 0; k < kSums; ++k) to[k] = here[k] + at(i, j + 1)[k] + at(i + 1, j)[k] - at(i, j)[k];
  }
  [[nodiscard]] CellSums over(int i0, int j0, int i1, int j1) const {
    CellSums s;
    for (std::size_t k = 0; k < kSums; ++k) s[k] = at(i1, j1)[k] - at(i0, j1)[k] - at(i1, j0)[k] + at(i0, j0)[k];
    return s;
  }

 private:
  [[nodiscard]] const CellSums& at(int i, int j) const { return sums_[static_cast<std::size_t>(j * wide_ + i)]; }
  [[nodiscard]] CellSums& at(int i, int j) { return sums_[static_cast<std::size_t>(j * wide_ + i)]; }
  int wide_;
  std::vector<CellSums> sums_;
};

template <typename Grey>
std::optional<double> level(const ImageView<Grey>& picture, ImagePoint p) {
  if (!(p.x >= 0.0 && p.y >= 0.0 && p.x < picture.width - 1.0 && p.y < picture.height - 1.0)) return std::nullopt;
  const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
  const double u = p.x - x, v = p.y - y;
  return (1.0 - v) * ((1.0 - u) * picture.at(x, y) + u * picture.at(x + 1, y)) +
         v * ((1.0 - u) * picture.at(x, y + 1) + u * picture.at(x + 1, y + 1));
}

using Complex = std::complex<double>;

// Returns exp(2 pi i X) at the middles of points from `low` on.
std::vector<Complex> turns(double low, int points) {
  std::vector<Complex> out;
  out.reserve(static_cast<std::size_t>(points));
  for (int i = 0; i < points; ++i) out.push_back(std::polar(1.0, kTwoPi * (low + (i + 0.5) / kPerPitch)));
  return out;
}

Presence presence(const CellSums& s, Axes axes) {
  constexpr double kPoints = kPerPitch * kPerPitch;
  if (s[0] < kPoints) return {};  // beyond the image, or hidden
  const double mean = std::max(kDarkest, s[1] / kPoints);
  const Complex first = 2.0 / kPoints / mean * Complex(s[2], s[3]), second = 2.0 / kPoints / mean * Complex(s[4], s[5]);
  const double x = std::abs(first), y = std::abs(second);
  return {axes.x && axes.y ? std::sqrt(x * y) : axes.x ? x : y, first, second};
}

}  // namespace

Axes axes_of(const Grating& grating) {
  return {grating.pattern != Pattern::kLinesY, grating.pattern != Pattern::kLinesX};
}

VisibilityMap::Span VisibilityMap::span_of(const PatchWindow& w, int i, int j) const {
  const auto first = [](double low, double edge) { return static_cast<int>(std::ceil(2.0 * (edge - low) - 1e-9)); };
  const auto last = [](double low, double edge) { return static_cast<int>(std::floor(2.0 * (edge - low) + 1e-9)); };
  return {first(low_.x, w.centre.x - w.half_x) + i, first(low_.y, w.centre.y - w.half_y) + j,
          last(low_.x, w.centre.x + w.half_x) + i, last(low_.y, w.centre.y + w.half_y) + j};
}

std::vector<double> VisibilityMap::cells(const PatchWindow& w, int i, int j) const {
  const Span s = span_of(w, i, j);
  std::vector<double> out;
  for (int b = s.j0; b <= s.j1; ++b) {
    for (int a = s.i0; a <= s.i1; ++a) {
      const bool inside = a >= 0 && b >= 0 && a < columns_ && b < rows_;
      out.push_back(inside ? cells_[static_cast<std::size_t>(b * columns_ + a)].strength : 0.0);
    }
  }
  return out;
}

PrintFromPrint VisibilityMap::lattice(const PatchWindow& w, int i, int j, Axes axes) const {
  const Span s = span_of(w, i, j);
  const auto cell = [&](int a, int b) -> const Presence& { return cells_[static_cast<std::size_t>(b * columns_ + a)]; };
  // Phase step of each fundamental over half a pitch along x and along y.
  std::array<std::array<Complex, 2>, 2> step{};
  for (int b = std::max(0, s.j0); b <= std::min(rows_ - 1, s.j1); ++b) {
    for (int a = std::max(0, s.i0); a <= std::min(columns_ - 1, s.i1); ++a) {
      const Presence& here = cell(a, b);
      const auto add = [&](const Presence& next, std::size_t along) {
        step[0][along] += next.first * std::conj(here.first);
        step[1][along] += next.second * std::conj(here.second);
      };
      if (a < std::min(columns_ - 1, s.i1)) add(cell(a + 1, b), 0);
      if (b < std::min(rows_ - 1, s.j1)) add(cell(a, b + 1), 1);
    }
  }
  // The amplitude of a grating ahead of the map has a negative phase. 2 pi is one pitch, and a step is half a pitch.
  const auto slope = [&](std::size_t which, std::size_t along) {
    return -std::arg(step[which][along]) / (0.5 * kTwoPi);
  };
  Matrix3 m = Matrix3::Identity();
  for (const Eigen::Index along : {0, 1}) {
    const auto k = static_cast<std::size_t>(along);
    const double first = slope(0, k), second = slope(1, k);
    if (axes.x) m(0, along) += diagonal_ ? 0.5 * (first + second) : first;
    if (axes.y) m(1, along) += diagonal_ ? 0.5 * (first - second) : second;
  }
  const double x = w.centre.x + 0.5 * i, y = w.centre.y + 0.5 * j;
  m(0, 2) = x - m(0, 0) * x - m(0, 1) * y;
  m(1, 2) = y - m(1, 0) * x - m(1, 1) * y;
  return PrintFromPrint(m);
}

double VisibilityMap::sum(const PatchWindow& window, int i, int j) const {
  const auto all = cells(window, i, j);
  return std::accumulate(all.begin(), all.end(), 0.0);
}

VisibilityMap presence_round(const LumaView& luma, const Grating& grating, const PrintFromImage& print_from_image,
                             const PatchWindow& window, const IsHidden& is_hidden) {
  const auto image_from_print = print_from_image.inverse();
  const Axes axes = axes_of(grating);
  const bool diagonal = fundamental_pitch_mm(grating) < 0.9 * grating.pitch_mm;
  const auto cells = [](double half) { return 2 * static_cast<int>(std::ceil(2.0 * half)) + 1; };
  const int columns = cells(window.half_x), rows = cells(window.half_y);
  const PrintPoint low{window.centre.x - 0.25 * (columns - 1), window.centre.y - 0.25 * (rows - 1)};
  // Points: one pitch around the middle of every cell.
  const int wide = (columns + 1) * kPerCell, high = (rows + 1) * kPerCell;
  Table table(wide, high);
  const auto across = turns(low.x - 0.5, wide), up = turns(low.y - 0.5, high);
  for (int j = 0; j < high; ++j) {
    for (int i = 0; i < wide; ++i) {
      const ImagePoint at =
          image_from_print({low.x - 0.5 + (i + 0.5) / kPerPitch, low.y - 0.5 + (j + 0.5) / kPerPitch});
      const auto grey = std::visit([&](const auto& picture) { return level(picture, at); }, luma);
      if (!grey || (is_hidden && is_hidden(at))) {
        table.set(i, j, {});
        continue;
      }
      const Complex x = across[static_cast<std::size_t>(i)], y = up[static_cast<std::size_t>(j)];
      const double g = *grey;
      const Complex first = g * (diagonal ? x * y : x), second = g * (diagonal ? x * std::conj(y) : y);
      table.set(i, j, {1.0, g, first.real(), first.imag(), second.real(), second.imag()});
    }
  }
  VisibilityMap presences(low, columns, rows, diagonal);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i)
      presences.at(i, j) =
          presence(table.over(i * kPerCell, j * kPerCell, (i + 2) * kPerCell, (j + 2) * kPerCell), axes);
  }
  return presences;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "studies/world/prints.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>

namespace world {
namespace {

constexpr double kTextureMm = 60.0;  // the texture of ink and paper repeats after this length

// Returns std::floor without a call of the library, which takes longer than the rest of a texture's value.
int floor_of(double x) {
  const int cut = static_cast<int>(x);
  return cut - static_cast<int>(x < cut);
}

// The Gaussian integral from -kEnd to kEnd, in steps: the renderer needs it for every sample near an edge.
constexpr int kSteps = 4096;
constexpr double kEnd = 5.0;
const std::vector<double> kIntegral = [] {
  std::vector<double> t;
  for (int i = 0; i <= kSteps + 1; ++i) t.push_back(0.5 * std::erfc(-(2.0 * i / kSteps - 1.0) * kEnd / std::sqrt(2.0)));
  return t;
}();

double normal_integral(double z) {
  if (z >= kEnd) return 1.0;
  if (z <= -kEnd) return 0.0;
  const double at = (z / kEnd + 1.0) * 0.5 * kSteps;
  const auto below = static_cast<std::size_t>(at);
  const double f = at - static_cast<double>(below);
  return kIntegral[below] + f * (kIntegral[below + 1] - kIntegral[below]);
}

}  // namespace

Texture::Texture(unsigned seed, int octaves) : values_(static_cast<std::size_t>(kSide) * kSide) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  double weight = 1.0, power = 0.0;
  for (int octave = 0, cells = 8; octave < octaves; ++octave, cells *= 2, weight *= 0.6) {
    std::vector<double> lattice(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
    for (double& v : lattice) v = normal(random);
    const auto node = [&](int i, int j) {
      return lattice[static_cast<std::size_t>(j % cells) * static_cast<std::size_t>(cells) +
                     static_cast<std::size_t>(i % cells)];
    };
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const double u = static_cast<double>(x) * cells / kSide, v = static_cast<double>(y) * cells / kSide;
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        const double a = u - i, b = v - j, f = a * a * (3 - 2 * a), g = b * b * (3 - 2 * b);
        const double value = (1 - g) * ((1 - f) * node(i, j) + f * node(i + 1, j)) +
                             g * ((1 - f) * node(i, j + 1) + f * node(i + 1, j + 1));
        values_[static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x)] +=
            static_cast<float>(weight * value);
      }
    }
  }
  for (const float v : values_) power += static_cast<double>(v) * static_cast<double>(v);
  const double scale = power > 0.0 ? 1.0 / std::sqrt(power / static_cast<double>(values_.size())) : 0.0;
  for (float& v : values_) v *= static_cast<float>(scale);
}

double Texture::at(double x, double y) const {
  const double u = x * kSide, v = y * kSide;
  const int i = floor_of(u), j = floor_of(v);
  const double a = u - i, b = v - j;
  const auto value = [&](int column, int row) {
    return static_cast<double>(
        values_[static_cast<std::size_t>(((row & (kSide - 1)) * kSide) + (column & (kSide - 1)))]);
  };
  return (1 - b) * ((1 - a) * value(i, j) + a * value(i + 1, j)) +
         b * ((1 - a) * value(i, j + 1) + a * value(i + 1, j + 1));
}

double Texture::nearest(double x, double y) const {
  const int i = floor_of(x * kSide) & (kSide - 1), j = floor_of(y * kSide) & (kSide - 1);
  return static_cast<double>(values_[static_cast<std::size_t>(j * kSide + i)]);
}

Wall::Wall(const DrawFile& draw) : texture_(static_cast<unsigned>(draw.number("wall.seed")), 7) {
  const auto numbers = draw.numbers("wall.surface", 5);
  z_mm_ = numbers[0], grey_ = numbers[1], contrast_ = numbers[2], size_mm_ = numbers[3], brick_mm_ = numbers[4];
}

double Wall::reflectance(double x_mm, double y_mm) const {
  double value = grey_ * (1.0 + contrast_ * texture_.at(x_mm / size_mm_, y_mm / size_mm_));
  if (brick_mm_ > 0.0) {
    const double course = std::floor(y_mm / (0.35 * brick_mm_));
    const double along = x_mm / brick_mm_ + 0.5 * std::fmod(std::abs(course), 2.0);
    const double joint_y = std::abs(y_mm / (0.35 * brick_mm_) - course - 0.5),
                 joint_x = std::abs(along - std::floor(along) - 0.5);
    if (joint_y > 0.45 || joint_x > 0.483) value *= 1.35;
  }
  return std::max(0.02, value);
}

Sheet::Sheet(const DrawFile& draw, const std::string& name)
    : name_(name),
      texture_(static_cast<unsigned>(draw.number("sheet." + name + ".seed")), 6),
      dx_mm_(draw.track("sheet." + name + ".dx_mm")),
      dy_mm_(draw.track("sheet." + name + ".dy_mm")),
      dz_mm_(draw.track("sheet." + name + ".dz_mm")),
      turn_x_rad_(draw.track("sheet." + name + ".turn_x_rad")),
      turn_y_rad_(draw.track("sheet." + name + ".turn_y_rad")),
      turn_z_rad_(draw.track("sheet." + name + ".turn_z_rad")) {
  static const std::map<std::string, Pattern> names = {
      {"none", Pattern::kNone},       {"grid", Pattern::kGrid},
      {"squares", Pattern::kSquares}, {"dots", Pattern::kDots},
      {"lines-x", Pattern::kLinesX},  {"lines-y", Pattern::kLinesY},
      {"leaf", Pattern::kLeaf},       {"checkerboard", Pattern::kCheckerboard}};
  const std::string prefix = "sheet." + name + ".";
  pattern_ = names.at(draw.words(prefix + "pattern").at(0));
  is_target_ = draw.number(prefix + "target") != 0.0;
  const auto place = draw.numbers(prefix + "place", 4);
  place_mm_ = {place[0], place[1], place[2]};
  angle_rad_ = place[3];
  const auto copy = [&](const char* key, double* to, std::size_t count) {
    const auto from = draw.numbers(prefix + key, count);
    std::copy(from.begin(), from.end(), to);
  };
  copy("paper_mm", paper_, 4);
  if (draw.has(prefix + "grating_mm")) copy("grating_mm", grating_, 4);
  if (draw.has(prefix + "circle_mm")) copy("circle_mm", circle_, 3);
  const auto print = draw.numbers(prefix + "print", 3), ink = draw.numbers(prefix + "ink", 6);
  pitch_mm_ = print[0], share_ = print[1], soft_mm_ = print[2];
  white_ = ink[0], black_ = ink[1], ink_rms_ = ink[2], paper_rms_ = ink[3], gloss_per_mm_x_ = ink[4],
  gloss_per_mm_y_ = ink[5];
}

Placement Sheet::placement(double time_s) const {
  const Mat3 mounted = rotation({0.0, 0.0, angle_rad_});
  const Mat3 moved = rotation({turn_x_rad_.at(time_s), turn_y_rad_.at(time_s), turn_z_rad_.at(time_s)}) * mounted;
  return {place_mm_ + Vec3{dx_mm_.at(time_s), dy_mm_.at(time_s), dz_mm_.at(time_s)}, moved.column[0], moved.column[1]};
}

std::vector<Ray> Sheet::outline_mm() const {
  const double w = 0.5 * paper_[2], h = 0.5 * paper_[3];
  return {{paper_[0] - w, paper_[1] - h},
          {paper_[0] + w, paper_[1] - h},
          {paper_[0] + w, paper_[1] + h},
          {paper_[0] - w, paper_[1] + h}};
}

double Sheet::edge(double inside_mm) const { return normal_integral(inside_mm / soft_mm_); }

double Sheet::line(double from_line_mm) const {
  const double nearest = from_line_mm - pitch_mm_ * floor_of(from_line_mm / pitch_mm_ + 0.5);
  return edge(0.5 * share_ * pitch_mm_ - std::abs(nearest));
}

double Sheet::rectangle(double x_mm, double y_mm, const double* box) const {
  return edge(0.5 * box[2] - std::abs(x_mm - box[0])) * edge(0.5 * box[3] - std::abs(y_mm - box[1]));
}

double Sheet::checkerboard(double x_mm, double y_mm) const {
  const double square = 0.5 * pitch_mm_;
  // The rim of the grating is an edge of squares. Without the clamp a white square would have a grey line there.
  const auto wave = [&](double at, double side) {
    const double end = 0.5 * (side - square), inside = std::clamp(at, -end, end);
    const int nearest = floor_of(inside / square + 0.5);
    const double sign = nearest % 2 == 0 ? 1.0 : -1.0;
    return sign * (2.0 * edge(inside - nearest * square) - 1.0);
  };
  return 0.5 * (1.0 + wave(x_mm, grating_[2]) * wave(y_mm, grating_[3]));
}

double Sheet::ink(double x_mm, double y_mm) const {
  switch (pattern_) {
    case Pattern::kGrid:
      return 1.0 - (1.0 - line(x_mm)) * (1.0 - line(y_mm));
    case Pattern::kSquares:
      return line(x_mm) * line(y_mm);
    case Pattern::kDots: {
      const double x = x_mm - pitch_mm_ * floor_of(x_mm / pitch_mm_ + 0.5),
                   y = y_mm - pitch_mm_ * floor_of(y_mm / pitch_mm_ + 0.5);
      return edge(0.5 * share_ * pitch_mm_ - std::sqrt(x * x + y * y));
    }
    case Pattern::kLinesX:
      return line(x_mm);
    case Pattern::kLinesY:
      return line(y_mm);
    case Pattern::kCheckerboard:
      return checkerboard(x_mm, y_mm);
    case Pattern::kNone:
    case Pattern::kLeaf:
      return 0.0;
  }
  return 0.0;
}

Surface Sheet::at(double x_mm, double y_mm) const {
  const double w = 0.5 * paper_[2], h = 0.5 * paper_[3], margin = 5.0 * soft_mm_;
  if (std::abs(x_mm - paper_[0]) > w + margin || std::abs(y_mm - paper_[1]) > h + margin) return {};
  const double rough = texture_.nearest(x_mm * (1.0 / kTextureMm), y_mm * (1.0 / kTextureMm));
  if (pattern_ == Pattern::kLeaf) {
    const double x = (x_mm - paper_[0]) / w, y = (y_mm - paper_[1]) / h;
    const double inside = 1.0 - std::sqrt(x * x + y * y) + 0.04 * rough;  // an ellipse with a rough rim
    return {white_ * (1.0 + paper_rms_ * rough), edge(inside * std::min(w, h))};
  }
  double share = 0.0;
  if (grating_[2] > 0.0) {
    const double window = rectangle(x_mm, y_mm, grating_);
    if (window > 0.0) share = window * ink(x_mm, y_mm);
  }
  if (circle_[2] > 0.0) {
    const double x = x_mm - circle_[0], y = y_mm - circle_[1];
    share = std::max(share, edge(0.5 * circle_[2] - std::sqrt(x * x + y * y)));
  }
  const double paper = white_ * (1.0 + paper_rms_ * rough), dark = black_ * (1.0 + ink_rms_ * rough);
  const double gloss = gloss_per_mm_x_ * (x_mm - paper_[0]) + gloss_per_mm_y_ * (y_mm - paper_[1]);
  return {paper + share * (dark - paper) + gloss, rectangle(x_mm, y_mm, paper_)};
}

}  // namespace world

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/assignments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include <Eigen/LU>

#include "moiregauge/geometry/symmetric_eigen.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::markers_detail {
namespace {

// Standard deviations of the local scale and shape given by one ellipse, for printing, lens (a few per cent over an
// image) and pixels. Relative and px terms are added in quadrature.
constexpr double kScaleSpread = 0.025;        // relative
constexpr double kScaleSpreadPx = 0.25;       // px of diameter
constexpr double kShapeSpread = 0.03;         // in ln(major / minor)
constexpr double kShapeSpreadPx = 0.35;       // px of diameter
constexpr double kLensSpread = 0.015;         // in layout sizes in the image: positions without lens correction
constexpr double kPositionSlack = 0.05;       // in layout sizes in the image: a circle farther away is another one
constexpr double kPositionSlackPx = 3.0;      // px, added to the relative slack
constexpr double kPositionSpreads = 3.0;      // coverage factor k of the stated positions, added to the slack
constexpr double kMaxMisfitPerCircle = 15.0;  // chi-squared with 3 degrees of freedom: exceeded once in 500
constexpr double kMissing = 25.0;             // misfit of a missing reference: five standard deviations (chosen)
constexpr double kDistanceSlack = 0.25;       // relative, of a distance measured in diameters: effect of perspective
constexpr double kMaxSizeSpan = 2.2;          // largest ratio of two diameters in px, per stated diameter (perspective)
constexpr double kMinTilt = 0.4;       // smallest axis ratio of the map; a circle with W > 0.84 has more than 0.5
constexpr double kMaxScaleSpan = 2.0;  // largest ratio of scales across the references (perspective)
constexpr std::size_t kMaxTries = 3'000'000;  // partial assignments, about a second
constexpr std::size_t kMaxBases = 15;         // sets of four references that start a search

// Local metric given by a detected ellipse.
struct Gauge {
  Eigen::Vector2d centre;         // px
  Eigen::Matrix2d px_from_board;  // px per mm (per diameter if no size is stated), up to a rotation
  Eigen::Matrix2d board_from_px;  // its inverse
};

Gauge gauge_of(const DetectedCircle& circle, double diameter_mm) {
  const double c = std::cos(circle.angle_rad), s = std::sin(circle.angle_rad);
  const Eigen::Matrix2d turn = (Eigen::Matrix2d() << c, -s, s, c).finished();
  const double major = circle.diameter_px / diameter_mm / std::sqrt(circle.axis_ratio);
  const Eigen::Vector2d scales(major, major * circle.axis_ratio);
  Gauge gauge;
  gauge.centre = {circle.centre.x, circle.centre.y};
  gauge.px_from_board = turn * scales.asDiagonal() * turn.transpose();
  gauge.board_from_px = turn * scales.cwiseInverse().asDiagonal() * turn.transpose();
  return gauge;
}

// Returns the distance of two circles on the board, measured in their diameters. The geometric mean of both metrics
// removes perspective to first order.
double gauged_distance(const Gauge& a, const Gauge& b) {
  const Eigen::Vector2d d = b.centre - a.centre;
  return std::sqrt((a.board_from_px * d).norm() * (b.board_from_px * d).norm());
}

// Returns ln(major / minor) as a vector at twice the angle of the major axis. A round shape gives the zero vector.
Eigen::Vector2d elongation(const Eigen::Matrix2d& symmetric) {
  const SymmetricEigen2 eigen = eigen_of(symmetric);
  const double log_ratio = std::log(eigen.values[1] / std::max(eigen.values[0], 1e-12));
  const Eigen::Vector2d major = eigen.vectors.col(1);
  return log_ratio * Eigen::Vector2d(major.x() * major.x() - major.y() * major.y(), 2.0 * major.x() * major.y());
}

class Searcher {
 public:
  Searcher(const std::vector<ReferenceCircle>& references, const std::vector<DetectedCircle>& seen, double position_mm,
           const std::function<bool(std::size_t, std::size_t)>& may_be)
      : references_(references), seen_(seen), position_mm_(position_mm) {
    sizes_stated_ =
        std::all_of(references.begin(), references.end(), [](const auto& r) { return r.diameter_mm > 0.0; });
    gauges_.resize(references.size());
    choices_.resize(references.size());
    for (std::size_t r = 0; r < references.size(); ++r) {
      for (std::size_t i = 0; i < seen.size(); ++i) {
        gauges_[r].push_back(gauge_of(seen[i], size_of(r)));
        if (may_be(r, i)) choices_[r].push_back(i);
      }
    }
  }

  AssignmentSearch run() {
    std::array<std::size_t, 4> base{};
    try_bases(base, 0);
    return std::move(out_);
  }

 private:
  // Tries every base of four references whose first `depth` members are given. Returns false if the search has to end.
  bool try_bases(std::array<std::size_t, 4>& base, std::size_t depth) {
    if (depth == base.size()) {
      if (out_.gave_up || bases_++ >= kMaxBases) return false;
      extend(base, {}, 0);
      return true;
    }
    const std::size_t still_needed = base.size() - 1 - depth;
    for (base[depth] = depth == 0 ? 0 : base[depth - 1] + 1; base[depth] + still_needed < references_.size();
         ++base[depth])
      if (!try_bases(base, depth + 1)) return false;
    return true;
  }

  [[nodiscard]] double size_of(std::size_t reference) const {
    return sizes_stated_ ? references_[reference].diameter_mm : 1.0;  // not stated: equal and unknown
  }

  [[nodiscard]] bool distances_agree(const std::array<std::size_t, 4>& base, const std::array<std::size_t, 4>& picked,
                                     std::size_t depth) const {
    const std::size_t j = base[depth];
    const Gauge& b = gauges_[j][picked[depth]];
    // Without stated sizes the first pair sets the unit.
    double unit = 1.0;
    if (!sizes_stated_ && depth > 1) {
      unit = gauged_distance(gauges_[base[0]][picked[0]], gauges_[base[1]][picked[1]]) /
             length(references_[base[1]].centre - references_[base[0]].centre);
    }
    for (std::size_t k = 0; k < depth; ++k) {
      if (picked[k] == picked[depth]) return false;
      const double sizes =
          seen_[picked[k]].diameter_px / size_of(base[k]) * size_of(j) / seen_[picked[depth]].diameter_px;
      if (sizes > kMaxSizeSpan || sizes < 1.0 / kMaxSizeSpan) return false;
      if (!sizes_stated_ && depth == 1) continue;
      const double measured = gauged_distance(gauges_[base[k]][picked[k]], b) / unit;
      const double stated = length(references_[j].centre - references_[base[k]].centre);
      if (std::abs(measured - stated) > kDistanceSlack * stated + kPositionSpreads * std::sqrt(2.0) * position_mm_)
        return false;
    }
    return true;
  }

  void extend(const std::array<std::size_t, 4>& base, std::array<std::size_t, 4> picked, std::size_t depth) {
    for (const std::size_t circle : choices_[base[depth]]) {
      if (++tries_ > kMaxTries) {
        out_.gave_up = true;
        return;
      }
      picked[depth] = circle;
      if (!distances_agree(base, picked, depth)) continue;
      if (depth == 3) {
        consider(base, picked);
      } else {
        extend(base, picked, depth + 1);
      }
      if (out_.gave_up) return;
    }
  }

  void consider(const std::array<std::size_t, 4>& base, const std::array<std::size_t, 4>& picked) {
    Assignment a;
    a.circle_of_reference.assign(references_.size(), -1);
    for (std::size_t k = 0; k < 4; ++k) a.circle_of_reference[base[k]] = static_cast<int>(picked[k]);
    if (!fit(a) || !plausible_view(a)) return;
    if (references_.size() > 4) {
      take_in_others(a);
      if (!fit(a) || !plausible_view(a)) return;
    }
    const bool known = std::any_of(out_.assignments.begin(), out_.assignments.end(),
                                   [&](const Assignment& b) { return b.circle_of_reference == a.circle_of_reference; });
    if (known) return;
    if (weigh(a)) out_.assignments.push_back(std::move(a));
  }

  [[nodiscard]] bool fit(Assignment& a) const {
    std::vector<BoardPoint> board;
    std::vector<ImagePoint> image;
    for (std::size_t r = 0; r < references_.size(); ++r) {
      if (a.circle_of_reference[r] < 0) continue;
      board.push_back(references_[r].centre);
      image.push_back(seen_[static_cast<std::size_t>(a.circle_of_reference[r])].centre);
    }
    const auto h = fit_homography<frame::Image, frame::Board>(board, image);
    if (h) a.image_from_board = *h;
    return h.has_value();
  }

  // Returns true for a possible map of a camera: a front view, references on one side of the horizon, limited tilt and
  // perspective. In a front view the determinant is negative, because y is up on the board and down in the image.
  [[nodiscard]] bool plausible_view(Assignment& a) const {
    double smallest = 1e300, largest = 0.0, sign = 0.0;
    BoardPoint middle;
    for (const ReferenceCircle& r : references_) {
      const Matrix3& h = a.image_from_board.matrix();
      const double w = h(2, 0) * r.centre.x + h(2, 1) * r.centre.y + h(2, 2);
      if (w * sign < 0.0 || std::abs(w) < 1e-12) return false;
      sign = w;
      const Matrix2 j = a.image_from_board.jacobian(r.centre);
      if (!(j.determinant() < 0.0)) return false;
      // The squared norm divided by |determinant| is r + 1 / r for an axis ratio r, and falls with r.
      if (j.squaredNorm() > (kMinTilt + 1.0 / kMinTilt) * -j.determinant()) return false;
      smallest = std::min(smallest, std::sqrt(-j.determinant()));
      largest = std::max(largest, std::sqrt(-j.determinant()));
      middle = middle + (1.0 / static_cast<double>(references_.size())) * (r.centre - BoardPoint{});
    }
    const Matrix2 j = a.image_from_board.jacobian(middle);
    a.roll_rad = std::atan2(-j(1, 0) - j(0, 1), j(0, 0) - j(1, 1));  // rotation nearest to diag(1, -1) J
    return largest < kMaxScaleSpan * smallest;
  }

  [[nodiscard]] double layout_px(const Assignment& a) const {
    double size = 0.0;
    for (const auto& r : references_) {
      for (const auto& q : references_) {
        size = std::max(size, length(a.image_from_board(r.centre) - a.image_from_board(q.centre)));
      }
    }
    return size;
  }

  void take_in_others(Assignment& a) const {
    const double stated = kPositionSpreads * position_mm_ * layout_px(a) / layout_mm();
    const double slack = kPositionSlack * layout_px(a) + kPositionSlackPx + stated;
    for (std::size_t r = 0; r < references_.size(); ++r) {
      if (a.circle_of_reference[r] >= 0) continue;
      const ImagePoint expected = a.image_from_board(references_[r].centre);
      double nearest = slack;
      for (const std::size_t i : choices_[r]) {
        const double away = length(seen_[i].centre - expected);
        const bool taken = std::find(a.circle_of_reference.begin(), a.circle_of_reference.end(), static_cast<int>(i)) !=
                           a.circle_of_reference.end();
        if (away >= nearest || taken || std::abs(size_misfit(a, r, i)) > 0.2) continue;
        nearest = away;
        a.circle_of_reference[r] = static_cast<int>(i);
      }
    }
  }

  // Returns ln(detected / expected diameter).
  [[nodiscard]] double size_misfit(const Assignment& a, std::size_t r, std::size_t circle) const {
    const double scale = std::sqrt(-a.image_from_board.jacobian(references_[r].centre).determinant());
    return std::log(seen_[circle].diameter_px / (scale * size_of(r)));
  }

  // Sums the squared residuals into a.misfit. Returns false if one circle exceeds its limit.
  [[nodiscard]] bool weigh(Assignment& a) const {
    std::vector<double> sizes(references_.size(), 0.0);
    double common = 0.0, circles = 0.0;
    for (std::size_t r = 0; r < references_.size(); ++r) {
      if (a.circle_of_reference[r] < 0) continue;
      sizes[r] = size_misfit(a, r, static_cast<std::size_t>(a.circle_of_reference[r]));
      common += sizes[r];
      circles += 1.0;
    }
    common = sizes_stated_ ? 0.0 : common / circles;
    const double px_per_mm = layout_px(a) / layout_mm();
    const double position_spread = std::hypot(kLensSpread * layout_px(a), position_mm_ * px_per_mm) + 1.0;
    for (std::size_t r = 0; r < references_.size(); ++r) {
      if (a.circle_of_reference[r] < 0) {
        a.misfit += kMissing;
        continue;
      }
      const auto i = static_cast<std::size_t>(a.circle_of_reference[r]);
      const double diameter = seen_[i].diameter_px;
      const Matrix2 j = a.image_from_board.jacobian(references_[r].centre);
      const Eigen::Matrix2d expected = symmetric_root(j * j.transpose());
      const double shape = (elongation(gauges_[r][i].px_from_board) - elongation(expected)).norm();
      const double stretch = map_spread(r);
      const double own =
          std::pow((sizes[r] - common) / std::hypot(kScaleSpread, kScaleSpreadPx / diameter, stretch), 2) +
          std::pow(shape / std::hypot(kShapeSpread, kShapeSpreadPx / diameter, stretch), 2);
      if (own > kMaxMisfitPerCircle) return false;
      const double off = length(a.image_from_board(references_[r].centre) - seen_[i].centre);
      a.misfit += own + std::pow(off / position_spread, 2);
    }
    return true;
  }

  // Returns the relative uncertainty of the map's scale near a reference, from the uncertainty of the stated positions.
  [[nodiscard]] double map_spread(std::size_t r) const {
    double spacing = 1e300;
    for (const auto& q : references_) {
      const double away = length(q.centre - references_[r].centre);
      if (away > 0.0) spacing = std::min(spacing, away);
    }
    constexpr double kPerspective = 1.3;  // factor for the apparent perspective caused by errors of the four corners
    return kPerspective * std::sqrt(2.0) * position_mm_ / spacing;
  }

  [[nodiscard]] double layout_mm() const {
    double size = 0.0;
    for (const auto& r : references_) {
      for (const auto& q : references_) size = std::max(size, length(r.centre - q.centre));
    }
    return size;
  }

  const std::vector<ReferenceCircle>& references_;
  const std::vector<DetectedCircle>& seen_;
  double position_mm_ = 0.0;
  bool sizes_stated_ = true;
  std::vector<std::vector<Gauge>> gauges_;         // [reference][circle]
  std::vector<std::vector<std::size_t>> choices_;  // [reference]
  std::size_t tries_ = 0;
  std::size_t bases_ = 0;  // tried so far
  AssignmentSearch out_;
};

}  // namespace

AssignmentSearch find_assignments(const std::vector<ReferenceCircle>& references,
                                  const std::vector<DetectedCircle>& seen, double position_mm,
                                  const std::function<bool(std::size_t, std::size_t)>& may_be) {
  return Searcher(references, seen, position_mm, may_be).run();
}

}  // namespace moiregauge::internal::markers_detail

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/circles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "moiregauge/detection/circles/candidate_outlines.h"
#include "moiregauge/detection/circles/circle_verdict.h"

namespace moiregauge::internal {
namespace {

using markers_detail::candidate_outlines;
using markers_detail::CandidateOutline;
using markers_detail::CircleVerdict;
using markers_detail::judge_circle;

// Two candidates are one outline, found at two scales, if centres and diameters differ by less (shares of the
// diameter).
constexpr double kSameCentreShare = 0.25;
constexpr double kSameDiameterShare = 0.2;
constexpr double kRejectedWorthNaming = 0.55;  // W; a less circular outline does not help the user (chosen)
constexpr std::size_t kMaxRejectedNamed = 64;  // limits the report

// Set of centres and diameters with a fast search by position.
class Places {
 public:
  explicit Places(double cell_px) : cell_px_(cell_px) {}
  [[nodiscard]] bool has(const Eigen::Vector2d& centre, double diameter) const {
    const auto reach = static_cast<int>(std::ceil(kSameCentreShare * diameter / cell_px_));
    const auto [cy, cx] = cell(centre);
    for (int y = cy - reach; y <= cy + reach; ++y) {
      for (auto it = places_.lower_bound({y, cx - reach}); it != places_.end() && it->first <= std::pair(y, cx + reach);
           ++it) {
        const auto& [where, size] = it->second;
        if ((where - centre).norm() < kSameCentreShare * diameter &&
            std::abs(size - diameter) < kSameDiameterShare * diameter) {
          return true;
        }
      }
    }
    return false;
  }
  void add(const Eigen::Vector2d& centre, double diameter) { places_.insert({cell(centre), {centre, diameter}}); }

 private:
  [[nodiscard]] std::pair<int, int> cell(const Eigen::Vector2d& p) const {
    const auto x = static_cast<int>(std::floor(p.x() / cell_px_)), y = static_cast<int>(std::floor(p.y() / cell_px_));
    return {y, x};
  }
  double cell_px_;
  std::multimap<std::pair<int, int>, std::pair<Eigen::Vector2d, double>> places_;
};

class Search {
 public:
  Search(const LumaView& luma, const CircleOptions& options)
      : luma_(luma), options_(options), known_(16.0), refused_(16.0) {}

  void look_at(const CandidateOutline& candidate) {
    if (known_.has(candidate.ellipse.centre, candidate.ellipse.diameter())) return;
    const CircleVerdict verdict = judge_circle(luma_, candidate.ellipse, options_);
    if (!verdict.circle) return refuse(candidate, verdict);
    const DetectedCircle& circle = *verdict.circle;
    const Eigen::Vector2d centre(circle.centre.x, circle.centre.y);
    if (known_.has(centre, circle.diameter_px)) return;
    known_.add(centre, circle.diameter_px);
    found_.circles.push_back(circle);
  }

  [[nodiscard]] CircleSearch finish() {
    const auto by_row = [](const auto& a, const auto& b) {
      return std::pair(a.centre.y, a.centre.x) < std::pair(b.centre.y, b.centre.x);
    };
    std::sort(found_.circles.begin(), found_.circles.end(), by_row);
    // An outline rejected at one scale may be a circle at another.
    std::erase_if(found_.rejected, [this](const RejectedOutline& r) {
      return known_.has({r.centre.x, r.centre.y}, r.diameter_px);
    });
    std::stable_sort(found_.rejected.begin(), found_.rejected.end(),
                     [](const auto& a, const auto& b) { return a.circularity > b.circularity; });
    if (found_.rejected.size() > kMaxRejectedNamed) found_.rejected.resize(kMaxRejectedNamed);
    return std::move(found_);
  }

 private:
  void refuse(const CandidateOutline& candidate, const CircleVerdict& verdict) {
    // Rays have a limited reach and may miss corners. The smaller of the two values is then the better one.
    const double circularity = std::min(verdict.circularity, candidate.circularity);
    if (circularity < kRejectedWorthNaming) return;
    const double diameter = candidate.ellipse.diameter();
    if (diameter < options_.min_diameter_px || diameter > options_.max_diameter_px) return;
    if (refused_.has(candidate.ellipse.centre, diameter)) return;
    refused_.add(candidate.ellipse.centre, diameter);
    found_.rejected.push_back(
        {{candidate.ellipse.centre.x(), candidate.ellipse.centre.y()}, diameter, circularity, verdict.why});
  }

  const LumaView& luma_;
  CircleOptions options_;
  Places known_, refused_;
  CircleSearch found_;
};

}  // namespace

double CircleSearch::best_rejected_circularity() const {
  double best = 0.0;
  for (const RejectedOutline& outline : rejected) best = std::max(best, outline.circularity);
  return best;
}

CircleSearch find_circles(const LumaView& luma, const CircleOptions& options) {
  Search search(luma, options);
  for (const CandidateOutline& candidate :
       candidate_outlines(luma, {options.min_diameter_px, options.max_diameter_px})) {
    search.look_at(candidate);
  }
  return search.finish();
}

std::vector<DetectedCircle> find_circles_near(const LumaView& luma, ImagePoint predicted, double diameter_px,
                                              double reach_px, const CircleOptions& options) {
  constexpr double kSizeSlack = 1.5;  // largest ratio of diameters between two frames (chosen)
  const double half = reach_px + diameter_px + 4.0;
  const int x0 = std::max(0, static_cast<int>(std::floor(std::clamp(predicted.x - half, 0.0, 1e6))));
  const int y0 = std::max(0, static_cast<int>(std::floor(std::clamp(predicted.y - half, 0.0, 1e6))));
  const int x1 = std::min(width_of(luma) - 1, static_cast<int>(std::ceil(std::clamp(predicted.x + half, -1.0, 1e6))));
  const int y1 = std::min(height_of(luma) - 1, static_cast<int>(std::ceil(std::clamp(predicted.y + half, -1.0, 1e6))));
  if (x1 - x0 < 8 || y1 - y0 < 8) return {};
  Search search(luma, options);
  const LumaView window = part_of(luma, x0, y0, x1 + 1, y1 + 1);
  const markers_detail::DiameterRange sizes{std::max(options.min_diameter_px, diameter_px / kSizeSlack),
                                            std::min(options.max_diameter_px, diameter_px * kSizeSlack)};
  for (CandidateOutline& candidate : candidate_outlines(window, sizes)) {
    candidate.ellipse.centre += Eigen::Vector2d(x0, y0);
    search.look_at(candidate);
  }
  std::vector<DetectedCircle> circles = search.finish().circles;
  std::erase_if(circles, [&](const DetectedCircle& c) { return length(c.centre - predicted) > reach_px; });
  std::sort(circles.begin(), circles.end(), [&](const DetectedCircle& a, const DetectedCircle& b) {
    return length(a.centre - predicted) < length(b.centre - predicted);
  });
  return circles;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// Plane-to-plane projective maps, seed paper Eq. (5).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>
#include <tl/expected.hpp>

#include "moiregauge/units/point.h"

namespace moiregauge::internal {

using Matrix3 = Eigen::Matrix3d;
using Matrix2 = Eigen::Matrix2d;

// Map of points of frame From to frame To: to = (h1 . p, h2 . p) / (h3 . p), p = (x, y, 1).
template <typename To, typename From>
class Homography {
 public:
  Homography() : h_(Matrix3::Identity()) {}
  explicit Homography(const Matrix3& h) : h_(h) {}
  [[nodiscard]] const Matrix3& matrix() const { return h_; }
  [[nodiscard]] Point<To> operator()(Point<From> p) const {
    const double w = h_(2, 0) * p.x + h_(2, 1) * p.y + h_(2, 2);
    return {(h_(0, 0) * p.x + h_(0, 1) * p.y + h_(0, 2)) / w, (h_(1, 0) * p.x + h_(1, 1) * p.y + h_(1, 2)) / w};
  }
  // Returns the derivative d(to)/d(from) at p.
  [[nodiscard]] Matrix2 jacobian(Point<From> p) const {
    const double w = h_(2, 0) * p.x + h_(2, 1) * p.y + h_(2, 2);
    const Point<To> q = (*this)(p);
    Matrix2 j;
    j << h_(0, 0) - q.x * h_(2, 0), h_(0, 1) - q.x * h_(2, 1), h_(1, 0) - q.y * h_(2, 0), h_(1, 1) - q.y * h_(2, 1);
    return j / w;
  }
  [[nodiscard]] Homography<From, To> inverse() const { return Homography<From, To>(h_.inverse()); }

 private:
  Matrix3 h_;
};

template <typename A, typename B, typename C>
[[nodiscard]] Homography<A, C> operator*(const Homography<A, B>& a, const Homography<B, C>& b) {
  return Homography<A, C>(a.matrix() * b.matrix());
}

enum class HomographyFailure { kTooFewPoints, kDegenerate };

namespace detail {
tl::expected<Matrix3, HomographyFailure> fit_homography(std::span<const Eigen::Vector2d> from,
                                                        std::span<const Eigen::Vector2d> to);
}  // namespace detail

// Fits the homography that maps `from` to `to`. Exact for four points. For more, it minimises the reprojection error in
// the unit of `to` (Gauss-Newton after a normalised direct linear solution).
// Fails: kTooFewPoints below four points, kDegenerate if three of four points (or all) are on a line.
template <typename To, typename From>
[[nodiscard]] tl::expected<Homography<To, From>, HomographyFailure> fit_homography(std::span<const Point<From>> from,
                                                                                   std::span<const Point<To>> to) {
  std::vector<Eigen::Vector2d> a, b;
  for (const auto& p : from) a.emplace_back(p.x, p.y);
  for (const auto& p : to) b.emplace_back(p.x, p.y);
  const auto h = detail::fit_homography(a, b);
  if (!h) return tl::unexpected(h.error());
  return Homography<To, From>(*h);
}

}  // namespace moiregauge::internal

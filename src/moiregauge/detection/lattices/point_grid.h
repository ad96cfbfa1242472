// SPDX-License-Identifier: Apache-2.0
// Spatial index of points: a grid of square cells with about two points each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace moiregauge::internal::markers_detail {

class NearPoints {
 public:
  explicit NearPoints(std::vector<Eigen::Vector2d> points) : points_(std::move(points)) {
    Eigen::AlignedBox2d box;
    for (const auto& p : points_) box.extend(p);
    if (points_.empty()) return;
    low_ = box.min();
    const auto n = static_cast<double>(points_.size());
    cell_px_ = std::max({std::sqrt(2.0 * box.volume() / n), box.sizes().maxCoeff() / 1000.0, 1.0});
    columns_ = static_cast<int>(box.sizes().x() / cell_px_) + 1;
    rows_ = static_cast<int>(box.sizes().y() / cell_px_) + 1;
    in_cell_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::size_t i = 0; i < points_.size(); ++i)
      in_cell_[cell_of(column(points_[i].x()), row(points_[i].y()))].push_back(i);
  }

  // Calls visitor(index) for all points within `reach` px.
  template <typename Visitor>
  void visit(const Eigen::Vector2d& at, double reach, Visitor visitor) const {
    if (points_.empty() || !at.allFinite()) return;
    for (int r = row(at.y() - reach); r <= row(at.y() + reach); ++r) {
      for (int c = column(at.x() - reach); c <= column(at.x() + reach); ++c) {
        for (const std::size_t i : in_cell_[cell_of(c, r)]) {
          if ((points_[i] - at).norm() <= reach) visitor(i);
        }
      }
    }
  }

  // Returns the indices of the `count` nearest points, nearest first.
  [[nodiscard]] std::vector<std::size_t> nearest(const Eigen::Vector2d& at, std::size_t count) const {
    std::vector<std::pair<double, std::size_t>> found;
    const double widest = cell_px_ * (columns_ + rows_);
    for (double reach = 2.0 * cell_px_;; reach *= 2.0) {
      found.clear();
      visit(at, reach, [&](std::size_t i) { found.emplace_back((points_[i] - at).norm(), i); });
      if (found.size() >= count || reach > widest) break;
    }
    std::sort(found.begin(), found.end());
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < std::min(count, found.size()); ++i) out.push_back(found[i].second);
    return out;
  }

 private:
  [[nodiscard]] int column(double x) const { return slot((x - low_.x()) / cell_px_, columns_); }
  [[nodiscard]] int row(double y) const { return slot((y - low_.y()) / cell_px_, rows_); }
  static int slot(double v, int count) { return static_cast<int>(std::clamp(std::floor(v), 0.0, count - 1.0)); }
  [[nodiscard]] std::size_t cell_of(int c, int r) const {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
  }

  std::vector<Eigen::Vector2d> points_;
  Eigen::Vector2d low_{0, 0};
  double cell_px_ = 1.0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<std::size_t>> in_cell_;
};

}  // namespace moiregauge::internal::markers_detail

// SPDX-License-Identifier: Apache-2.0
// One marker during one exposure: its window in the image, and the light that each pixel of it receives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "moiregauge/simulator/rendering/print.h"
#include "moiregauge/simulator/rendering/projection.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

// Movement of a marker on the sensor during a part of an exposure.
struct Movement {
  double way_px = 0.0;  // px, length of the path
  double sag_px = 0.0;  // px, distance of the path's middle from the chord
};

// Blur of points nearer or farther than the focus of the lens.
class Focus {
 public:
  explicit Focus(const Scenario& scenario);
  // Returns the variance in px^2, along one axis, of the image of a point at a depth of 1 / `per_depth` mm.
  [[nodiscard]] double variance(double per_depth) const {
    const double sigma = half_radius_ * (per_depth - per_focus_);
    return sigma * sigma;
  }

 private:
  double half_radius_ = 0.0;  // px mm; the standard deviation of a disc along one axis is half its radius
  double per_focus_ = 0.0;    // 1 / mm
};

class ExposedMarker {
 public:
  ExposedMarker(const Scenario& scenario, const SceneMarker& marker, long frame);
  // Returns the object in front of a marker in this frame.
  [[nodiscard]] static ExposedMarker cover_of(const Scenario& scenario, const SceneMarker& marker, long frame);
  // Window in px, right and bottom excluded; empty if the marker is outside the image.
  [[nodiscard]] int left() const { return left_; }
  [[nodiscard]] int right() const { return right_; }
  [[nodiscard]] int top() const { return top_; }
  [[nodiscard]] int bottom() const { return bottom_; }
  [[nodiscard]] bool covers_row(int y) const { return y >= top_ && y < bottom_ && left_ < right_; }
  // Lays the marker over the background of row y, in grey levels.
  void lay_over(int y, std::span<double> row) const;

 private:
  struct Moment {
    Matrix3 print_from_ray;
    double weight;  // in the mean over the exposure
  };
  struct Paper {
    double white;     // grey level
    double contrast;  // grey levels, white minus black
    double opacity = 1.0;
    double texture = 0.0;
    std::uint64_t seed = 0;
  };
  ExposedMarker(const Scenario& scenario, const SceneMarker& marker, long frame, PrintedMarker print, Paper paper);
  void choose_moments(const Scenario& scenario, const SceneMarker& marker, long frame);
  void choose_moments_about(const Scenario& scenario, const SceneMarker& marker, double middle_s);
  [[nodiscard]] std::span<const Moment> moments_of_row(int y) const;
  void add_moment_at(const Scenario& scenario, const SceneMarker& marker, double time_s, double weight);
  [[nodiscard]] Movement movement(const Scenario& scenario, const SceneMarker& marker, double from_s,
                                  double to_s) const;
  void find_window(const Scenario& scenario, const SceneMarker& marker, long frame);
  void see(const Moment& moment, const RayPatch& sight, double& paper, double& level) const;

  PrintedMarker print_;
  Camera camera_;
  Paper paper_;
  Ink ink_;
  Focus focus_;
  double disc_radius_px_;         // px, image of a point out of focus
  std::vector<ImagePoint> disc_;  // px, points of that disc with equal weights; empty: in focus
  int cells_ = 2;                 // a pixel is divided into cells x cells squares, each approximated by a Gaussian
  double cell_variance_ = 0.0;    // px^2, point spread and cell together
  double reach_px_ = 0.0;         // px, reach of the blur plus half a pixel's diagonal
  std::vector<Moment> moments_;
  // Index into moments_ per row, from top_ on, with one entry more than rows. Empty if all rows share all moments.
  std::vector<std::size_t> row_begins_;
  int left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;
};

}  // namespace moiregauge::internal::simulator

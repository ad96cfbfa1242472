// SPDX-License-Identifier: Apache-2.0
// Everything that reflects light: the wall, the printed sheets, and leaves in front of them.
#pragma once

#include <string>
#include <vector>

#include "studies/world/draw.h"
#include "studies/world/optics.h"
#include "studies/world/space.h"

namespace world {

// Smooth random values of mean 0 and rms 1 on a periodic plane: several octaves of random lattices.
class Texture {
 public:
  Texture(unsigned seed, int octaves);
  [[nodiscard]] double at(double x, double y) const;       // repeats after 1
  [[nodiscard]] double nearest(double x, double y) const;  // the same in steps of 1 / kSide, and faster

 private:
  static constexpr int kSide = 1024;
  std::vector<float> values_;
};

// The plane behind everything, with an optional pattern of bricks.
class Wall {
 public:
  explicit Wall(const DrawFile& draw);
  [[nodiscard]] double reflectance(double x_mm, double y_mm) const;
  [[nodiscard]] double z_mm() const { return z_mm_; }

 private:
  Texture texture_;
  double z_mm_, grey_, contrast_, size_mm_, brick_mm_;
};

// A plane that moves: its origin, and two axes of unit length, in board coordinates.
struct Placement {
  Vec3 origin_mm, along_x, along_y;
};

// Reflectance at a point, and the share of the light that is stopped there.
struct Surface {
  double reflectance = 0.0, opacity = 0.0;
};

// A sheet of paper with a circle, a grating or both, or a leaf. Its origin is the grating's symmetry point.
class Sheet {
 public:
  Sheet(const DrawFile& draw, const std::string& name);
  [[nodiscard]] Placement placement(double time_s) const;
  [[nodiscard]] Surface at(double x_mm, double y_mm) const;
  [[nodiscard]] std::vector<Ray> outline_mm() const;  // corners of the paper or leaf
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_target() const { return is_target_; }

 private:
  enum class Pattern { kNone, kGrid, kSquares, kDots, kLinesX, kLinesY, kCheckerboard, kLeaf };
  [[nodiscard]] double edge(double inside_mm) const;  // share of ink at a distance inside its edge
  [[nodiscard]] double line(double from_line_mm) const;
  [[nodiscard]] double ink(double x_mm, double y_mm) const;
  [[nodiscard]] double checkerboard(double x_mm, double y_mm) const;
  [[nodiscard]] double rectangle(double x_mm, double y_mm, const double* box) const;

  std::string name_;
  bool is_target_ = false;
  Pattern pattern_ = Pattern::kNone;
  Texture texture_;
  Vec3 place_mm_;
  double angle_rad_ = 0.0;
  Track dx_mm_, dy_mm_, dz_mm_, turn_x_rad_, turn_y_rad_, turn_z_rad_;
  double paper_[4]{}, grating_[4]{}, circle_[3]{};  // centre, width, height; centre and diameter, mm
  double pitch_mm_ = 1.0, share_ = 0.5, soft_mm_ = 0.1;
  double white_ = 0.9, black_ = 0.1, gloss_per_mm_x_ = 0.0, gloss_per_mm_y_ = 0.0, ink_rms_ = 0.0, paper_rms_ = 0.0;
};

}  // namespace world

// SPDX-License-Identifier: Apache-2.0
// Vectors, rotations and tracks of the renderer. It shares no code with the instrument.
#pragma once

#include <array>
#include <numbers>
#include <string>
#include <vector>

namespace world {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;
};

[[nodiscard]] inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
[[nodiscard]] inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
[[nodiscard]] inline Vec3 operator*(double k, const Vec3& a) { return {k * a.x, k * a.y, k * a.z}; }

// A matrix of three columns.
struct Mat3 {
  std::array<Vec3, 3> column{};
};

[[nodiscard]] inline Vec3 operator*(const Mat3& m, const Vec3& v) {
  return v.x * m.column[0] + v.y * m.column[1] + v.z * m.column[2];
}
[[nodiscard]] Mat3 operator*(const Mat3& a, const Mat3& b);
[[nodiscard]] Mat3 inverse(const Mat3& m);

// Returns the rotation about the axis of `turn_rad` by its length (Rodrigues 1840).
[[nodiscard]] Mat3 rotation(const Vec3& turn_rad);

// A value over time: offset, rate, sines, smooth steps and decaying vibrations.
class Track {
 public:
  Track() = default;
  // Reads "OFFSET RATE [sin AMPLITUDE HZ PHASE_RAD] [step HEIGHT TIME WIDTH] [jolt AMPLITUDE TIME HZ DECAY_S]".
  // Throws std::runtime_error at any other word.
  explicit Track(const std::vector<std::string>& words);
  [[nodiscard]] double at(double time_s) const;

 private:
  struct Sine {
    double amplitude, hz, phase_rad;
  };
  struct Step {
    double height, time_s, width_s;
  };
  struct Jolt {
    double amplitude, time_s, hz, decay_s;
  };
  double offset_ = 0.0, rate_per_s_ = 0.0;
  std::vector<Sine> sines_;
  std::vector<Step> steps_;
  std::vector<Jolt> jolts_;
};

}  // namespace world

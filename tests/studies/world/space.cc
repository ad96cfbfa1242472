// SPDX-License-Identifier: Apache-2.0
#include "studies/world/space.h"

#include <cmath>
#include <stdexcept>

namespace world {
namespace {

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

}  // namespace

Mat3 operator*(const Mat3& a, const Mat3& b) { return {{a * b.column[0], a * b.column[1], a * b.column[2]}}; }

Mat3 inverse(const Mat3& m) {
  const auto& [a, b, c] = m.column;
  const double scale = 1.0 / dot(a, cross(b, c));
  const Vec3 r = scale * cross(b, c), s = scale * cross(c, a), t = scale * cross(a, b);  // rows of the inverse
  return {{Vec3{r.x, s.x, t.x}, Vec3{r.y, s.y, t.y}, Vec3{r.z, s.z, t.z}}};
}

Mat3 rotation(const Vec3& turn_rad) {
  const double angle = std::sqrt(dot(turn_rad, turn_rad));
  if (angle == 0.0) return {{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}};
  const Vec3 axis = (1.0 / angle) * turn_rad;
  const double c = std::cos(angle), s = std::sin(angle);
  const auto turned = [&](const Vec3& v) { return c * v + s * cross(axis, v) + ((1.0 - c) * dot(axis, v)) * axis; };
  return {{turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})}};
}

Track::Track(const std::vector<std::string>& words) {
  std::size_t next = 0;
  const auto number = [&] {
    if (next >= words.size()) throw std::runtime_error("a track ends too early");
    return std::stod(words[next++]);
  };
  offset_ = number();
  rate_per_s_ = number();
  while (next < words.size()) {
    const std::string kind = words[next++];
    const double a = number(), b = number(), c = number();
    if (kind == "sin") {
      sines_.push_back({a, b, c});
    } else if (kind == "step") {
      steps_.push_back({a, b, c});
    } else if (kind == "jolt") {
      jolts_.push_back({a, b, c, number()});
    } else {
      throw std::runtime_error("unknown part of a track: " + kind);
    }
  }
}

double Track::at(double time_s) const {
  double value = offset_ + rate_per_s_ * time_s;
  for (const Sine& s : sines_) value += s.amplitude * std::sin(kTwoPi * s.hz * time_s + s.phase_rad);
  for (const Step& s : steps_) value += 0.5 * s.height * (1.0 + std::tanh((time_s - s.time_s) / s.width_s));
  for (const Jolt& j : jolts_) {
    const double since = time_s - j.time_s;
    if (since > 0.0) value += j.amplitude * std::exp(-since / j.decay_s) * std::sin(kTwoPi * j.hz * since);
  }
  return value;
}

}  // namespace world

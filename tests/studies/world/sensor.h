// SPDX-License-Identifier: Apache-2.0
// From light to a file of grey levels: electrons, noise, tone curve, rounding, PNG.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "studies/world/draw.h"
#include "studies/world/exposure.h"

namespace world {

class Sensor {
 public:
  explicit Sensor(const DrawFile& draw);
  // Returns the grey levels of a frame, 0 to 2^bits - 1. Every call draws new noise.
  [[nodiscard]] std::vector<std::uint16_t> levels(const Picture& light);
  [[nodiscard]] int bits() const { return bits_; }

 private:
  [[nodiscard]] double stored(double light) const;  // tone curve from 0 to 1
  std::mt19937_64 random_;
  std::string tone_;
  std::vector<float> gain_, dark_;
  double tone_value_, white_, full_well_, read_noise_, pedestal_;
  int bits_;
};

// Writes a grey PNG without tags of tone. Throws std::runtime_error or ends the program if the file cannot be written.
void write_png(const std::string& path, const std::vector<std::uint16_t>& levels, int width, int bits);

}  // namespace world

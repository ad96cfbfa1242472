// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/repeated_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace moiregauge::internal {
namespace {

constexpr double kSameStep = 0.125;  // largest difference within a step, relative to the least jump; chosen

// Two successive pixels of all lines: line i contributes its pixels x - 1 and x.
struct PixelPair {
  long shared = 0;  // lines in which a step on a slope begins with them
  long jumps = 0;   // lines with a jump between them
};

// Counts the steps of parallel lines.
class LineCounter {
 public:
  LineCounter(int length, double least_jump) : least_jump_(least_jump), pairs_(static_cast<std::size_t>(length)) {}

  // `at(i)`: the i-th grey level of a line.
  template <typename At>
  void add(At at) {
    double jump_before = 0.0;  // onto the current step; 0: unknown
    std::size_t begin = 0;     // first pixel of the step
    for (std::size_t i = 1; i < pairs_.size(); ++i) {
      const double jump = at(static_cast<int>(i)) - at(static_cast<int>(i) - 1);
      if (std::abs(jump) < kSameStep * least_jump_) continue;
      const bool is_jump = std::abs(jump) >= least_jump_;
      pairs_[i].jumps += is_jump;
      if (is_jump && jump * jump_before > 0.0) {
        ++all_;
        if (i - begin > 1) ++pairs_[begin + 1].shared;
      }
      jump_before = is_jump ? jump : 0.0;
      begin = i;
    }
  }

  // A repeated pixel is the same in all lines. Equal levels by noise are at pixels that differ in most lines.
  [[nodiscard]] SlopeSteps steps() const {
    SlopeSteps steps{all_, 0};
    for (const PixelPair& pair : pairs_) steps.repeated += std::max(0L, pair.shared - pair.jumps);
    return steps;
  }

 private:
  double least_jump_;
  long all_ = 0;
  std::vector<PixelPair> pairs_;  // by the second pixel
};

}  // namespace

SlopeSteps count_slope_steps(const LumaView& part, double least_jump) {
  return std::visit(
      [&](const auto& picture) {
        LineCounter rows(picture.width, least_jump), columns(picture.height, least_jump);
        for (int y = 0; y < picture.height; ++y) rows.add([&](int x) { return static_cast<double>(picture.at(x, y)); });
        for (int x = 0; x < picture.width; ++x)
          columns.add([&](int y) { return static_cast<double>(picture.at(x, y)); });
        const SlopeSteps along_x = rows.steps(), along_y = columns.steps();
        return SlopeSteps{along_x.all + along_y.all, along_x.repeated + along_y.repeated};
      },
      part);
}

}  // namespace moiregauge::internal

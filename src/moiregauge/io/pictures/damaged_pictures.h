// SPDX-License-Identifier: Apache-2.0
// Builds one warning about all images of an input that are missing or unreadable.
#pragma once

#include <string>
#include <vector>

namespace moiregauge::internal {

class DamagedPictures {
 public:
  // Adds a frame, in any order. `place` may be empty if `problem` contains it. Consecutive frames with the same problem
  // are one entry.
  void add(long frame, const std::string& problem, const std::string& place);
  // Returns one sentence for one damaged frame, or a list of at most six entries. Empty without damaged frames.
  [[nodiscard]] std::string text() const;

 private:
  struct Stretch {
    long first, last;
    std::string problem;
    std::string first_place, last_place;
  };
  std::vector<Stretch> stretches_;  // in frame order
  long frames_ = 0;
};

}  // namespace moiregauge::internal

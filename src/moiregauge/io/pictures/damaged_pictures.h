// SPDX-License-Identifier: Apache-2.0
// One warning about all pictures of an input that are missing or cannot be read.
#pragma once

#include <string>
#include <vector>

namespace moiregauge::internal {

class DamagedPictures {
 public:
  // Adds a frame, in any order. `place` may be empty where `problem` names it already. Frames that follow each other
  // with the same problem count as one entry.
  void add(long frame, const std::string& problem, const std::string& place);
  // Returns "frame 3 counts as damaged: ...", or a list of at most six entries; empty without a damaged frame.
  [[nodiscard]] std::string text() const;

 private:
  struct Stretch {
    long first, last;
    std::string problem;
    std::string first_place, last_place;
  };
  std::vector<Stretch> stretches_;  // by frame
  long frames_ = 0;
};

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// The fault corpus: short recordings in which one thing goes wrong, in several strengths, each drawn anew by a seed.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/encoder/video_writer.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::faults {

// One recording to make and measure.
struct Sequence {
  std::string mode;
  std::string strength;  // in words: "0.3 mm"
  simulator::Scenario scenario;
  std::optional<VideoFormat> video;  // written and read back through a file
};

struct Mode {
  std::string name;
  std::string what;    // one line for the table
  bool clean = false;  // nothing is wrong: every row that is not `ok` is a false alarm
  struct Strength {
    std::string words;
    std::function<void(Sequence&, int seed)> apply;
  };
  std::vector<Strength> strengths;
  // site.toml states with certainty what is wrong here, and no picture need contradict it: in the table, not in its
  // sum.
  bool vouched_for = false;
};

[[nodiscard]] const std::vector<Mode>& modes();

// The scene of a seed, with nothing wrong: four references or six, a lens or none, a camera that stands, turns slowly,
// sways or is posed anew for each of its ten frames; the markers stand as exactly as site.toml says, drawn anew. The
// target moves by up to 2 mm.
[[nodiscard]] simulator::Scenario scene_of(int seed);

[[nodiscard]] Sequence sequence_of(const Mode& mode, std::size_t strength, int seed);

}  // namespace moiregauge::internal::faults

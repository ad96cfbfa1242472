// SPDX-License-Identifier: Apache-2.0
// Fault corpus: short recordings with one fault each, in several strengths. A seed draws each recording.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/encoder/video_writer.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::faults {

// A recording to simulate and measure.
struct Sequence {
  std::string mode;
  std::string strength;  // text: "0.3 mm"
  simulator::Scenario scenario;
  std::optional<VideoFormat> video;  // written to a file and read back
};

struct Mode {
  std::string name;
  std::string what;    // one line for the table
  bool clean = false;  // no fault: every row that is not `ok` is a false alarm
  struct Strength {
    std::string words;
    std::function<void(Sequence&, int seed)> apply;
  };
  std::vector<Strength> strengths;
  // The fault is a wrong statement in site.toml that the images need not contradict. The mode is in the table, but not
  // in its sum.
  bool stated_by_site = false;
  bool processed = false;  // the camera's software processed the footage; the table is a section of its own
};

[[nodiscard]] const std::vector<Mode>& modes();

// Returns the scene of a seed, without a fault. It has four or six references, and a lens or none. The camera is fixed,
// rotates slowly, sways, or has a random pose in each of its ten frames. The markers deviate from site.toml as much as
// it states. The target moves by up to 2 mm.
[[nodiscard]] simulator::Scenario scene_of(int seed);

// Returns the recording of a mode and strength for a seed.
[[nodiscard]] Sequence sequence_of(const Mode& mode, std::size_t strength, int seed);

}  // namespace moiregauge::internal::faults

// SPDX-License-Identifier: Apache-2.0
#include "faults/fault_cases.h"

#include "faults/fault_modes.h"

namespace moiregauge::internal::faults {
namespace {

// --- nothing wrong

void add_clean(std::vector<Mode>& all) {
  std::vector<Mode::Strength> prints;
  for (const Pattern pattern :
       {Pattern::kGrid, Pattern::kSquares, Pattern::kDots, Pattern::kCheckerboard, Pattern::kCosine}) {
    prints.push_back({word_for(pattern), [pattern](Sequence& q, int) {
                        for (SceneMarker& m : q.scenario.markers) m.print.grating->pattern = pattern;
                      }});
  }
  all.push_back({"clean", "nothing is wrong: prints of five kinds", true, prints});
  std::vector<Mode::Strength> sensors;
  sensors.push_back({"12 bits", [](Sequence& q, int) { q.scenario.sensor.bits = 12; }});
  sensors.push_back({"shot noise", [](Sequence& q, int) { q.scenario.sensor.noise_gain = 0.03; }});
  sensors.push_back({"little noise", [](Sequence& q, int) { q.scenario.sensor.noise_sigma = 0.6; }});
  sensors.push_back({"vignetting", [](Sequence& q, int) {
                       q.scenario.light.vignetting = 0.3;
                       q.scenario.light.slope_x.offset = 0.1;
                     }});
  sensors.push_back({"soft lens", [](Sequence& q, int) { q.scenario.sensor.psf_sigma_px = 1.4; }});
  all.push_back({"clean, other cameras", "nothing is wrong: depth, noise, light and sharpness vary", true, sensors});
  all.push_back({"lossless video", "nothing is wrong: FFV1 through a file", true, {{"ffv1", [](Sequence& q, int) {
                                                                                      VideoFormat format;
                                                                                      format.width =
                                                                                          q.scenario.camera.width;
                                                                                      format.height =
                                                                                          q.scenario.camera.height;
                                                                                      q.video = format;
                                                                                    }}}});
}

}  // namespace

const std::vector<Mode>& modes() {
  static const std::vector<Mode> all = [] {
    std::vector<Mode> list;
    for (const auto add_some : {add_clean, add_covers, add_glare, add_optics, add_blur, add_light, add_prints,
                                add_moves, add_identity, add_first_frames, add_timing, add_codecs})
      add_some(list);
    std::vector<Mode> processed;
    add_processing(processed);
    for (Mode& mode : processed) {
      mode.processed = true;
      list.push_back(std::move(mode));
    }
    return list;
  }();
  return all;
}

}  // namespace moiregauge::internal::faults

// SPDX-License-Identifier: Apache-2.0
// Rendered recording of the simulator's small rig, with its reference frame and templates.
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "moiregauge/observation/frame/observe.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::test {

struct SmallRig {
  simulator::Scenario scenario;
  Reference reference;
  explicit SmallRig(simulator::Scenario what) : SmallRig(what, simulator::site_of(what)) {}
  // `stated`: the site as the user states it.
  SmallRig(simulator::Scenario what, const Site& stated) : scenario(std::move(what)) {
    const auto first = picture(0);
    reference = make_reference({first.view(), 8}, stated, Camera{}, {}).value();
    learn_prints({first.view(), 8}, reference);
  }
  [[nodiscard]] Image<std::uint8_t> picture(long frame) const { return rendered(scenario, frame); }
  [[nodiscard]] static Image<std::uint8_t> rendered(const simulator::Scenario& scenario, long frame) {
    return render8(scenario, frame, {0, simulator::Area::kMarkersOnly});
  }
  [[nodiscard]] std::size_t index_of(const std::string& name) const {
    std::size_t i = 0;
    while (reference.site.markers.at(i).name != name) ++i;
    return i;
  }
};

inline simulator::SceneMarker& marker_of(simulator::Scenario& scenario, const std::string& name) {
  return *std::ranges::find(scenario.markers, name, [](const auto& m) { return m.print.name; });
}

// Predicts that neither camera nor targets moved since the reference frame.
inline Prediction as_at_rest(const Reference& reference) {
  Prediction p;
  p.view = p.expected = reference.seen.stage1;
  p.travel.resize(reference.site.markers.size());
  p.travel_expected = p.travel;
  return p;
}

}  // namespace moiregauge::internal::test

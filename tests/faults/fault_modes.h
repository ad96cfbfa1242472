// SPDX-License-Identifier: Apache-2.0
// Shared parts of the corpus's modes. A pitch is 10 mm and 29 px, a grating is 30 or 40 mm wide.
#pragma once

#include <functional>
#include <initializer_list>
#include <vector>

#include <fmt/format.h>

#include "faults/fault_cases.h"

namespace moiregauge::internal::faults {

using simulator::Knot;
using simulator::SceneMarker;
using simulator::Track;

inline constexpr double kPxPerMm = 3478.26 / 1200.0;

inline SceneMarker& marker(Sequence& q, const char* name) {
  for (SceneMarker& m : q.scenario.markers) {
    if (m.print.name == name) return m;
  }
  return q.scenario.markers.front();
}
inline SceneMarker& target(Sequence& q) { return marker(q, "mid"); }
inline SceneMarker& reference(Sequence& q, int seed) { return q.scenario.markers[static_cast<std::size_t>(seed) % 4]; }

// A fault starts after frame 3. In every fourth recording it is there from the first frame on.
inline double onset_s(int seed) { return seed % 4 == 3 ? -1.0 : 3.5; }
inline std::vector<simulator::FrameSpan> from_onset(int seed) { return {{seed % 4 == 3 ? 0 : 4, 100}}; }
inline std::vector<Knot> step(int seed, double value, double rest = 0.0) {
  return {{onset_s(seed), rest}, {onset_s(seed) + 0.1, value}};
}

using Change = std::function<void(Sequence&, int seed, double strength)>;

inline std::vector<Mode::Strength> strengths(const char* words, std::initializer_list<double> values,
                                             const Change& change) {
  std::vector<Mode::Strength> list;
  for (const double value : values) {
    list.push_back(
        {fmt::format(fmt::runtime(words), value), [change, value](Sequence& q, int seed) { change(q, seed, value); }});
  }
  return list;
}

inline void add(std::vector<Mode>& all, const char* name, const char* what, const char* words,
                std::initializer_list<double> values, const Change& change) {
  all.push_back({name, what, false, strengths(words, values, change)});
}

inline void cover(SceneMarker& m, int seed, double share, double height_share) {
  m.cover.frames = from_onset(seed);
  m.cover.share = share;
  m.cover.height_share = height_share;
  m.cover.grey = seed % 3 == 0 ? 30.0 : 120.0;
  m.cover.texture = seed % 2 == 0 ? 0.0 : 15.0;
}

// fault_modes_scene.cc
void add_covers(std::vector<Mode>& all);
void add_glare(std::vector<Mode>& all);
void add_prints(std::vector<Mode>& all);
void add_moves(std::vector<Mode>& all);
void add_identity(std::vector<Mode>& all);
void add_first_frames(std::vector<Mode>& all);
// fault_modes_camera.cc
void add_optics(std::vector<Mode>& all);
void add_blur(std::vector<Mode>& all);
void add_light(std::vector<Mode>& all);
void add_timing(std::vector<Mode>& all);
void add_codecs(std::vector<Mode>& all);
// fault_modes_processing.cc
void add_processing(std::vector<Mode>& all);

}  // namespace moiregauge::internal::faults

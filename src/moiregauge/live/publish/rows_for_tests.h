// SPDX-License-Identifier: Apache-2.0
// A live run with two targets for the tests of outlets.
#pragma once

#include <cmath>

#include "moiregauge/live/publisher.h"

namespace moiregauge::internal::test {

inline LiveRun two_targets() {
  LiveRun run;
  run.source = "camera:test";
  run.markers = {"R1", "R2", "R3", "R4", "T1", "T2"};
  run.targets = {4, 5};
  return run;
}

// T1 moves by 3 sin(2 pi t) mm along y. T2 is lost.
inline PublishedFrame frame_with_rows(long number, double fps) {
  constexpr double kTwoPiHere = 6.283185307179586;
  PublishedFrame frame;
  frame.frame = number;
  frame.time_s = static_cast<double>(number) / fps;
  frame.host_ns = static_cast<std::int64_t>(1e9 * frame.time_s) + 5'000'000'000;
  frame.utc_ns = 1'700'000'000'000'000'000 + static_cast<std::int64_t>(1e9 * frame.time_s);
  Sample moving;
  moving.frame = number;
  moving.time_s = frame.time_s;
  moving.marker = 4;
  moving.displacement = {0.25, 3.0 * std::sin(kTwoPiHere * frame.time_s)};
  moving.u = {0.002, 0.001};
  moving.status = Status::kOk;
  Sample lost;
  lost.frame = number;
  lost.time_s = frame.time_s;
  lost.marker = 5;
  frame.rows = {moving, lost};
  frame.health.frames = number + 1;
  frame.health.rows = 2 * (number + 1);
  frame.health.ok_rows = number + 1;
  frame.health.frames_per_s = fps;
  frame.health.latency_p50_ms = 3.5;
  frame.health.latency_p99_ms = 9.0;
  return frame;
}

}  // namespace moiregauge::internal::test

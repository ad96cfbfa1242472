// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/journal/run_identity.h"

#include <fmt/format.h>

#include "moiregauge/io/journal/run_layout.h"

namespace moiregauge::internal {
namespace {

// Returns true if both have the same bits, NaN included.
template <typename Value>
bool same(const Value& a, const Value& b) {
  ByteWriter of_a, of_b;
  store(of_a, a);
  store(of_b, b);
  return of_a.bytes() == of_b.bytes();
}

}  // namespace

std::optional<std::string> difference(const StoredRun& kept, const RunStart& start, const MeasureOptions& options) {
  const MeasureOptions& then = kept.options;
  if (kept.start.version != start.version)
    return fmt::format("version {} started it, this is {}", kept.start.version, start.version);
  if (kept.start.fingerprint != start.fingerprint)
    return fmt::format("the input has changed since then, or is not {}", kept.start.input.path);
  if (then.method != options.method)
    return fmt::format("--method was {} and is now {}", then.method->name, options.method->name);
  if (!same(then.pitch_mm, options.pitch_mm)) return "--pitch differs";
  if (!same(then.choice, options.choice)) return "the choice of markers differs";
  if (!same(then.site, options.site)) return "the site file differs";
  if (!same(then.channels, options.channels)) return "the channels of the site file differ";
  if (!same(then.observe.area, options.observe.area)) return "--region or --exclude-region differs";
  if (!same(then.axes, options.axes)) return "--axes differs";
  if (!same(then.camera, options.camera) || !same(then.solve.u_camera, options.solve.u_camera))
    return "--camera differs";
  if (!same(then.frames, options.frames)) return "--frames differs";
  if (!same(then.reference_frame, options.reference_frame)) return "--reference-frame differs";
  if (!same(then.observe.template_use, options.observe.template_use)) return "--template differs";
  if (!same(then.tone, options.tone)) return "--tone differs";
  if (!same(kept.start.fps, start.fps)) return "--fps differs";
  if (!same(kept.start.input.slow_motion, start.input.slow_motion)) return "--slow-motion differs";
  if (kept.start.sequence != start.sequence) return "--sequence differs";
  MeasureOptions as_then = options;
  as_then.solve.rest = then.solve.rest;  // --rest and --zero do not change the observations
  as_then.zero = then.zero;
  if (!same(then, as_then)) return "other options differ";
  return std::nullopt;
}

}  // namespace moiregauge::internal

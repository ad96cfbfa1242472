// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/journal/run_identity.h"

#include <fmt/format.h>

#include "moiregauge/io/journal/run_layout.h"

namespace moiregauge::internal {
namespace {

// Equal to the last bit, NaN and all.
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
    return fmt::format("it was begun by version {}, this is {}", kept.start.version, start.version);
  if (kept.start.fingerprint != start.fingerprint)
    return fmt::format("the input is another one than {} was then", kept.start.input.path);
  if (then.method != options.method)
    return fmt::format("--method was {}, now it is {}", then.method->name, options.method->name);
  if (!same(then.pitch_mm, options.pitch_mm)) return "--pitch is another one";
  if (!same(then.site, options.site)) return "the site file says something else";
  if (!same(then.axes, options.axes)) return "--axes is another one";
  if (!same(then.camera, options.camera) || !same(then.solve.u_camera, options.solve.u_camera))
    return "--camera says something else";
  if (!same(then.frames, options.frames)) return "--frames selects others";
  if (!same(then.reference_frame, options.reference_frame)) return "--reference-frame is another one";
  if (!same(then.observe.template_use, options.observe.template_use)) return "--template is another one";
  if (!same(then.tone, options.tone)) return "--tone is another one";
  if (!same(kept.start.fps, start.fps)) return "--fps is another one";
  if (kept.start.sequence != start.sequence) return "--sequence was given once only";
  MeasureOptions as_then = options;
  as_then.solve.rest = then.solve.rest;  // frames are looked at alike whatever is said of their rest
  if (!same(then, as_then)) return "its options are others";
  return std::nullopt;
}

}  // namespace moiregauge::internal

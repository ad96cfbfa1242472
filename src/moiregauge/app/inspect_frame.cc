// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/inspect_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "moiregauge/run/codec.h"

namespace moiregauge::internal {
namespace {

// Includes the codec's part, as `measure` will. The next frame shows whether the codec predicts; the coarser of both
// steps counts.
std::vector<ExpectedUncertainty> expected_in(Reference& reference, const QuantiserMap& quantiser,
                                             const NextQuantiser& next) {
  note_quantisers(quantiser, reference.site, reference.lens, reference.seen);
  Observation next_seen = reference.seen;
  if (const auto later = next()) note_quantisers(*later, reference.site, reference.lens, next_seen);
  std::vector<Quantiser> later;
  for (std::size_t i = 0; i < next_seen.markers.size(); ++i) {
    const Quantiser &now = reference.seen.markers[i].quantiser, &then = next_seen.markers[i].quantiser;
    later.push_back({std::isnan(now.step) || std::isnan(then.step) ? kUnknownStep : std::max(now.step, then.step),
                     now.predicted || then.predicted});
  }
  return expected_uncertainties(reference, later);
}

// With a scale, the exit code says whether this can be a reference frame. Without, whether anything was detected.
bool is_usable(const Inspection& seen, bool is_scaled) {
  return seen.reference || (!is_scaled && (!seen.patches.empty() || !seen.lattices.empty()));
}

}  // namespace

tl::expected<InspectOptions, UsageError> parse_inspect_options(const MeasureArgs& args) {
  MeasureArgs known = args;
  const bool is_scaled = !known.site.empty() || !known.pitch.empty();
  if (!is_scaled) known.pitch = "1mm";  // required, but not used
  auto parsed = parse_measure_options(known);
  if (!parsed) return tl::unexpected(parsed.error());
  InspectOptions options;
  if (!known.site.empty()) options.site = std::move(parsed->site);
  if (is_scaled) options.pitch_mm = parsed->pitch_mm;
  options.axes = parsed->axes;
  options.lens = parsed->camera.value_or(Camera{});
  options.observe = parsed->observe;
  options.choice = parsed->choice;
  return options;
}

InspectReport inspect_frame(const InputInfo& input, const Frame& frame, const InspectOptions& options,
                            const NextQuantiser& next) {
  InspectReport report{input, frame.number, frame.time_s, inspect_picture({frame.luma, input.bits}, options), {}, {}};
  if (report.seen.reference) report.expected = expected_in(*report.seen.reference, frame.quantiser, next);
  report.exit = is_usable(report.seen, has_scale(options)) ? Exit::kMeasured : Exit::kRefused;
  return report;
}

}  // namespace moiregauge::internal

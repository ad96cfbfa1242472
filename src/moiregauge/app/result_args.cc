// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/result_args.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

bool is_same(const MarkerChoice& a, const MarkerChoice& b) {
  const auto same_name = [](const NewName& x, const NewName& y) { return x.from == y.from && x.to == y.to; };
  return a.references == b.references && a.targets == b.targets && a.ignored == b.ignored &&
         std::equal(a.names.begin(), a.names.end(), b.names.begin(), b.names.end(), same_name);
}

std::vector<std::string> region_texts(const std::vector<PixelRegion>& regions) {
  std::vector<std::string> texts;
  texts.reserve(regions.size());
  for (const PixelRegion& r : regions)
    texts.push_back(fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}", r.x, r.y, r.width, r.height));
  return texts;
}

std::string range_text(const FrameRange& range) {
  if (!range.seconds)
    return range.end < 0 ? fmt::format("{}:", range.first) : fmt::format("{}:{}", range.first, range.end);
  const std::string end = std::isfinite(range.seconds->end_s) ? fmt::format("{:.17g}s", range.seconds->end_s) : "";
  return fmt::format("{:.17g}s:{}", range.seconds->first_s, end);
}

// Returns the argument that gives the results' range. Empty: the run was measured with it.
std::string range_arg(const std::optional<FrameRange>& results, const std::optional<FrameRange>& measured) {
  if (!results) return measured ? "none" : "";
  return measured && range_text(*measured) == range_text(*results) ? "" : range_text(*results);
}

void complete_times(const ResultOptions& results, const InputInfo& measured, SolveArgs& args) {
  if (args.fps || args.slow_motion) return;
  if (results.slow_motion != measured.slow_motion) args.slow_motion = results.slow_motion;
  const bool has_other_rate = results.time_source != measured.time_source || results.fps != measured.fps;
  if (results.time_source == "fps-option" && results.fps && has_other_rate)
    args.fps = *results.fps / results.slow_motion;
}

}  // namespace

SolveArgs with_options_of_results(SolveArgs args, const ResultOptions& results, const StoredRun& measured) {
  const MeasureOptions& options = measured.options;
  if (args.method.empty() && results.method != options.method->name) args.method = results.method;
  const MarkerChoiceArgs& choice = args.choice;
  const bool has_choice =
      !(choice.references.empty() && choice.targets.empty() && choice.ignored.empty() && choice.names.empty());
  if (!has_choice && !is_same(results.choice, options.choice)) {
    args.choice.references = results.choice.references;
    args.choice.targets = results.choice.targets;
    args.choice.ignored = results.choice.ignored;
    for (const NewName& name : results.choice.names) args.choice.names.push_back(name.from + "=" + name.to);
  }
  if (choice.regions.empty() && choice.excluded_regions.empty()) {
    const SearchArea& area = options.observe.area;
    if (region_texts(results.area.regions) != region_texts(area.regions) ||
        region_texts(results.area.excluded) != region_texts(area.excluded)) {
      args.choice.regions = region_texts(results.area.regions);
      args.choice.excluded_regions = region_texts(results.area.excluded);
    }
  }
  if (args.rest.empty()) args.rest = range_arg(results.rest, options.solve.rest);
  if (args.zero.empty()) args.zero = range_arg(results.zero, options.zero);
  if (args.readout.empty() && results.readout_s && results.readout_s != options.solve.readout_s)
    args.readout = fmt::format("{:.17g}s", *results.readout_s);
  const double u = options.print_scale.u;
  if (args.print_scale.factor.empty() &&
      (results.print_scale != options.print_scale.factor || results.u_print_scale.value_or(0.0) != u)) {
    args.print_scale.factor = fmt::format("{:.17g}", results.print_scale);
    args.print_scale.u = results.u_print_scale;
  }
  complete_times(results, measured.seen.input, args);
  return args;
}

}  // namespace moiregauge::internal

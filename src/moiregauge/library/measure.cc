// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/measure.h"

#include <cmath>
#include <utility>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/app/open_input.h"
#include "moiregauge/library/convert.h"

namespace moiregauge {
namespace {

Result to_result(const internal::Measurement& measured, const internal::MeasureOptions& options) {
  Result result;
  const internal::Site& site = internal::site_of(measured, options);
  result.site = internal::to_public(site);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (site.markers[i].role != internal::Role::kTarget || !measured.reference) continue;
    Target target;
    target.name = site.markers[i].name;
    for (const internal::Sample& sample : measured.samples)
      if (sample.marker == i) target.samples.push_back(internal::to_public(sample));
    for (const internal::TargetSummary& summary : measured.targets) {
      if (summary.marker != i) continue;
      target.ok = summary.ok;
      target.u_dx_mm = summary.u.x;
      target.u_dy_mm = summary.u.y;
    }
    result.targets.push_back(std::move(target));
  }
  if (const auto& scene = internal::stated_scene(measured); scene && scene->solved)
    result.camera = internal::to_public(scene->camera);
  if (measured.reference) result.reference_frame = measured.reference->seen.frame;
  result.references_verified = measured.references_verified;
  result.warnings = measured.warnings;
  result.refusal = measured.refusal;
  result.exit_code = static_cast<int>(measured.exit);
  return result;
}

internal::RunCallbacks callbacks_of(const MeasureOptions& options) {
  internal::RunCallbacks callbacks;
  if (options.on_progress)
    callbacks.on_progress = [&options](const internal::RunProgress& p) {
      return options.on_progress(p.done, p.expected);
    };
  return callbacks;
}

// Measures without writing anything.
Expected<Result> measure_in_memory(const internal::RunRequest& request, const MeasureOptions& options) {
  const auto open = [&] { return internal::open_input(request.input, request.input_options); };
  const auto on_progress = [&](long done, long expected) {
    return !options.on_progress || options.on_progress(done, expected);
  };
  const auto measured = internal::measure(open, request.options, on_progress);
  if (!measured) return internal::public_error(internal::Exit::kInputUnreadable, measured.error().message);
  if (!measured->contradiction.empty())
    return internal::public_error(internal::Exit::kUsage, measured->contradiction + ": correct the option");
  return to_result(*measured, request.options);
}

}  // namespace

const char* to_string(Status status) {
  constexpr const char* kWords[] = {
      "ok",   "untrusted",      "camera-moved",   "blurred",      "saturated", "partly-covered",
      "lost", "reference-lost", "order-unproven", "decode-error", "too-coarse"};
  return kWords[static_cast<std::size_t>(status)];
}

Expected<Result> measure(const std::string& input, const MeasureOptions& options) {
  auto wanted = internal::to_internal(options);
  if (!wanted) return tl::unexpected(wanted.error());
  internal::RunRequest request;
  request.input = input;
  request.input_options.fps = options.fps;
  request.input_options.slow_motion = options.slow_motion;
  request.input_options.threads = options.threads;
  request.options = *std::move(wanted);
  request.output = options.output;
  if (request.output.empty()) return measure_in_memory(request, options);
  const internal::RunCallbacks callbacks = callbacks_of(options);
  const auto finished = internal::run_measurement(request, callbacks);
  if (!finished) return internal::public_error(finished.error().exit, finished.error().message);
  Result result = to_result(finished->measurement, request.options);
  result.folder = finished->folder;
  return result;
}

}  // namespace moiregauge

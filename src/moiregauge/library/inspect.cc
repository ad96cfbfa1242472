// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "moiregauge/app/inspection/inspect_input.h"
#include "moiregauge/library/convert.h"
#include "moiregauge/observation/reference/scale_check.h"
#include "moiregauge/run.h"

namespace moiregauge {
namespace {

using Args = std::pair<internal::InspectArgs, internal::InspectOptions>;

Expected<Args> args_of(const InspectOptions& options) {
  const auto refuse = [](std::string message) {
    return internal::public_error(internal::Exit::kUsage, std::move(message));
  };
  if ((options.pitch ? 1 : 0) + (options.site ? 1 : 0) + (options.site_file.empty() ? 0 : 1) > 1)
    return refuse("the scale is stated twice: InspectOptions: set one of pitch, site and site_file");
  if (options.pitch && !(options.pitch->value() > 0.0))
    return refuse("the pitch is not above 0: InspectOptions: set pitch, e.g. 10_mm");
  internal::InspectArgs args;
  args.frame = options.frame;
  args.measure.site = options.site_file;
  args.measure.camera = options.camera_file;
  args.measure.fps = options.fps;
  auto parsed = internal::inspect_options(args);
  if (!parsed) return refuse(parsed.error().message);
  if (options.pitch) parsed->pitch_mm = options.pitch->value();
  if (options.site) {
    auto site = internal::to_internal(*options.site);
    if (!site) return tl::unexpected(site.error());
    parsed->site = *std::move(site);
  }
  return Args{std::move(args), *std::move(parsed)};
}

std::vector<InspectedMarker> markers_of(const internal::InspectReport& report) {
  const internal::Reference& reference = *report.seen.reference;
  const bool has_mm = report.seen.unit == internal::BoardUnit::kMillimetre;
  std::vector<InspectedMarker> out;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const internal::Marker& marker = reference.site.markers[i];
    const internal::BoardPoint at = marker.grating ? marker.grating->centre : marker.circle->centre;
    const internal::ImagePoint px = reference.view(at);
    InspectedMarker shown;
    shown.name = marker.name;
    shown.is_reference = marker.role == internal::Role::kReference;
    shown.x_px = px.x;
    shown.y_px = px.y;
    if (marker.grating) shown.pitch_px = marker.grating->pitch_mm / reference.view.mm_per_px(at);
    if (has_mm) shown.x_mm = at.x, shown.y_mm = at.y;
    for (const internal::ExpectedUncertainty& expected : report.expected)
      if (has_mm && expected.marker == i) shown.u_dx_mm = expected.u.x, shown.u_dy_mm = expected.u.y;
    out.push_back(std::move(shown));
  }
  return out;
}

Expected<Inspection> shown(const tl::expected<internal::InspectedFrame, internal::RunFailure>& inspected) {
  if (!inspected) return internal::public_error(inspected.error().exit, inspected.error().message);
  const internal::Inspection& seen = inspected->report.seen;
  Inspection out;
  out.width = seen.width;
  out.height = seen.height;
  out.circles = seen.circles.size();
  out.gratings = seen.patches.size();
  out.problem = seen.missing;
  out.warnings = seen.notes;
  out.json = internal::inspect_json_text(inspected->report);
  out.overlay_png = internal::overlay_of_inspection(*inspected);
  if (!seen.reference) return out;
  out.markers = markers_of(inspected->report);
  const internal::ScaleCheck check = internal::scale_check(*seen.reference);
  out.from = seen.reference->site.markers[check.from].name;
  out.to = seen.reference->site.markers[check.to].name;
  if (seen.unit != internal::BoardUnit::kMillimetre) return out;
  out.mm_per_px = check.mm_per_px;
  out.distance_mm = check.distance_mm;
  return out;
}

}  // namespace

Expected<Inspection> inspect(const std::string& input, const InspectOptions& options) {
  auto args = args_of(options);
  if (!args) return tl::unexpected(args.error());
  args->first.measure.input = input;
  return shown(internal::inspect_input(args->first, args->second, {}));
}

Expected<Inspection> inspect(const ImageView& image, const InspectOptions& options) {
  const auto args = args_of(options);
  if (!args) return tl::unexpected(args.error());
  return shown(internal::inspect_image({internal::to_luma(image), image.bits}, "image", args->second));
}

}  // namespace moiregauge

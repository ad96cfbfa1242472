// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/library/convert.h"

#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/io/config/site_file.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// In the order of the public Status.
constexpr std::array kStatuses{Status::kOk,          Status::kUntrusted,     Status::kCameraMoved,
                               Status::kBlurred,     Status::kSaturated,     Status::kPartlyCovered,
                               Status::kLost,        Status::kReferenceLost, Status::kOrderUnproven,
                               Status::kDecodeError, Status::kTooCoarse};
static_assert(kStatuses.size() == static_cast<std::size_t>(moiregauge::Status::kTooCoarse) + 1);

moiregauge::Marker public_marker(const Marker& marker) {
  moiregauge::Marker out;
  out.name = marker.name;
  out.is_reference = marker.role == Role::kReference;
  if (marker.circle) out.circle = {marker.circle->centre.x, marker.circle->centre.y, marker.circle->diameter_mm};
  if (const auto& g = marker.grating)
    out.grating = moiregauge::Grating{g->centre.x,
                                      g->centre.y,
                                      g->width_mm,
                                      g->height_mm,
                                      g->pitch_mm,
                                      degrees_from_radians(g->angle_rad),
                                      static_cast<moiregauge::Pattern>(g->pattern)};
  out.z_mm = marker.z_mm;
  return out;
}
static_assert(static_cast<int>(moiregauge::Pattern::kCosine) == static_cast<int>(Pattern::kCosine));

Marker internal_marker(const moiregauge::Marker& marker) {
  Marker out;
  out.name = marker.name;
  out.role = marker.is_reference ? Role::kReference : Role::kTarget;
  if (marker.circle) out.circle = Circle{{marker.circle->x_mm, marker.circle->y_mm}, marker.circle->diameter_mm};
  if (const auto& g = marker.grating)
    out.grating = Grating{{g->x_mm, g->y_mm},
                          g->width_mm,
                          g->height_mm,
                          g->pitch_mm,
                          radians_from_degrees(g->angle_deg),
                          static_cast<Pattern>(g->pattern)};
  out.z_mm = marker.z_mm;
  return out;
}

FrameRange internal_range(const moiregauge::FrameRange& range) {
  FrameRange out{range.first, range.end, range.step};
  if (range.time) out.seconds = TimeRange{range.time->first.value(), range.time->end.value()};
  return out;
}

moiregauge::Expected<void> set_scale(const moiregauge::MeasureOptions& options, MeasureOptions& out) {
  const int stated = (options.pitch ? 1 : 0) + (options.site ? 1 : 0) + (options.site_file.empty() ? 0 : 1);
  if (stated != 1)
    return public_error(Exit::kUsage, fmt::format("the scale is stated {} times: MeasureOptions: set one of pitch, "
                                                  "site and site_file",
                                                  stated));
  if (options.pitch) {
    if (!(options.pitch->value() > 0.0))
      return public_error(Exit::kUsage, "the pitch is not above 0: MeasureOptions: set pitch, e.g. 10_mm");
    out.pitch_mm = options.pitch->value();
    return {};
  }
  if (options.site) {
    auto site = to_internal(*options.site);
    if (!site) return tl::unexpected(site.error());
    out.site = *std::move(site);
    return {};
  }
  if (const auto taken = take_site(options.site_file, out); !taken)
    return public_error(Exit::kUsage, taken.error().message);
  return {};
}

moiregauge::Expected<void> set_camera(const moiregauge::MeasureOptions& options, MeasureOptions& out) {
  if (options.camera && !options.camera_file.empty())
    return public_error(Exit::kUsage, "camera and camera_file exclude each other: MeasureOptions: set one of them");
  if (options.camera) out.camera = to_internal(*options.camera);
  if (options.camera_file.empty()) return {};
  if (const auto taken = take_camera(options.camera_file, out); !taken)
    return public_error(Exit::kUsage, taken.error().message);
  return {};
}

}  // namespace

moiregauge::Status public_status(Status status) {
  for (std::size_t i = 0; i < kStatuses.size(); ++i) {
    if (kStatuses[i] == status) return static_cast<moiregauge::Status>(i);
  }
  return moiregauge::Status::kUntrusted;
}

tl::unexpected<moiregauge::Error> public_error(Exit exit, std::string message) {
  const auto kind = [exit] {
    switch (exit) {
      case Exit::kUsage:
        return moiregauge::ErrorKind::kUsage;
      case Exit::kInputUnreadable:
        return moiregauge::ErrorKind::kInput;
      case Exit::kRefused:
        return moiregauge::ErrorKind::kRefused;
      case Exit::kOutputUnwritable:
        return moiregauge::ErrorKind::kOutput;
      default:
        return moiregauge::ErrorKind::kInternal;
    }
  }();
  return tl::unexpected(moiregauge::Error{kind, std::move(message)});
}

moiregauge::Camera to_public(const Camera& c) {
  return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
}

Camera to_internal(const moiregauge::Camera& c) {
  return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
}

LumaView to_luma(const moiregauge::ImageView& image) {
  if (image.bits == 8)
    return ImageView<std::uint8_t>{static_cast<const std::uint8_t*>(image.data), image.width, image.height,
                                   image.stride};
  return ImageView<std::uint16_t>{static_cast<const std::uint16_t*>(image.data), image.width, image.height,
                                  image.stride};
}

moiregauge::Site to_public(const Site& site) {
  moiregauge::Site out;
  for (const Marker& marker : site.markers) out.markers.push_back(public_marker(marker));
  out.known_to = {site.known_to.position_mm, degrees_from_radians(site.known_to.rotation_rad), site.known_to.height_mm,
                  site.known_to.print_scale};
  return out;
}

moiregauge::Expected<Site> to_internal(const moiregauge::Site& site) {
  Site out;
  for (const bool references : {true, false}) {  // references first
    for (const moiregauge::Marker& marker : site.markers)
      if (marker.is_reference == references) out.markers.push_back(internal_marker(marker));
  }
  out.known_to = {site.known_to.position_mm, radians_from_degrees(site.known_to.rotation_deg), site.known_to.height_mm,
                  site.known_to.print_scale};
  // A site in memory may have the same mistakes as a file.
  auto checked = parse_site(write_site(out), "site");
  if (!checked) return public_error(Exit::kUsage, fmt::format("{}", fmt::join(checked.error(), "\n")));
  return *std::move(checked);
}

moiregauge::Sample to_public(const Sample& s) {
  return {s.frame, s.time_s, s.displacement.x, s.displacement.y, s.u.x, s.u.y, public_status(s.status)};
}

moiregauge::Result to_result(const Measurement& measured, const MeasureOptions& options) {
  moiregauge::Result result;
  const Site& site = site_of(measured, options);
  result.site = to_public(site);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (site.markers[i].role != Role::kTarget || !measured.reference) continue;
    moiregauge::Target target;
    target.name = site.markers[i].name;
    for (const Sample& sample : measured.samples)
      if (sample.marker == i) target.samples.push_back(to_public(sample));
    for (const TargetSummary& summary : measured.targets) {
      if (summary.marker != i) continue;
      target.ok = summary.ok;
      target.u_dx_mm = summary.u.x;
      target.u_dy_mm = summary.u.y;
    }
    result.targets.push_back(std::move(target));
  }
  if (const auto& scene = stated_scene(measured); scene && scene->solved) result.camera = to_public(scene->camera);
  if (measured.reference) result.reference_frame = measured.reference->seen.frame;
  result.references_verified = measured.references_verified;
  result.warnings = measured.warnings;
  result.refusal = measured.refusal;
  result.remedy = measured.remedy;
  result.exit_code = static_cast<int>(measured.exit);
  return result;
}

moiregauge::Expected<MeasureOptions> to_internal(const moiregauge::MeasureOptions& options) {
  MeasureOptions out;
  const auto method = method_of(options.method);
  if (!method) return public_error(Exit::kUsage, method.error().message);
  out.method = *method;
  for (const auto set : {set_scale, set_camera}) {
    if (const auto done = set(options, out); !done) return tl::unexpected(done.error());
  }
  if (const auto checked = check_times(options.fps, options.slow_motion); !checked)
    return public_error(Exit::kUsage, checked.error().message);
  out.frames = internal_range(options.frames);
  out.reference_frame = options.reference_frame;
  if (options.rest) out.solve.rest = internal_range(*options.rest);
  if (options.zero) out.zero = internal_range(*options.zero);
  if (options.readout) out.solve.readout_s = options.readout->value();
  if (options.tone == "auto") return out;
  out.tone = tone_curve_named(options.tone);
  if (!out.tone)
    return public_error(Exit::kUsage, fmt::format("the tone curve is unknown: {}: choose auto, linear, srgb, bt709 or "
                                                  "gamma:2.2",
                                                  options.tone));
  return out;
}

}  // namespace moiregauge::internal

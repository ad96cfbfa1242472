// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/inspect_json.h"

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "moiregauge/observation/reference/scale_check.h"
#include "moiregauge/units/units.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

using Json = nlohmann::ordered_json;

// Builds a JSON object. Unknown values are null, with the reason in "null_because".
class Facts {
 public:
  template <typename Value>
  Facts& put(const char* key, Value value) {
    json_[key] = std::move(value);
    return *this;
  }
  Facts& number(const char* key, double value, const std::string& why_not) {
    if (std::isfinite(value))
      json_[key] = value;
    else
      null(key, why_not);
    return *this;
  }
  Facts& null(const char* key, const std::string& why) {
    json_[key] = nullptr;
    because_[key] = why;
    return *this;
  }
  [[nodiscard]] Json json() const {
    Json out = json_;
    if (!because_.empty()) out["null_because"] = because_;
    return out;
  }

 private:
  Json json_ = Json::object(), because_ = Json::object();
};

// Returns the direction in degrees, counter-clockwise from the image's horizontal. Image y is downwards.
double direction_deg(ImageExtent d) {
  return length(d) > 0.0 ? degrees_from_radians(std::atan2(-d.y, d.x)) : kNotMeasured;
}

constexpr const char* kOneAxis = "the grating does not show this axis";
constexpr const char* kNoPitch = "millimetres require --pitch or --site";

void put_name(Facts& facts, const Inspection& seen, int marker) {
  if (marker == kUnidentified) {
    const char* why = seen.reference ? "not identified as a marker" : "the markers could not be identified";
    facts.null("name", why).null("role", why);
    return;
  }
  const Marker& m = seen.reference->site.markers[static_cast<std::size_t>(marker)];
  facts.put("name", m.name).put("role", m.role == Role::kReference ? "reference" : "target");
}

Json circle_json(const Inspection& seen, const InspectedCircle& c) {
  Facts facts;
  put_name(facts, seen, c.marker);
  if (c.lattice == kUnidentified)
    facts.null("lattice", "not a dot of a lattice");
  else
    facts.put("lattice", c.lattice);
  return facts.number("x_px", c.seen.centre.x, "")
      .number("y_px", c.seen.centre.y, "")
      .number("u_px", c.seen.u_centre_px, "too little of the outline is visible")
      .number("diameter_px", c.seen.diameter_px, "")
      .number("axis_ratio", c.seen.axis_ratio, "")
      .number("angle_deg", -degrees_from_radians(c.seen.angle_rad), "")
      .number("circularity", c.seen.circularity, "")
      .number("ellipse_residual", c.seen.ellipse_residual, "")
      .number("contrast", c.seen.contrast, "")
      .number("background", c.seen.background, "")
      .json();
}

Json rejected_json(const RejectedOutline& r) {
  return Facts()
      .number("x_px", r.centre.x, "")
      .number("y_px", r.centre.y, "")
      .number("diameter_px", r.diameter_px, "")
      .number("circularity", r.circularity, "the outline has no length")
      .put("why", r.why)
      .json();
}

Json patch_json(const Inspection& seen, const InspectedPatch& p) {
  const PatchAxes axes = axes_of(p.seen);
  const PatchBound u = displacement_bound(p);
  const auto pitch = [](ImageExtent along) { return length(along) > 0.0 ? length(along) : kNotMeasured; };
  Json outline = Json::array();
  for (const ImagePoint& corner : p.seen.outline) outline.push_back({corner.x, corner.y});
  Facts facts;
  put_name(facts, seen, p.marker);
  return facts.put("pattern", word_for(p.seen.pattern))
      .put("dark_on_light", p.seen.dark_on_light)
      .number("x_px", p.seen.centre.x, "")
      .number("y_px", p.seen.centre.y, "")
      .put("outline_px", outline)
      .number("pitch_x_px", pitch(axes.x), kOneAxis)
      .number("pitch_y_px", pitch(axes.y), kOneAxis)
      .number("direction_x_deg", direction_deg(axes.x), kOneAxis)
      .number("direction_y_deg", direction_deg(axes.y), kOneAxis)
      .number("periods_x", p.seen.periods_x, "")
      .number("periods_y", p.seen.periods_y, "")
      .number("modulation", p.seen.modulation, "")
      .number("noise", p.noise.sigma, "too small to determine its noise")
      .number("unexplained", p.seen.noise, "")
      .number("clipped_share", p.noise.clipped_share, "")
      .number("u_dx_px", u.along_x_px, kOneAxis)
      .number("u_dy_px", u.along_y_px, kOneAxis)
      .json();
}

Json lattice_json(const IndexedLattice& lattice) {
  Json points = Json::array();
  for (const LatticePoint& p : lattice.points) {
    points.push_back(Facts()
                         .put("column", p.column)
                         .put("row", p.row)
                         .number("x_px", p.at.x, "")
                         .number("y_px", p.at.y, "")
                         .number("u_px", p.u_px, "not determined")
                         .number("size_px", p.size_px, "not determined")
                         .json());
  }
  return Facts()
      .put("kind", lattice.kind == LatticeKind::kDots ? "dots" : "checker-corners")
      .put("columns", lattice.columns)
      .put("rows", lattice.rows)
      .put("seen", lattice.points.size())
      .put("places", lattice.columns * lattice.rows)
      .put("dark", lattice.dark)
      .number("pitch_px", lattice.pitch_px, "")
      .put("points", points)
      .json();
}

const char* word_for_loss(Loss loss) {
  switch (loss) {
    case Loss::kNone:
      return "seen";
    case Loss::kNotSeen:
      return "not found";
    case Loss::kOutsidePicture:
      return "partly outside the image";
    case Loss::kNoModulation:
      return "there is no grating of the stated pitch";
    case Loss::kCovered:
      return "partly covered";
    case Loss::kTooCoarse:
      return "its pitch is too few pixels wide";
  }
  return "not found";
}

Json seen_marker_json(const Inspection& seen, std::size_t i) {
  const Reference& reference = *seen.reference;
  const Marker& m = reference.site.markers[i];
  const BoardPoint at = m.grating ? m.grating->centre : m.circle->centre;
  const ImagePoint px = reference.view(at);
  const double mm_per_px = reference.view.mm_per_px(at);
  const bool has_mm = seen.unit == BoardUnit::kMillimetre;
  const Loss loss = reference.seen.markers[i].loss;
  const auto millimetres = [&](double mm) { return has_mm ? mm : kNotMeasured; };
  const auto& patch = reference.seen.markers[i].patch;
  const bool read = m.grating.has_value() && loss == Loss::kNone;
  const std::string unread = m.grating ? word_for_loss(loss) : "it has no grating";
  return Facts()
      .put("name", m.name)
      .put("role", m.role == Role::kReference ? "reference" : "target")
      .put("seen", !m.grating || loss == Loss::kNone)
      .number("x_px", px.x, "")
      .number("y_px", px.y, "")
      .number("x_mm", millimetres(at.x), kNoPitch)
      .number("y_mm", millimetres(at.y), kNoPitch)
      .number("mm_per_px", millimetres(mm_per_px), kNoPitch)
      .number("pitch_px", m.grating ? m.grating->pitch_mm / mm_per_px : kNotMeasured, unread)
      .number("angle_deg", m.grating ? degrees_from_radians(m.grating->angle_rad) : kNotMeasured, unread)
      .number("modulation", read ? std::fmax(patch.modulation[0], patch.modulation[1]) : kNotMeasured, unread)
      .number("noise", read ? patch.noise_sigma : kNotMeasured, unread)
      .json();
}

Json expected_json(const Inspection& seen, const ExpectedUncertainty& e) {
  const Reference& reference = *seen.reference;
  const Marker& m = reference.site.markers[e.marker];
  const double mm_per_px = reference.view.mm_per_px(m.grating->centre);
  const bool has_mm = seen.unit == BoardUnit::kMillimetre;
  const Loss loss = reference.seen.markers[e.marker].loss;
  const std::string unread = loss == Loss::kNone ? "the grating does not show this axis" : word_for_loss(loss);
  const auto mm = [&](double value) { return has_mm ? value : kNotMeasured; };
  const std::string no_mm = has_mm ? unread : kNoPitch;
  return Facts()
      .put("name", m.name)
      .number("u_dx_mm", mm(e.u.x), no_mm)
      .number("u_dy_mm", mm(e.u.y), no_mm)
      .number("u_dx_px", e.u.x / mm_per_px, unread)
      .number("u_dy_px", e.u.y / mm_per_px, unread)
      .number("bound_dx_mm", mm(e.bound.x), no_mm)
      .number("bound_dy_mm", mm(e.bound.y), no_mm)
      .number("bound_dx_px", e.bound.x / mm_per_px, unread)
      .number("bound_dy_px", e.bound.y / mm_per_px, unread)
      .json();
}

// Returns the scale of the image. Lengths in mm are null without a pitch.
Json scale_of_picture_json(const Inspection& seen) {
  const ScaleCheck check = scale_check(*seen.reference);
  const auto& markers = seen.reference->site.markers;
  const auto mm = [&](double value) { return seen.unit == BoardUnit::kMillimetre ? value : kNotMeasured; };
  Facts facts;
  facts.number("mm_per_px", mm(check.mm_per_px), kNoPitch).put("from", markers[check.from].name);
  if (check.from == check.to)
    facts.null("to", "there is only one marker, the length is its grating's width");
  else
    facts.put("to", markers[check.to].name);
  return facts.number("distance_mm", mm(check.distance_mm), kNoPitch).json();
}

}  // namespace

Json inspect_json(const InspectReport& report) {
  const Inspection& seen = report.seen;
  Facts input;
  input.put("path", report.input.path).put("frame", report.frame);
  Json json{{"moiregauge", kVersion}, {"schema", 1}};
  json["input"] = input.number("time_s", report.time_s, "the images have no times")
                      .put("width", seen.width)
                      .put("height", seen.height)
                      .put("bits", report.input.bits)
                      .put("codec", report.input.codec)
                      .json();
  for (const char* list : {"circles", "rejected", "gratings", "lattices", "markers", "expected"})
    json[list] = Json::array();
  for (const InspectedCircle& c : seen.circles) json["circles"].push_back(circle_json(seen, c));
  for (const RejectedOutline& r : seen.rejected) json["rejected"].push_back(rejected_json(r));
  for (const InspectedPatch& p : seen.patches) json["gratings"].push_back(patch_json(seen, p));
  for (const IndexedLattice& l : seen.lattices) json["lattices"].push_back(lattice_json(l));
  for (std::size_t i = 0; seen.reference && i < seen.reference->site.markers.size(); ++i)
    json["markers"].push_back(seen_marker_json(seen, i));
  for (const ExpectedUncertainty& e : report.expected) json["expected"].push_back(expected_json(seen, e));
  if (seen.reference) json["scale"] = scale_of_picture_json(seen);
  json["measurable"] = seen.reference.has_value();
  json["missing"] = seen.missing;
  json["notes"] = seen.notes;
  json["exit_code"] = static_cast<int>(report.exit);
  return json;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/inspect_json.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace moiregauge::internal {
namespace {

using Json = nlohmann::ordered_json;

// A report in which every optional value is unknown: lines that show nothing along y, no time, an unread target.
InspectReport full_of_gaps(BoardUnit unit) {
  InspectReport report;
  report.input.path = "clip.mp4";
  InspectedPatch patch;
  patch.seen.k_x = {0.1, 0.0};
  patch.seen.pattern = Pattern::kLinesX;
  patch.seen.modulation = 40.0;
  patch.noise.sigma = 1.0;
  patch.pixels = 900.0;
  report.seen.patches = {patch};
  InspectedCircle circle;
  circle.seen.u_centre_px = kNotMeasured;
  report.seen.circles = {circle};
  report.seen.rejected.push_back({{1.0, 2.0}, 20.0, std::nan(""), "not a closed outline"});
  LatticePoint point;
  point.u_px = kNotMeasured;
  report.seen.lattices.emplace_back().points = {point};
  report.seen.unit = unit;
  Reference reference;
  Marker marker;
  marker.name = "T1";
  marker.role = Role::kTarget;
  marker.grating = Grating{{0.0, 0.0}, 40.0, 40.0, 10.0};
  reference.site.markers = {marker};
  reference.seen.markers.resize(1);
  reference.seen.markers[0].loss = Loss::kNoModulation;
  report.seen.reference = reference;
  report.expected = {{0, {kNotMeasured, kNotMeasured}, {0.0, 0.0}, {kNotMeasured, kNotMeasured}}};
  return report;
}

// Checks that every null has a reason.
void expect_reasons(const Json& json, const std::string& where) {
  if (json.is_array()) {
    for (const Json& part : json) expect_reasons(part, where);
  }
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) {
    const std::string here = where + "." + key;
    if (value.is_null()) {
      ASSERT_TRUE(json.contains("null_because") && json["null_because"].contains(key)) << here;
      EXPECT_FALSE(json["null_because"][key].get<std::string>().empty()) << here;
    }
    expect_reasons(value, here);
  }
}

TEST(InspectJson, UnknownValuesAreNullWithAReason) {
  for (const BoardUnit unit : {BoardUnit::kMillimetre, BoardUnit::kPitch}) {
    const Json json = inspect_json(full_of_gaps(unit));
    expect_reasons(json, "inspect");
    EXPECT_EQ(json.dump().find("nan"), std::string::npos);
    EXPECT_TRUE(json["gratings"][0]["pitch_y_px"].is_null());
    EXPECT_DOUBLE_EQ(json["gratings"][0]["pitch_x_px"].get<double>(), 10.0);
    EXPECT_TRUE(json["expected"][0]["u_dx_mm"].is_null());
  }
}

TEST(InspectJson, WithoutAPitchThereAreNoMillimetres) {
  InspectReport report = full_of_gaps(BoardUnit::kPitch);
  report.seen.reference->seen.markers[0].loss = Loss::kNone;
  report.expected[0].u = {0.1, 0.2};
  const Json json = inspect_json(report);
  EXPECT_TRUE(json["markers"][0]["x_mm"].is_null());
  EXPECT_TRUE(json["expected"][0]["u_dx_mm"].is_null());
  EXPECT_DOUBLE_EQ(json["expected"][0]["u_dx_px"].get<double>(), 0.1);
}

TEST(InspectJson, DirectionsAreCounterClockwiseInTheDisplayedImage) {
  InspectReport report = full_of_gaps(BoardUnit::kMillimetre);
  DetectedPatch& patch = report.seen.patches[0].seen;
  patch.pattern = Pattern::kAuto;
  const double angle = 0.1;  // rad; image y is downwards
  patch.k_x = {std::cos(angle) / 12.0, -std::sin(angle) / 12.0};
  patch.k_y = {-std::sin(angle) / 12.0, -std::cos(angle) / 12.0};
  const Json json = inspect_json(report)["gratings"][0];
  EXPECT_NEAR(json["direction_x_deg"].get<double>(), 5.7296, 1e-4);
  EXPECT_NEAR(json["direction_y_deg"].get<double>(), 95.7296, 1e-4);
  EXPECT_NEAR(json["pitch_x_px"].get<double>(), 12.0, 1e-12);
}

}  // namespace
}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/report_text.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "moiregauge/report/report_page.h"

namespace moiregauge::internal {
namespace {

// Two targets in four frames; the first is the reference frame. `mid` moves up by 2 mm, `end` is at rest.
struct BridgeRun {
  Measurement measurement;
  MeasureOptions options;
  CameraMotion camera;

  BridgeRun() {
    options.method = method_named("precise");
    Reference reference;
    for (const char* name : {"mid", "end"})
      reference.site.markers.push_back({name, Role::kTarget, std::nullopt, Grating{}, std::nullopt});
    reference.seen.markers.resize(2);
    measurement.reference = reference;
    measurement.spectra.resize(2);
    measurement.input.path = "clips/bridge <b>.mp4";
    measurement.input.width = 1000;
    measurement.input.height = 500;
    measurement.exit = Exit::kMeasured;
    for (long frame = 0; frame < 4; ++frame) {
      Observation seen;
      seen.frame = frame;
      seen.time_s = 0.1 * static_cast<double>(frame);
      seen.markers.resize(2);
      measurement.observations.push_back(seen);
      for (const std::size_t marker : {0U, 1U}) {
        Sample sample{frame, seen.time_s, marker, {0.0, 0.0}, {0.002, 0.001}, {}, Status::kOk};
        if (marker == 0) sample.displacement.y = 2.0 * static_cast<double>(frame) / 3.0;
        if (frame == 0) sample.u = {0.0, 0.0};
        measurement.samples.push_back(sample);
      }
    }
    camera.shift_x_px = {0.0, 30.0, 60.0, 61.0};
    camera.shift_y_px = {0.0, 0.0, 0.0, 0.0};
    camera.turn_x_deg = {0.0, 0.3, 0.6, 1.0};
    camera.turn_y_deg = camera.turn_z_deg = {0.0, 0.0, 0.0, 0.0};
  }
  Words words() {
    measurement.targets = summarise(*measurement.reference, measurement.samples);
    return words_of(WordedRun{measurement, options, camera});
  }
};

bool says(const std::vector<std::string>& sentences, const std::string& what) {
  return std::any_of(sentences.begin(), sentences.end(), [&](const std::string& s) { return s.find(what) != s.npos; });
}

TEST(ReportText, AMovementIsReportedWithItsInterval) {
  const Words words = BridgeRun().words();
  EXPECT_EQ(words.outcome, "Measured");
  EXPECT_EQ(words.summary.at(0), "mid moved up and down by 2.0000 mm peak to peak (U = 0.0020 mm, k = 2).");
  EXPECT_EQ(words.summary.at(1),
            "Its range was 0.0000 to +2.0000 mm. It did not move measurably sideways (U = 0.0040 mm).");
  EXPECT_TRUE(says(words.summary, "end did not move measurably (up and down U = 0.0020 mm, sideways U = 0.0040 mm"));
  EXPECT_TRUE(says(words.summary, "rotated by up to 1.00° and moved the image by up to 61.0 px"));
  EXPECT_TRUE(says(words.summary, "all rows are ok"));
  EXPECT_TRUE(words.advice.empty());
}

// A camera that circles the targets, aimed at their middle, is not fixed.
TEST(ReportText, ACirclingCameraIsNotFixed) {
  BridgeRun run;
  run.camera.shift_x_px = {0.0, 0.01, 0.0, 0.02};
  EXPECT_TRUE(
      says(run.words().summary, "rotated by up to 1.00°, while the middle of the image moved by less than 0.05"));
  run.camera.turn_x_deg = {0.0, 0.01, 0.0, 0.02};
  EXPECT_TRUE(says(run.words().summary, "The camera moved the image by less than 0.05 px."));
}

// U has the coverage factor 2, and is that of run.json: rms over the measured rows, without the reference frame's u = 0.
TEST(ReportText, TheUncertaintyIsThatOfTheTable) {
  BridgeRun run;
  run.measurement.samples[3].u = {0.02, 0.01};  // `end` in the second frame; rms 0.0117 and 0.0058
  EXPECT_TRUE(
      says(run.words().summary, "end did not move measurably (up and down U = 0.012 mm, sideways U = 0.023 mm"));
}

// The range of three normal values is 1.7 of their standard deviation on average.
TEST(ReportText, ARangeOfNoiseIsNoMovement) {
  BridgeRun run;
  for (const std::size_t k : {3U, 5U, 7U}) run.measurement.samples[k].displacement.y = k == 5 ? 0.001 : -0.001;
  EXPECT_TRUE(says(run.words().summary, "end did not move measurably"));
}

TEST(ReportText, TheLargestMovementIsTheHeadline) {
  BridgeRun run;
  for (const std::size_t k : {3U, 5U, 7U}) run.measurement.samples[k].displacement.x = -5.0;
  const Words words = run.words();
  EXPECT_EQ(words.summary.at(0), "end moved sideways by 5.0000 mm peak to peak (U = 0.0040 mm, k = 2).");
  EXPECT_TRUE(says(words.summary, "Its range was −5.0000 to 0.0000 mm. It did not move measurably up and down"));
  EXPECT_TRUE(says(words.summary, "mid moved up and down by 2.0000 mm"));
}

TEST(ReportText, SamplesThatAreNotOkAreCountedWithARemedy) {
  BridgeRun run;
  run.measurement.samples.back().status = Status::kBlurred;
  run.measurement.exit = Exit::kIncomplete;
  const Words words = run.words();
  EXPECT_EQ(words.outcome, "Measured with gaps");
  EXPECT_TRUE(says(words.summary, "7 of 8 rows are ok (others: 1 blurred)"));
  EXPECT_TRUE(says(words.advice,
                   "1 row blurred: the marker is too blurred for a reliable uncertainty. Use a shorter exposure"));
}

TEST(ReportText, ASampleThatIsNotOkIsNotTheLargestMovement) {
  BridgeRun run;
  run.measurement.samples[6].status = Status::kUntrusted;  // `mid` in the last frame
  EXPECT_TRUE(says(run.words().summary, "mid moved up and down by 1.3333 mm"));
}

TEST(ReportText, VibrationIsReportedByFrequencyAndDamping) {
  BridgeRun run;
  Peak peak;
  peak.kind = PeakKind::kDecay;
  peak.frequency_hz = 1.7;
  peak.u_frequency_hz = 0.001;
  peak.amplitude_mm = 0.5;
  peak.damping = 0.01;
  peak.u_damping = 0.0005;
  run.measurement.spectra[0].y.peaks = {peak};
  EXPECT_TRUE(
      says(run.words().summary, "mid vibrates up and down at 1.7000 Hz (U = 0.0020 Hz; damping 1.00 %, U = 0.10 %)"));
}

TEST(ReportPage, NoTextOfARunClosesItsScript) {
  BridgeRun run;
  run.measurement.warnings = {"</script><script>alert(1)</script>"};
  (void)run.words();
  run.measurement.spectra = spectra_of(run.measurement.samples, run.measurement.targets);
  const std::string page = report_page(run.measurement, run.options, R"({"input": {"path": "</script>"}})", {});
  ASSERT_FALSE(page.empty());
  std::size_t ends = 0;
  for (std::size_t at = page.find("</script>"); at != page.npos; at = page.find("</script>", at + 1)) ++ends;
  EXPECT_EQ(ends, 5U);  // report, run, samples, overlay and the page's own
  EXPECT_NE(page.find("<title>bridge &lt;b&gt;.mp4"), page.npos);
}

}  // namespace
}  // namespace moiregauge::internal

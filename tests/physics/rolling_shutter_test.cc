// SPDX-License-Identifier: Apache-2.0
// Tests the rolling shutter of a hand-held camera (docs/methods/precise/rolling-shutter.md): the errors that remain
// after readout time and camera path are solved.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/calibration/rolling_shutter/row_motion.h"

namespace moiregauge::internal {
namespace {

constexpr double kReadout = 0.018;  // s

// Returns a telephone at 30 frames/s, in a hand that sways by 0.3 deg about all three axes. It trembles by 0.06 deg at
// 8 Hz and by a quarter of a millimetre.
simulator::Scenario hand_held() {
  auto s = *simulator::built_in("small-still");
  s.camera.k1 = -0.37;  // -1 % at the image corner
  s.sensor.fps = 30.0;
  s.sensor.readout_s = kReadout;
  s.sensor.exposure_s = 1.0 / 500.0;
  auto& m = s.mount;
  double phase = 0.0;
  for (auto* track : {&m.rotation_x, &m.rotation_y, &m.rotation_z}) {
    track->amplitude = 0.06, track->frequency_hz = 8.0, track->phase_deg = phase += 70.0;
    for (int k = 0; k <= 20; ++k) track->knots.push_back({0.1 * k, 0.3 * std::sin(0.2 * k + phase)});
  }
  for (auto* track : {&m.shift_x, &m.shift_y, &m.shift_z})
    track->amplitude = 0.25, track->frequency_hz = 6.0, track->phase_deg = phase += 70.0;
  return s;
}

test::MeasuredRun precisely_by_rows(const simulator::Scenario& scenario, std::optional<double> readout_s = {},
                                    int frames = 24) {
  test::RunPlan plan{.method = "precise", .frames = frames};
  plan.solve.readout_s = readout_s;
  auto run = test::measured(scenario, plan);
  EXPECT_EQ(run.problem, "");
  return run;
}

// Returns the number of rows that are `ok` and wrong by over 5 u and 0.5 um.
int silent_lies(const test::MeasuredRun& run) {
  int lies = 0;
  std::size_t k = 0;
  const auto lie = [](double error, double u) { return std::abs(error) > std::max(5.0 * u, 0.5); };
  for (const Sample& sample : run.samples) {
    if (!has_numbers(sample.status)) continue;
    lies += sample.status == Status::kOk &&
            (lie(run.error_x_um[k], run.u_x_um[k]) || lie(run.error_y_um[k], run.u_y_um[k]));
    ++k;
  }
  return lies;
}

long ok_rows(const test::MeasuredRun& run) {
  return std::ranges::count_if(run.samples, [](const Sample& s) { return s.status == Status::kOk; });
}

// The same hand with a global shutter gives the scatter of noise alone. With the readout free and the path known only
// at the frames, u is larger. Limits: twice that scatter in dy (the strong axis) and three times in dx, from the study
// in decision 0026.
TEST(RollingShutter, OfAHandHeldTelephoneIsSolved) {
  auto at_once = hand_held();
  at_once.sensor.readout_s = 0.0;
  const auto yardstick = precisely_by_rows(at_once), run = precisely_by_rows(hand_held());
  ASSERT_TRUE(run.solution.scene && run.solution.scene->solved);
  EXPECT_NEAR(run.solution.scene->readout_s, kReadout, 5.0 * run.solution.scene->u_readout_s);
  EXPECT_LT(run.solution.scene->u_readout_s, 0.2 * kReadout);
  EXPECT_TRUE(notes(run, "note: a rolling shutter was solved")) << ::testing::PrintToString(run.solution.notes);
  EXPECT_EQ(ok_rows(run), 23);
  EXPECT_EQ(silent_lies(run), 0);
  EXPECT_LT(test::scatter(run.error_y_um), 2.0 * test::scatter(yardstick.error_y_um) + 0.5);
  EXPECT_LT(test::scatter(run.error_x_um), 3.0 * test::scatter(yardstick.error_x_um) + 0.5);
  RecordProperty("at_once_dx_um", std::to_string(test::scatter(yardstick.error_x_um)));
  RecordProperty("dx_um", std::to_string(test::scatter(run.error_x_um)));
  RecordProperty("dy_um", std::to_string(test::scatter(run.error_y_um)));
}

TEST(RollingShutter, GivenIsAsGoodAsSolved) {
  const auto run = precisely_by_rows(hand_held(), kReadout);
  ASSERT_TRUE(run.solution.scene && run.solution.scene->solved);
  // A given readout has u = 3 %.
  EXPECT_NEAR(run.solution.scene->readout_s, kReadout, 0.06 * kReadout);
  EXPECT_EQ(ok_rows(run), 23);
  EXPECT_EQ(silent_lies(run), 0);
}

// Rotation tags change the direction of readout in the image.
TEST(RollingShutter, RotationTagsGiveTheReadoutDirection) {
  EXPECT_EQ(rows_run(180), ReadoutDirection::kUp);
  EXPECT_EQ(rows_run(90), ReadoutDirection::kLeft);
  EXPECT_EQ(rows_run(270), ReadoutDirection::kRight);
  Camera picture;
  picture.width = 100, picture.height = 50;
  EXPECT_DOUBLE_EQ(share_of_row({49.5, -0.5}, picture, ReadoutDirection::kDown), -0.5);
  EXPECT_DOUBLE_EQ(share_of_row({49.5, -0.5}, picture, ReadoutDirection::kUp), 0.5);
  EXPECT_DOUBLE_EQ(share_of_row({99.5, 10.0}, picture, ReadoutDirection::kLeft), -0.5);
  EXPECT_DOUBLE_EQ(share_of_row({24.5, 10.0}, picture, ReadoutDirection::kRight), -0.25);
}

// 0.02 deg at 40 Hz is invisible at 30 frames a second. Either u covers it, or the rows are not ok.
TEST(RollingShutter, AVibrationAboveTheFrameRateIsCoveredOrNotOk) {
  auto shaken = hand_held();
  for (auto* track : {&shaken.mount.rotation_x, &shaken.mount.rotation_y, &shaken.mount.rotation_z})
    track->amplitude = 0.02, track->frequency_hz = 40.0;
  EXPECT_EQ(silent_lies(precisely_by_rows(shaken, {}, 12)), 0);
}

// A target that jumps by 12 mm within one exposure is blurred in that frame. It is not `ok` there, and the other frames
// are as they were.
TEST(RollingShutter, ATargetThatIsBlurredInOneFrameChangesNoOther) {
  auto jumping = hand_held();
  constexpr double kJump_s = 10.0 / 30.0;  // frame 10; the target is in the middle row
  auto& target = jumping.markers.back();
  target.dy = {};
  target.dy.knots = {{0.0, 0.0}, {kJump_s - 5e-4, 0.0}, {kJump_s + 5e-4, 12.0}};
  const auto run = precisely_by_rows(jumping, kReadout, 14);
  EXPECT_EQ(silent_lies(run), 0);
  for (const Sample& sample : run.samples)
    EXPECT_EQ(sample.status == Status::kOk, sample.frame != 10)
        << "frame " << sample.frame << " " << word_for(sample.status) << ::testing::PrintToString(run.solution.notes);
}

// Movement of the target between its row's time and the frame's: 2 pi 3 Hz 1 mm = 19 mm/s over the delay of its row. At
// 55 mm above the middle this is 55 mm / (0.345 mm/px * 512 px) * 18 ms = 5.6 ms, or 106 um (75 rms). The spline of a
// sine at a tenth of the frame rate is far better than a twentieth of its rate.
TEST(RollingShutter, AMovingTargetIsCorrectedToFrameTime) {
  auto moving = hand_held();
  auto& target = moving.markers.back();
  target.print.grating->centre = {0.0, 55.0};
  target.dy = {};
  target.dy.amplitude = 1.0, target.dy.frequency_hz = 3.0;
  const auto run = precisely_by_rows(moving, kReadout);
  EXPECT_EQ(silent_lies(run), 0);
  EXPECT_LT(test::rms(run.error_y_um), 75.0 / 20.0 + 3.0 * test::rms(run.u_y_um));
  EXPECT_LT(test::rms(run.u_y_um), 10.0);
}

}  // namespace
}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// The public library, used as another program would, against the simulator.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "moiregauge/moiregauge.h"

namespace moiregauge {
namespace {

Simulation small_rig(long frames) {
  SimulateOptions options;
  options.seed = 7;
  options.frames = frames;
  options.markers_only = true;
  return *Simulation::load("small-1xyz", options);
}

TEST(Tracker, FollowsTheTruthWithinItsUncertainty) {
  auto rig = small_rig(60);
  MeasureOptions options;
  options.site = rig.site();
  auto tracker = Tracker::create(options);
  ASSERT_TRUE(tracker) << tracker.error().message;
  int inside = 0, count = 0;
  for (long n = 0; n < rig.frames(); ++n) {
    const auto frame = tracker->update(rig.render(n), static_cast<double>(n) / rig.fps());
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->is_reference, n == 0);
    ASSERT_EQ(frame->samples.size(), 1U);
    const Sample& sample = frame->samples.front();
    if (n == 0) {
      EXPECT_EQ(sample.dy_mm, 0.0);
      continue;
    }
    EXPECT_EQ(sample.status, Status::kOk) << "frame " << n;
    const Truth truth = *rig.truth(n, "mid");
    for (const auto& [e, u] : {std::pair{sample.dx_mm - truth.dx_mm, sample.u_dx_mm},
                               std::pair{sample.dy_mm - truth.dy_mm, sample.u_dy_mm}}) {
      EXPECT_LT(std::abs(e), 5.0 * u) << "frame " << n;
      inside += std::abs(e) < 2.0 * u ? 1 : 0;
      ++count;
    }
  }
  // 95 % are expected. Errors share the scene, so the count scatters more than binomially: 80 % is four deviations.
  EXPECT_GT(inside, 4 * count / 5);
}

TEST(Tracker, RefusesAFrameOfAnotherSize) {
  auto rig = small_rig(2);
  MeasureOptions options;
  options.site = rig.site();
  auto tracker = Tracker::create(options);
  const auto first = rig.render(0);
  ASSERT_TRUE(tracker->update(first, 0.0));
  const ImageView part(static_cast<const std::uint8_t*>(first.data), first.width / 2, first.height, first.stride);
  const auto refused = tracker->update(part, 0.1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
}

TEST(Measure, NeedsExactlyOneStatementOfScale) {
  const auto none = measure("nowhere", {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kUsage);
  MeasureOptions both;
  both.pitch = 10_mm;
  both.site_file = "site.toml";
  EXPECT_FALSE(measure("nowhere", both));
}

TEST(Measure, ReportsAnInputThatIsNotThere) {
  MeasureOptions options;
  options.pitch = 10_mm;
  const auto result = measure("/nowhere/clip.mp4", options);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kInput);
}

TEST(Site, SurvivesItsText) {
  auto rig = small_rig(1);
  const Site site = rig.site();
  const auto path = std::filesystem::temp_directory_path() / "moiregauge-library-test-site.toml";
  std::ofstream(path) << site_text(site);
  const auto read = read_site(path.string());
  std::filesystem::remove(path);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->markers.size(), site.markers.size());
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    EXPECT_EQ(read->markers[i].name, site.markers[i].name);
    EXPECT_EQ(read->markers[i].is_reference, site.markers[i].is_reference);
    EXPECT_EQ(read->markers[i].grating->pitch_mm, site.markers[i].grating->pitch_mm);
  }
}

TEST(SamplingMoire, MeasuresAKnownShift) {
  constexpr int kSide = 200;
  constexpr double kPitch = 20.0, kShift = 1.7;
  const auto picture = [](double shift) {
    std::vector<std::uint8_t> pixels;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        pixels.push_back(static_cast<std::uint8_t>(
            std::lround(128.0 + 100.0 * std::cos(2.0 * 3.14159265358979 * (x - shift) / kPitch))));
    return pixels;
  };
  const auto before = picture(0.0), after = picture(kShift);
  const auto first = sampling_moire({before.data(), kSide, kSide}, Axis::kX, kPitch, 100, 0.3);
  const auto second = sampling_moire({after.data(), kSide, kSide}, Axis::kX, kPitch, 100, 0.3);
  ASSERT_TRUE(first.is_valid && second.is_valid);
  // Rounding to grey levels is periodic with the pitch (20 px), so it does not average out: below 1 / (100 sqrt 12) rad.
  EXPECT_NEAR(displacement_px(first, second, kPitch), kShift, 1.0 / 100.0 / std::sqrt(12.0) * kPitch / 6.283);
}

TEST(Plan, IsALowerLimitOfTheStatedUncertainty) {
  auto rig = small_rig(64);
  PlanOptions options;
  options.site = rig.site();
  options.camera = {1024, 512, 3478.26, 3478.26, 511.5, 255.5};
  options.distance = 1200_mm;
  const auto planned = plan(options);
  ASSERT_TRUE(planned) << planned.error().message;
  ASSERT_EQ(planned->size(), 1U);
  MeasureOptions how;
  how.site = rig.site();
  auto tracker = Tracker::create(how);
  TrackedFrame last;
  for (long n = 0; n < rig.frames(); ++n) last = *tracker->update(rig.render(n), static_cast<double>(n) / rig.fps());
  // The plan has noise only. A measurement adds lens, geometry and axis. Rounded windows change the noise by some per cent.
  EXPECT_GT(last.samples.front().u_dy_mm, 0.9 * planned->front().u_dy_mm);
  EXPECT_GT(planned->front().bound_dy_mm, 0.0);
}

TEST(Simulation, RefusesAnUnknownScenario) {
  const auto none = Simulation::load("no-such-scenario");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kUsage);
}

}  // namespace
}  // namespace moiregauge

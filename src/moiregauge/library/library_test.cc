// SPDX-License-Identifier: Apache-2.0
// The public library, used as another program would, against the simulator.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

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

// A measured recording of ten frames, shared by the tests of a finished run.
class FinishedRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("moiregauge-library-test-" + std::to_string(::getpid()));
    const auto rig = small_rig(10);
    ASSERT_TRUE(rig.write((folder_ / "clip").string()));
    MeasureOptions options;
    options.site_file = (folder_ / "clip" / "site.toml").string();
    options.fps = rig.fps();
    options.output = run();
    auto measured = measure((folder_ / "clip" / "frames").string(), options);
    ASSERT_TRUE(measured) << measured.error().message;
    result_ = *std::move(measured);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }
  [[nodiscard]] static std::string run() { return (folder_ / "run").string(); }
  [[nodiscard]] static const std::vector<Sample>& samples() { return result_.targets.front().samples; }

  inline static std::filesystem::path folder_;
  inline static Result result_;
};

TEST_F(FinishedRun, ReadsBackWithEveryBit) {
  const auto read = read_run(run());
  ASSERT_TRUE(read) << read.error().message;
  const auto& again = read->targets.front().samples;
  ASSERT_EQ(again.size(), 10U);
  for (std::size_t n = 0; n < again.size(); ++n) {
    EXPECT_EQ(again[n].dx_mm, samples()[n].dx_mm);
    EXPECT_EQ(again[n].u_dy_mm, samples()[n].u_dy_mm);
  }
  EXPECT_EQ(read->exit_code, result_.exit_code);
  EXPECT_FALSE(read_run((folder_ / "clip").string()));
}

TEST_F(FinishedRun, IsRefusedWhenItsTableHasOtherValues) {
  const auto other = folder_ / "changed";
  std::filesystem::copy(run(), other);
  std::ofstream(other / "displacement.csv", std::ios::app) << "99,9.9,mid,0,0,0,0,ok\n";
  const auto read = read_run(other.string());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::kUsage);
}

TEST_F(FinishedRun, IsSolvedByAnotherMethodWithoutItsVideo) {
  SolveOptions options;
  options.method = "two-stage";
  const auto solved = solve(run(), options);
  ASSERT_TRUE(solved) << solved.error().message;
  const Sample& two_stage = solved->targets.front().samples.back();
  EXPECT_NE(two_stage.dy_mm, samples().back().dy_mm);
  // Both contain the same noise of one frame; 5 u of the less certain one covers their models.
  EXPECT_NEAR(two_stage.dy_mm, samples().back().dy_mm, 5.0 * std::hypot(two_stage.u_dy_mm, samples().back().u_dy_mm));
  EXPECT_TRUE(solved->folder.empty());
}

TEST_F(FinishedRun, RefusesRestFramesInWhichTheTargetMoves) {
  SolveOptions options;
  options.rest = *read_frame_range("0s:0.5s", "--rest");
  const auto solved = solve(run(), options);
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().kind, ErrorKind::kUsage);
}

TEST_F(FinishedRun, DerivesTheDifferenceOfATargetToItselfAsZeroWithoutUncertainty) {
  DeriveOptions options;
  options.channels = {"same = mid.dy", "none = mid.dy - mid.dy"};
  const auto derived = derive(run(), options);
  ASSERT_TRUE(derived) << derived.error().message;
  ASSERT_EQ(derived->channels.size(), 2U);
  for (std::size_t n = 0; n < samples().size(); ++n) {
    EXPECT_EQ(derived->channels[0].value[n], samples()[n].dy_mm);
    // The joint covariance is summed from factors in another order, so rounding differs by some 1e-9.
    EXPECT_NEAR(derived->channels[0].u[n], samples()[n].u_dy_mm, 1e-6 * samples()[n].u_dy_mm);
    EXPECT_EQ(derived->channels[1].value[n], 0.0);
    EXPECT_EQ(derived->channels[1].u[n], 0.0);
  }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(run()) / "derived.csv"));
  options.channels = {"x = nothing.dy"};
  const auto wrong = derive(run(), options);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, ErrorKind::kUsage);
}

TEST_F(FinishedRun, GivesItsReport) {
  const auto page = folder_ / "page.html";
  ASSERT_TRUE(write_report(run(), page.string()));
  EXPECT_EQ(std::filesystem::file_size(page), std::filesystem::file_size(std::filesystem::path(run()) / "report.html"));
  const auto missing = write_report((folder_ / "clip").string(), page.string());
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kInput);
}

TEST(Inspect, MeasuresTheDistanceOfTheReferences) {
  auto rig = small_rig(1);
  const auto image = rig.render(0);
  InspectOptions options;
  options.pitch = 10_mm;
  const auto seen = inspect(image, options);
  ASSERT_TRUE(seen) << seen.error().message;
  EXPECT_EQ(seen->markers.size(), 5U);
  // Circles at (+-128, +-40) mm. A circle's centre has a u of 0.02 px, which is 7 um; 5 of them.
  EXPECT_NEAR(seen->distance_mm, 256.0, 0.05);
  EXPECT_NEAR(seen->mm_per_px, 1200.0 / 3478.26, 1e-3);
  EXPECT_FALSE(seen->overlay_png.empty());
  const auto without_scale = inspect(image, {});
  ASSERT_TRUE(without_scale);
  EXPECT_TRUE(std::isnan(without_scale->distance_mm));
  options.site = rig.site();
  EXPECT_FALSE(inspect(image, options));
}

TEST(Quantities, NeedTheirUnit) {
  EXPECT_EQ(read_length("1 cm")->value(), 10.0);
  EXPECT_EQ(read_duration("18ms")->value(), 0.018);
  EXPECT_EQ(read_length("10").error().kind, ErrorKind::kUsage);
  EXPECT_FALSE(read_duration("-1s"));
  EXPECT_EQ(read_frame_range("3:9", "--rest")->end, 9);
  EXPECT_EQ(read_frame_range("1s:2.5s", "--rest")->time->end, 2.5_s);
  EXPECT_EQ(read_frame_range("0:9:2", "--frames")->step, 2);
  EXPECT_FALSE(read_frame_range("0:9:2", "--rest"));
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

TEST(PhaseMap, GrowsByAWholeTurnPerPitch) {
  constexpr int kSide = 120, kPitch = 15;
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      pixels.push_back(
          static_cast<std::uint8_t>(std::lround(128.0 + 100.0 * std::cos(2.0 * 3.14159265358979 * x / kPitch))));
  const PhaseMap map = phase_map({pixels.data(), kSide, kSide}, Axis::kX, kPitch);
  ASSERT_EQ(map.width, kSide - 2 * map.margin);
  for (int x = 0; x < map.width; ++x) {
    const double expected = 2.0 * 3.14159265358979 * (x + map.margin) / kPitch;
    // Rounding to grey levels: below 0.5 of 100, averaged over the window.
    EXPECT_NEAR(std::remainder(map.phase_rad[static_cast<std::size_t>(x)] - expected, 2.0 * 3.14159265358979), 0.0,
                0.005);
    EXPECT_NEAR(map.modulation[static_cast<std::size_t>(x)], 100.0, 0.5);
  }
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

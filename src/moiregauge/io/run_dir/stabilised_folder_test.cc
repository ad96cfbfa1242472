// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/stabilised_folder.h"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/run/measure.h"
#include "moiregauge/simulator/simulator.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

// Delivers images from memory as frames.
class Film : public FrameSource {
 public:
  explicit Film(const std::vector<Image<std::uint8_t>>& pictures) : pictures_(pictures) {
    info_.width = pictures.front().width();
    info_.height = pictures.front().height();
    info_.frames = static_cast<long>(pictures.size());
  }
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    if (next_ == pictures_.size()) return std::nullopt;
    const Image<std::uint8_t>& picture = pictures_[next_];
    return Frame{static_cast<long>(next_++), std::nan(""), false, picture.view()};
  }

 private:
  const std::vector<Image<std::uint8_t>>& pictures_;
  InputInfo info_;
  std::size_t next_ = 0;
};

// The small rig with rotation about three axes: frame 0, and one rotated by 1 degree with the target at its maximum.
constexpr long kLater = 100;
const simulator::Scenario& scenario() {
  static const auto made = simulator::built_in("small-1xyz").value();
  return made;
}
const std::vector<Image<std::uint8_t>>& pictures() {
  static const std::vector<Image<std::uint8_t>> made{render8(scenario(), 0, {0, simulator::Area::kMarkersOnly}),
                                                     render8(scenario(), kLater, {0, simulator::Area::kMarkersOnly}),
                                                     Image<std::uint8_t>(1024, 512, 128)};
  return made;
}

Measurement measured_into(StabilisedFolder& folder) {
  MeasureOptions options;
  options.method = method_named(kDefaultMethod);
  options.site = simulator::site_of(scenario());
  const OpenInput open = [] { return std::make_unique<Film>(pictures()); };
  return measure(open, options, {}, &folder).value();
}

Image<double> as_double(const Image<std::uint8_t>& picture) {
  Image<double> out(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) out.at(x, y) = picture.at(x, y);
  return out;
}

// Returns an empty image if there is no such file.
Image<double> grey_of(const std::string& path) {
  const auto picture = read_picture(path);
  return picture ? as_double(std::get<Image<std::uint8_t>>(picture->grey)) : Image<double>{};
}

double rms_difference(const Image<double>& a, const Image<double>& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) sum += (a.at(x, y) - b.at(x, y)) * (a.at(x, y) - b.at(x, y));
  }
  return std::sqrt(sum / (static_cast<double>(a.width()) * a.height()));
}

TEST(StabilisedFolder, ReferencesRestAndTargetsMoveByTheTruth) {
  const TestFolder place;
  StabilisedFolder folder(place / "still");
  ASSERT_TRUE(folder.open());
  const Measurement run = measured_into(folder);
  ASSERT_TRUE(folder.finish());
  // Noise and rounding of two frames. Interpolation removes part of the noise and adds less.
  const double noise = std::sqrt(2.0 * (scenario().sensor.noise_sigma * scenario().sensor.noise_sigma + 1.0 / 12.0));
  for (const char* name : {"NW", "NE", "SW", "SE"}) {
    const auto then = grey_of(place / "still" + std::string("/") + name + "/000000.png");
    const auto now = grey_of(place / "still" + std::string("/") + name + "/000001.png");
    ASSERT_GT(then.width(), 0) << name;
    ASSERT_EQ(then.width(), now.width()) << name;
    EXPECT_LT(rms_difference(then, now), noise) << name;
  }
  EXPECT_GT(rms_difference(as_double(pictures()[0]), as_double(pictures()[1])), 20.0 * noise) << "the camera moved";

  // The target's displacement, measured in its crops alone. Image rows are counted downwards, displacement upwards.
  const CropPlan plan = plan_crop(*run.reference, 4);
  const auto grating = *run.reference->site.markers[4].grating;
  const double pitch_px = grating.pitch_mm / plan.mm_per_px;
  const Sampling sampling{pitch_px, pitch_px, 41};
  const auto then = measure_region(grey_of(place / "still/mid/000000.png").view(), Axis::kY, sampling);
  const auto now = measure_region(grey_of(place / "still/mid/000001.png").view(), Axis::kY, sampling);
  ASSERT_TRUE(then.valid && now.valid);
  const double moved = grating.pitch_mm / kTwoPi * wrapped(now.phase_rad - then.phase_rad);
  const double truth = simulator::truth(scenario(), kLater, *simulator::find_marker(scenario(), "mid")).dy_mm;
  ASSERT_GT(truth, 1.0);
  const double u = grating.pitch_mm / kTwoPi *
                   region_mean_uncertainty(noise, then.modulation, pitch_px, pitch_px, sampling.region_px);
  EXPECT_NEAR(moved, truth, 5.0 * std::hypot(u, run.targets[0].u.y));
}

TEST(StabilisedFolder, AFrameWithoutReferencesHasARowAndNoImage) {
  const TestFolder place;
  StabilisedFolder folder(place / "still");
  ASSERT_TRUE(folder.open());
  EXPECT_FALSE(fs::exists(place / "still")) << "not before it is whole";
  (void)measured_into(folder);
  ASSERT_TRUE(folder.finish());
  EXPECT_TRUE(fs::exists(place / "still/mid/000001.png"));
  EXPECT_FALSE(fs::exists(place / "still/mid/000002.png"));
  const std::string rows = text_of(place / "still/stabilised.csv");
  EXPECT_NE(rows.find("\n2,NaN,,,,"), std::string::npos) << rows;
  EXPECT_NE(text_of(place / "still/stabilised.json").find("\"mm_per_px\""), std::string::npos);
}

TEST(StabilisedFolder, AFailureLeavesNothingAndDoesNotEndTheMeasurement) {
  const TestFolder place;
  {
    StabilisedFolder folder(place / "still");
    ASSERT_TRUE(folder.open());
    for (const auto& entry : fs::directory_iterator(place.path())) {  // acts like a full disk, also for root
      fs::remove(entry);
      put_text(entry.path().string(), "no folder");
    }
    EXPECT_EQ(measured_into(folder).observations.size(), 3U);
    const auto put = folder.finish();
    ASSERT_FALSE(put);
    EXPECT_FALSE(put.error().usage);
  }
  EXPECT_TRUE(fs::is_empty(place.path()));
}

TEST(StabilisedFolder, ExistingFilesAreNotChanged) {
  const TestFolder place;
  fs::create_directory(place / "taken");
  put_text(place / "taken/notes.txt", "precious");
  const auto taken = StabilisedFolder(place / "taken").open();
  ASSERT_FALSE(taken);
  EXPECT_TRUE(taken.error().usage);
  const auto below_a_file = StabilisedFolder(place / "taken/notes.txt/still").open();
  ASSERT_FALSE(below_a_file);
  EXPECT_FALSE(below_a_file.error().usage);
  EXPECT_EQ(text_of(place / "taken/notes.txt"), "precious");
}

TEST(StabilisedFolder, NestedFoldersThatAreReplacedAsAWholeAreDetected) {
  EXPECT_TRUE(overlaps("out", "./out/"));
  EXPECT_TRUE(overlaps("out/still", "out"));
  EXPECT_TRUE(overlaps("a", "a/b/../c"));
  EXPECT_FALSE(overlaps("out", "out-still"));
  EXPECT_FALSE(overlaps("a/b", "a/c"));
}

}  // namespace
}  // namespace moiregauge::internal

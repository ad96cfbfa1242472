// SPDX-License-Identifier: Apache-2.0
// Tests with Aravis's GigE Vision camera in this process: real packets over the loopback interface, with our own
// images.
#include "moiregauge/camera/genicam/genicam_source.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "moiregauge/camera/genicam/glib_objects.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr int kImages = 4;

// The camera sends the frames of a rendered recording over and over. Its sensor has 2048 x 2048 px.
struct Footage {
  std::vector<Image<std::uint8_t>> images;
  std::atomic<int> sent = 0;

  static void fill(ArvBuffer* buffer, void* self, guint32 /*exposure_us*/, guint32 /*gain*/,
                   ArvPixelFormat /*format*/) {
    auto& footage = *static_cast<Footage*>(self);
    int x = 0, y = 0, width = 0, height = 0;
    arv_buffer_get_image_region(buffer, &x, &y, &width, &height);
    std::size_t bytes = 0;
    auto* out = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &bytes)));  // states 0 bytes
    const auto& image = footage.images[static_cast<std::size_t>(footage.sent++) % footage.images.size()];
    if (width != image.width() || height != image.height()) return;
    for (int row = 0; row < height; ++row)
      std::memcpy(out + static_cast<std::ptrdiff_t>(row) * width, image.row(row).data(),
                  static_cast<std::size_t>(width));
  }
};

Footage& footage() {
  static Footage& all = *new Footage;  // the camera's thread may outlive the tests
  if (all.images.empty()) {
    const auto scenario = simulator::built_in("small-1x");
    for (int i = 0; i < kImages; ++i)
      all.images.push_back(simulator::render8(*scenario, 3 * i, {0, simulator::Area::kMarkersOnly}));
  }
  return all;
}

class FakeCamera {
 public:
  explicit FakeCamera(const char* serial, double lost_share = 0.0)
      : camera_(arv_gv_fake_camera_new("127.0.0.1", serial)) {
    g_object_set(camera_.get(), "gvsp-lost-ratio", lost_share, nullptr);
    arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera_.get()), &Footage::fill, &footage());
  }
  [[nodiscard]] bool is_running() const { return arv_gv_fake_camera_is_running(camera_.get()) != 0; }

 private:
  GlibObject<ArvGvFakeCamera> camera_;
};

GenicamSettings small_rig(double fps = 50.0) {
  GenicamSettings settings;
  settings.region = SensorRegion{0, 0, 1024, 512};
  settings.fps = fps;
  settings.packet_bytes = 8000;
  return settings;
}

std::unique_ptr<LiveSource> opened(const std::string& id, const GenicamSettings& settings) {
  auto source = open_genicam(id, settings);
  if (source) return std::move(*source);
  ADD_FAILURE() << source.error().message;
  return nullptr;
}

// Returns the rendered image that a frame shows, or -1.
int shown(const LiveFrame& frame) {
  const auto& view = std::get<ImageView<std::uint8_t>>(frame.frame.luma);
  for (int i = 0; i < kImages; ++i) {
    const auto& image = footage().images[static_cast<std::size_t>(i)];
    bool is_same = view.width == image.width() && view.height == image.height();
    for (int y = 0; is_same && y < view.height; ++y)
      is_same = std::equal(view.row(y).begin(), view.row(y).end(), image.row(y).begin());
    if (is_same) return i;
  }
  return -1;
}

// The camera starts a frame at each 20 ms of its clock at the earliest. A busy host delays a frame, also the first one,
// but no stamp is later than its arrival.
class ExpectedStamps {
 public:
  void expect(const Frame& frame) {
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
    if (!first_arrival_s_) first_arrival_s_ = elapsed_s;
    EXPECT_GE(frame.time_s, 0.02 * static_cast<double>(frame.number) - *first_arrival_s_);
    EXPECT_LE(frame.time_s, elapsed_s);
  }

 private:
  Clock::time_point start_ = Clock::now();
  std::optional<double> first_arrival_s_;
};

TEST(GenicamSource, EveryFrameArrivesWithItsPixelsNumberAndTime) {
  ExpectedStamps stamps;
  const FakeCamera camera("MG1");
  ASSERT_TRUE(camera.is_running());
  const auto source = opened("Aravis-MG1", small_rig());
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().width, 1024);
  EXPECT_EQ(source->info().codec, "genicam-mono8");
  std::set<int> images;
  double last_s = -1.0;
  for (long number = 0; number < 50; ++number) {
    const auto next = source->next(milliseconds(2000));
    ASSERT_TRUE(next && *next) << number;
    EXPECT_EQ((*next)->frame.number + 1, number + 1 + source->lost().frames()) << "numbers account for all frames";
    EXPECT_GT((*next)->frame.time_s, last_s);
    last_s = (*next)->frame.time_s;
    images.insert(shown(**next));
    stamps.expect((*next)->frame);
  }
  EXPECT_EQ(images, (std::set<int>{0, 1, 2, 3}));
}

// 2 % of the packets are lost. A frame of 66 packets is then complete with probability 0.98^66 = 26 %.
TEST(GenicamSource, FramesWithMissingPacketsAreCountedAndNeverDelivered) {
  ExpectedStamps stamps;
  const FakeCamera camera("MG2", 0.02);
  const auto source = opened("Aravis-MG2", small_rig());
  ASSERT_TRUE(source);
  long delivered = 0, last = -1;
  std::set<long> offsets;
  for (int waits = 0; waits < 60; ++waits) {
    const auto next = source->next(milliseconds(50));
    ASSERT_TRUE(next);
    if (!*next) continue;
    ++delivered;
    const int image = shown(**next);
    EXPECT_GE(image, 0) << "a delivered frame is whole";
    EXPECT_GT((*next)->frame.number, last);
    last = (*next)->frame.number;
    offsets.insert((last + kImages - image) % kImages);
    stamps.expect((*next)->frame);
  }
  // The camera shows its images in turn, also in frames that are lost on the way.
  EXPECT_EQ(offsets.size(), 1U) << "lost frames use up numbers";
  EXPECT_GT(source->lost().incomplete, 20);
  EXPECT_LE(last + 1 - delivered, source->lost().frames()) << "every gap in the numbers is counted";
}

TEST(GenicamSource, AnOverwhelmedConsumerLosesFramesAndCountsThem) {
  const FakeCamera camera("MG3");
  const auto source = opened("Aravis-MG3", small_rig(100.0));
  ASSERT_TRUE(source);
  ASSERT_TRUE(*source->next(milliseconds(2000)));
  std::this_thread::sleep_for(milliseconds(600));  // 60 frames for 15 free buffers
  long last = 0, delivered = 1;
  for (int i = 0; i < 30; ++i) {
    const auto next = source->next(milliseconds(2000));
    ASSERT_TRUE(next && *next);
    EXPECT_GE(shown(**next), 0);
    last = (*next)->frame.number;
    ++delivered;
  }
  EXPECT_GE(source->lost().queue_full, 20);
  EXPECT_EQ(last + 1, delivered + source->lost().frames()) << "numbers account for all frames";
}

TEST(GenicamSource, AMissingCameraAndAWrongSettingAreRefusedWithAReason) {
  const auto none = open_genicam("Aravis-none", {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, InputErrorKind::kUnreadable);
  const FakeCamera camera("MG4");
  GenicamSettings settings = small_rig();
  settings.pixel_format = "Mono99";
  const auto format = open_genicam("Aravis-MG4", settings);
  ASSERT_FALSE(format);
  EXPECT_NE(format.error().message.find("choose --pixel-format from Bayer"), std::string::npos)
      << format.error().message;
  settings = small_rig();
  settings.exposure_us = 1e12;
  const auto exposure = open_genicam("Aravis-MG4", settings);
  ASSERT_FALSE(exposure);
  EXPECT_NE(exposure.error().message.find("choose --exposure in this range"), std::string::npos)
      << exposure.error().message;
  settings = small_rig();
  settings.region = SensorRegion{0, 0, 5000, 512};
  EXPECT_FALSE(open_genicam("Aravis-MG4", settings));
}

// Waits until a frame arrives or the source ends. Fails after 20 s.
tl::expected<std::optional<LiveFrame>, SourceEnd> wait_for_frame(LiveSource& source) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (std::chrono::steady_clock::now() < until) {
    auto next = source.next(milliseconds(100));
    if (!next || *next) return next;
  }
  ADD_FAILURE() << "neither a frame nor an end";
  return std::optional<LiveFrame>();
}

TEST(GenicamSource, ACameraThatReturnsContinuesTheNumbersAndOneThatStaysAwayEndsTheSource) {
  auto camera = std::make_unique<FakeCamera>("MG5");
  GenicamSettings settings = small_rig();
  settings.patience = std::chrono::seconds(3);
  const auto source = opened("Aravis-MG5", settings);
  ASSERT_TRUE(source);
  const auto first = wait_for_frame(*source);
  ASSERT_TRUE(first && *first);
  camera.reset();
  long last = (*first)->frame.number;
  double last_s = (*first)->frame.time_s;
  for (auto next = source->next(milliseconds(500)); next && *next; next = source->next(milliseconds(500))) {
    last = (*next)->frame.number;
    last_s = (*next)->frame.time_s;
  }
  std::this_thread::sleep_for(milliseconds(1000));
  camera = std::make_unique<FakeCamera>("MG5");
  const auto back = wait_for_frame(*source);
  ASSERT_TRUE(back && *back);
  EXPECT_EQ(source->lost().reconnects, 1);
  EXPECT_GT((*back)->frame.number, last);
  EXPECT_GT((*back)->frame.time_s, last_s + 1.0) << "the host's clock bridges the gap";
  EXPECT_GE(shown(**back), 0);
  camera.reset();
  auto end = wait_for_frame(*source);
  while (end && *end) end = wait_for_frame(*source);
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, SourceEnd::Kind::kLost);
}

}  // namespace
}  // namespace moiregauge::internal

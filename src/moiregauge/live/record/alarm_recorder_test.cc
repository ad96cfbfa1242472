// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/record/alarm_recorder.h"

#include <algorithm>
#include <tuple>

#include <gtest/gtest.h>

#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

struct Recorded {
  std::string name;
  std::vector<double> times_s;
  std::vector<Image<std::uint8_t>> images;
  bool is_finished = false;
};
using Store = std::vector<std::unique_ptr<Recorded>>;

class MemoryWriter final : public RecordingWriter {
 public:
  explicit MemoryWriter(Recorded& to) : to_(to) {}
  tl::expected<void, std::string> add(const LumaView& luma, double time_s) override {
    const auto& view = std::get<ImageView<std::uint8_t>>(luma);
    Image<std::uint8_t> copy(view.width, view.height);
    for (int y = 0; y < view.height; ++y) std::copy(view.row(y).begin(), view.row(y).end(), copy.row(y).begin());
    to_.images.push_back(std::move(copy));
    to_.times_s.push_back(time_s);
    return {};
  }
  tl::expected<void, std::string> finish() override {
    to_.is_finished = true;
    return {};
  }

 private:
  Recorded& to_;
};

MakeRecordingWriter into(Store& store) {
  return [&store](const RecordingFormat& format) -> tl::expected<std::unique_ptr<RecordingWriter>, std::string> {
    store.push_back(std::make_unique<Recorded>());
    store.back()->name = format.name;
    return std::make_unique<MemoryWriter>(*store.back());
  };
}

// The small rig, and its reference frame.
struct Rig {
  simulator::Scenario scenario = *simulator::built_in("small-1x");
  Image<std::uint8_t> image = simulator::render8(scenario, 0, {0, simulator::Area::kMarkersOnly});
  Reference reference = *make_reference({image.view(), 8, 0.0}, simulator::site_of(scenario), Camera{}, {});
};
const Rig& rig() {
  static const Rig the_rig;
  return the_rig;
}

// Returns the pixels under the circle and the grating of every marker in frame 0.
std::vector<PixelBox> marker_boxes() {
  std::vector<PixelBox> boxes;
  for (const simulator::SceneMarker& marker : rig().scenario.markers) {
    const auto add = [&](BoardPoint centre, double half_x, double half_y) {
      const ImagePoint a = simulator::project(rig().scenario, 0, marker, {centre.x - half_x, centre.y + half_y});
      const ImagePoint b = simulator::project(rig().scenario, 0, marker, {centre.x + half_x, centre.y - half_y});
      boxes.push_back({static_cast<int>(a.x), static_cast<int>(a.y), static_cast<int>(b.x), static_cast<int>(b.y)});
    };
    const auto& [circle, grating] = std::tie(marker.print.circle, marker.print.grating);
    if (circle) add(circle->centre, 0.5 * circle->diameter_mm, 0.5 * circle->diameter_mm);
    if (grating) add(grating->centre, 0.5 * grating->width_mm, 0.5 * grating->height_mm);
  }
  return boxes;
}

void feed(AlarmRecorder& recorder, long from, long to, double fps) {
  for (long number = from; number < to; ++number) {
    Frame frame{number, static_cast<double>(number) / fps, false, rig().image.view()};
    recorder.add(frame, 8, &rig().reference, rig().reference.seen);
  }
}

AlarmEvent raised_at(long frame, double fps) {
  AlarmEvent event;
  event.is_raised = true;
  event.frame = frame;
  event.time_s = static_cast<double>(frame) / fps;
  return event;
}

TEST(AlarmRecorder, TheSecondsBeforeAndAfterAnAlarmAreKeptAfterTheReferenceFrame) {
  Store store;
  AlarmRecorder recorder({2.0, 1000.0}, into(store));
  feed(recorder, 0, 101, 10.0);
  recorder.alarm(raised_at(100, 10.0));
  feed(recorder, 101, 200, 10.0);
  recorder.finish();
  ASSERT_EQ(store.size(), 1U);
  const Recorded& recorded = *store[0];
  EXPECT_TRUE(recorded.is_finished);
  EXPECT_EQ(recorded.name, "alarm-000100");
  std::vector<double> expected = {0.0};
  for (long number = 80; number <= 120; ++number) expected.push_back(static_cast<double>(number) / 10.0);
  EXPECT_EQ(recorded.times_s, expected);
  EXPECT_EQ(recorder.recordings(), 1);
  EXPECT_EQ(recorder.lost_frames(), 0);
}

// Everything that a method reads of a marker is within its circle and grating.
TEST(AlarmRecorder, PixelsOfTheMarkersAreKeptExactlyAndTheRestIsGrey) {
  Store store;
  AlarmRecorder recorder({1.0, 1000.0}, into(store));
  feed(recorder, 0, 11, 10.0);
  recorder.alarm(raised_at(10, 10.0));
  recorder.finish();
  ASSERT_EQ(store.size(), 1U);
  const auto& whole = store[0]->images.front();
  const auto& part = store[0]->images.back();
  long kept = 0;
  for (int y = 0; y < whole.height(); ++y)
    for (int x = 0; x < whole.width(); ++x) {
      EXPECT_EQ(whole.at(x, y), rig().image.at(x, y));
      kept += part.at(x, y) == rig().image.at(x, y) ? 1 : 0;
    }
  EXPECT_LT(kept, static_cast<long>(whole.width()) * whole.height()) << "the rest is removed";
  for (const PixelBox& box : marker_boxes()) {
    for (int y = box.y0; y <= box.y1; ++y)
      for (int x = box.x0; x <= box.x1; ++x) ASSERT_EQ(part.at(x, y), rig().image.at(x, y)) << x << " " << y;
  }
}

TEST(AlarmRecorder, AnotherAlarmExtendsTheRecording) {
  Store store;
  AlarmRecorder recorder({1.0, 1000.0}, into(store));
  feed(recorder, 0, 21, 10.0);
  recorder.alarm(raised_at(20, 10.0));
  feed(recorder, 21, 26, 10.0);
  recorder.alarm(raised_at(25, 10.0));
  feed(recorder, 26, 60, 10.0);
  recorder.alarm(raised_at(59, 10.0));
  recorder.finish();
  ASSERT_EQ(store.size(), 2U);
  EXPECT_EQ(store[0]->times_s.back(), 3.5);
  EXPECT_TRUE(store[1]->is_finished) << "the end of the run completes a recording";
}

TEST(AlarmRecorder, MemoryIsBoundedAndLossesAreCounted) {
  Store store;
  RecordOptions options{10.0, 1000.0};
  const std::size_t frame_bytes = 1024 * 512;
  options.max_bytes = 4 * frame_bytes;
  AlarmRecorder recorder(options, into(store));
  feed(recorder, 0, 1001, 100.0);  // the ring would have 1000 frames
  recorder.alarm(raised_at(1000, 100.0));
  recorder.finish();
  ASSERT_EQ(store.size(), 1U);
  const std::size_t pixels = MarkerWindows(rig().reference).in(rig().reference.seen).size();
  EXPECT_EQ(pixels, rig().reference.site.markers.size());
  EXPECT_LT(store[0]->times_s.size(), 100U);
  EXPECT_EQ(store[0]->times_s.back(), 10.0) << "the newest frames are kept";
}

TEST(AlarmRecorder, FullFramesComeAtTheStatedInterval) {
  Store store;
  AlarmRecorder recorder({10.0, 0.5}, into(store));
  feed(recorder, 0, 21, 10.0);
  recorder.alarm(raised_at(20, 10.0));
  recorder.finish();
  ASSERT_EQ(store.size(), 1U);
  const auto is_whole = [](const Image<std::uint8_t>& image) {
    for (int y = 0; y < image.height(); ++y) {
      if (!std::equal(image.row(y).begin(), image.row(y).end(), rig().image.row(y).begin())) return false;
    }
    return true;
  };
  // The reference frame, then every 0.5 s up to 2 s.
  EXPECT_EQ(std::count_if(store[0]->images.begin(), store[0]->images.end(), is_whole), 5);
}

TEST(AlarmRecorder, AWriterThatFailsIsReported) {
  AlarmRecorder recorder({1.0, 1000.0},
                         [](const RecordingFormat&) -> tl::expected<std::unique_ptr<RecordingWriter>, std::string> {
                           return tl::unexpected(std::string("recordings/a.mkv: No space left on device"));
                         });
  feed(recorder, 0, 11, 10.0);
  recorder.alarm(raised_at(10, 10.0));
  recorder.finish();
  EXPECT_EQ(recorder.problem(), "recordings/a.mkv: No space left on device");
  EXPECT_EQ(recorder.recordings(), 0);
}

}  // namespace
}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/network/network_source.h"

#include <optional>

#include "moiregauge/camera/network/servers_for_tests.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

LiveAddress address(const std::string& url) {
  LiveAddress to;
  to.url = url;
  to.timeout = std::chrono::seconds(5);
  return to;
}

NetworkOptions patient(int seconds) {
  NetworkOptions options;
  options.patience = std::chrono::seconds(seconds);
  return options;
}

// Opens a stream as soon as its server listens.
std::unique_ptr<LiveSource> opened(const std::string& url, int patience_s = 10) {
  std::string problem;
  for (int i = 0; i < 100; ++i) {
    auto source = open_network(address(url), patient(patience_s));
    if (source) return std::move(*source);
    problem = source.error().message;
    std::this_thread::sleep_for(milliseconds(50));
  }
  ADD_FAILURE() << problem;
  return nullptr;
}

struct Facts {
  long number = -1;
  double time_s = -1.0;
  bool has_device = false;
};

// Reads frames and requires increasing numbers and times. Returns the last frame, or nothing if the source ended.
std::optional<Facts> read(LiveSource& source, int frames, Facts last = {}) {
  const auto until = steady_clock::now() + std::chrono::seconds(20);
  while (frames > 0) {
    const auto next = source.next(milliseconds(200));
    if (!next || steady_clock::now() > until) return std::nullopt;
    if (!*next) continue;
    EXPECT_GT((*next)->frame.number, last.number);
    EXPECT_GT((*next)->frame.time_s, last.time_s);
    EXPECT_FALSE((*next)->frame.damaged);
    last = {(*next)->frame.number, (*next)->frame.time_s, (*next)->device_ns.has_value()};
    --frames;
  }
  return last;
}

TEST(NetworkSource, RtspFramesHaveTheTimesOfTheCamera) {
  const test::RtspCamera camera(0);
  const auto source = opened(fmt::format("rtsp://user:secret@127.0.0.1:{}/stream", camera.port()));
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().path, fmt::format("rtsp://user:***@127.0.0.1:{}/stream", camera.port()));
  EXPECT_EQ(source->info().width, 320);
  EXPECT_EQ(source->info().codec, "h264");
  EXPECT_EQ(source->info().time_source, "camera");
  const auto last = read(*source, 30);
  ASSERT_TRUE(last);
  EXPECT_TRUE(last->has_device);
  // The camera's clock advances 40 ms per frame, in steps of 1/90000 s, whenever the frames arrive.
  EXPECT_NEAR(last->time_s, 0.04 * static_cast<double>(last->number), 1e-4);
}

TEST(NetworkSource, AStreamThatReturnsContinuesAndOneThatStaysAwayEndsTheSource) {
  const int port = test::free_stream_port();
  auto camera = std::make_unique<test::HttpCamera>(port, "mpegts");
  const auto source = opened(fmt::format("http://127.0.0.1:{}/", port), 4);
  ASSERT_TRUE(source);
  const auto first = read(*source, 10);
  ASSERT_TRUE(first);
  camera = std::make_unique<test::HttpCamera>(port, "mpegts");  // the old one ends with its connection
  camera.reset();
  camera = std::make_unique<test::HttpCamera>(port, "mpegts");
  std::optional<Facts> last = first;
  for (int i = 0; i < 20 && last && source->lost().reconnects == 0; ++i) last = read(*source, 10, *last);
  ASSERT_TRUE(last);
  EXPECT_EQ(source->lost().reconnects, 1);
  camera.reset();
  const auto lost_at = steady_clock::now();
  while (read(*source, 1, *last) && steady_clock::now() - lost_at < std::chrono::seconds(20)) {
  }
  const auto end = source->next(milliseconds(0));
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, SourceEnd::Kind::kLost);
  EXPECT_GT(steady_clock::now() - lost_at, std::chrono::seconds(3)) << "it was tried for 4 s";
}

TEST(NetworkSource, MotionJpegHasNoTimesOfItsOwn) {
  const int port = test::free_stream_port();
  const test::HttpCamera camera(port, "mpjpeg");
  const auto source = opened(fmt::format("http://127.0.0.1:{}/", port));
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().codec, "mjpeg");
  EXPECT_EQ(source->info().time_source, "host");
  const auto last = read(*source, 10);
  ASSERT_TRUE(last);
  EXPECT_FALSE(last->has_device);
}

TEST(NetworkSource, ASlowConsumerLosesFramesAndCountsThem) {
  const test::RtspCamera camera(0);
  const auto source = opened(fmt::format("rtsp://127.0.0.1:{}/", camera.port()));
  ASSERT_TRUE(source);
  const auto first = read(*source, 1);
  ASSERT_TRUE(first);
  std::this_thread::sleep_for(milliseconds(1500));  // 37 frames for 7 free slots
  const auto last = read(*source, 20, *first);
  ASSERT_TRUE(last);
  EXPECT_GT(source->lost().queue_full, 5);
  EXPECT_EQ(last->number + 1, 21 + source->lost().frames()) << "numbers account for all frames";
}

TEST(NetworkSource, AnAbsentServerAndAFileThatIsNoVideoAreRefused) {
  const int port = test::free_stream_port();
  for (const char* scheme : {"rtsp", "http"}) {
    const auto none = open_network(address(fmt::format("{}://u:secret@127.0.0.1:{}/", scheme, port)), patient(1));
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().kind, InputErrorKind::kUnreadable) << none.error().message;
    EXPECT_EQ(none.error().message.find("secret"), std::string::npos);
  }
  const auto device = open_network(address("v4l2:/dev/video-none"), patient(1));
  ASSERT_FALSE(device);
}

TEST(LiveAddress, TextsAreReadBack) {
  LiveAddress full = address("rtsp://u:p@host:554/a?b=c");
  full.fps = 29.97;
  const auto back = live_address_of(text_of(full));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->url, full.url);
  EXPECT_EQ(back->timeout, full.timeout);
  EXPECT_EQ(back->fps, full.fps);
  for (const char* text : {"", "a", "a\nb\n\n", "a\n0\n\n", "a\n5"}) EXPECT_FALSE(live_address_of(text)) << text;
}

}  // namespace
}  // namespace moiregauge::internal

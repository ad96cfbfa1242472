// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/pipe/y4m_source.h"

#include <unistd.h>

#include <cmath>
#include <csignal>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "moiregauge/camera/pipe/y4m_header.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;

// A pipe whose reading end a source has. Closing the writer ends the stream.
class Pipe {
 public:
  Pipe() { EXPECT_EQ(::pipe(ends_), 0); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_writer();
    ::close(ends_[0]);
  }
  [[nodiscard]] int reader() const { return ends_[0]; }
  void put(const std::string& bytes) const {
    EXPECT_EQ(::write(ends_[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  void close_writer() {
    if (ends_[1] >= 0) ::close(std::exchange(ends_[1], -1));
  }

 private:
  int ends_[2] = {-1, -1};
};

std::unique_ptr<LiveSource> opened(const Pipe& pipe, const PipeOptions& options = {}) {
  auto source = open_y4m_pipe(pipe.reader(), options);
  if (source) return std::move(*source);
  ADD_FAILURE() << source.error().message;
  return nullptr;
}

TEST(Y4mPipe, LumaAndTimesAreThoseOfTheStream) {
  Pipe pipe;
  pipe.put("YUV4MPEG2 W4 H2 F50:2 Ip A1:1 C420jpeg\nFRAME\n" + std::string("abcdefgh") + "UUVV");
  pipe.put("FRAME Ip\nABCDEFGHuuvv");
  pipe.close_writer();
  const auto source = opened(pipe);
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().width, 4);
  EXPECT_EQ(source->info().fps, 25.0);
  for (long number = 0; number < 2; ++number) {
    const auto next = source->next(milliseconds(1000));
    ASSERT_TRUE(next && *next);
    EXPECT_EQ((*next)->frame.number, number);
    EXPECT_EQ((*next)->frame.time_s, static_cast<double>(number) / 25.0);
    EXPECT_EQ(std::get<ImageView<std::uint8_t>>((*next)->frame.luma).at(1, 1), number == 0 ? 'f' : 'F');
  }
  const auto end = source->next(milliseconds(1000));
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, SourceEnd::Kind::kFinished);
  EXPECT_EQ(source->lost(), LostFrames{});
}

TEST(Y4mPipe, DeepGreyKeepsItsDepth) {
  Pipe pipe;
  pipe.put("YUV4MPEG2 W2 H1 F10:1 Cmono12\nFRAME\n" + std::string("\xbc\x0a\x23\x01", 4));
  const auto source = opened(pipe);
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().bits, 12);
  const auto next = source->next(milliseconds(1000));
  ASSERT_TRUE(next && *next);
  const auto& luma = std::get<ImageView<std::uint16_t>>((*next)->frame.luma);
  EXPECT_EQ(luma.at(0, 0), 0xABC);
  EXPECT_EQ(luma.at(1, 0), 0x123);
}

TEST(Y4mPipe, AFrameThatArrivesInPiecesIsOneFrame) {
  Pipe pipe;
  pipe.put("YUV4MPEG2 W4 H1 Cmono\n");
  const auto source = opened(pipe);
  ASSERT_TRUE(source);
  for (const char* piece : {"FRA", "ME\n", "ab", "c"}) {
    pipe.put(piece);
    const auto next = source->next(milliseconds(5));
    ASSERT_TRUE(next);
    EXPECT_FALSE(*next) << "incomplete after " << piece;
  }
  pipe.put("d");
  const auto next = source->next(milliseconds(1000));
  ASSERT_TRUE(next && *next);
  EXPECT_EQ(std::get<ImageView<std::uint8_t>>((*next)->frame.luma).at(3, 0), 'd');
}

TEST(Y4mPipe, WithoutARateTimesAreThoseOfTheHost) {
  Pipe pipe;
  pipe.put("YUV4MPEG2 W1 H1 F0:0 Cmono\nFRAME\na");
  const auto source = opened(pipe);
  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().time_source, "host");
  ASSERT_TRUE(*source->next(milliseconds(1000)));
  std::this_thread::sleep_for(milliseconds(20));
  pipe.put("FRAME\nb");
  const auto second = source->next(milliseconds(1000));
  ASSERT_TRUE(second && *second);
  EXPECT_GE((*second)->frame.time_s, 0.020);
}

TEST(Y4mPipe, AStreamCutWithinAFrameLosesThatFrameOnly) {
  Pipe pipe;
  pipe.put("YUV4MPEG2 W4 H1 Cmono\nFRAME\nabcdFRAME\nab");
  pipe.close_writer();
  const auto source = opened(pipe);
  ASSERT_TRUE(source);
  ASSERT_TRUE(*source->next(milliseconds(1000)));
  EXPECT_FALSE(source->next(milliseconds(1000)));
  EXPECT_EQ(source->lost().incomplete, 1);
}

TEST(Y4mPipe, DamageBetweenFramesEndsTheSource) {
  Pipe pipe;
  pipe.put("YUV4MPEG2 W4 H1 Cmono\nFRAME\nabcdeFRAME\nabcd");
  const auto source = opened(pipe);
  ASSERT_TRUE(source);
  ASSERT_TRUE(*source->next(milliseconds(1000)));
  const auto end = source->next(milliseconds(1000));
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, SourceEnd::Kind::kLost);
}

TEST(Y4mPipe, OtherDataIsRefusedWithAReason) {
  Pipe empty;
  empty.close_writer();
  EXPECT_EQ(open_y4m_pipe(empty.reader(), {}).error().message,
            "the stream is empty: stdin: check the program that writes it");
  Pipe silent;
  EXPECT_EQ(open_y4m_pipe(silent.reader(), {.patience = milliseconds(10)}).error().kind, InputErrorKind::kUnreadable);
  for (const std::string line :
       {"\x89PNG", "YUV4MPEG2 W0 H1", "YUV4MPEG2 W4", "YUV4MPEG2 W4 H1 C410", "YUV4MPEG2 W4 H1 C420p99",
        "YUV4MPEG2 W99999 H99999", "YUV4MPEG2 W-4 H1", "YUV4MPEG2 W4 H1 Cmono8x"}) {
    Pipe pipe;
    pipe.put(line + "\n");
    const auto source = open_y4m_pipe(pipe.reader(), {});
    ASSERT_FALSE(source) << line;
    EXPECT_EQ(source.error().kind, InputErrorKind::kUnsupported) << line;
  }
}

// Sizes by the definition of each colour space, for an odd width and height of 5 x 3.
TEST(Y4mHeader, ChromaOfOddSizesIsRoundedUp) {
  const auto bytes = [](const std::string& colours) {
    return read_y4m_header("YUV4MPEG2 W5 H3 C" + colours, 1000)->frame_bytes;
  };
  EXPECT_EQ(bytes("mono"), 15U);
  EXPECT_EQ(bytes("420"), 15U + 2 * 3 * 2);
  EXPECT_EQ(bytes("422"), 15U + 2 * 3 * 3);
  EXPECT_EQ(bytes("411"), 15U + 2 * 2 * 3);
  EXPECT_EQ(bytes("444alpha"), 4U * 15);
  EXPECT_EQ(bytes("420p10"), 2 * (15U + 2 * 3 * 2));
  EXPECT_EQ(bytes("mono16"), 30U);
}

}  // namespace
}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/frame_notes.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

std::vector<Observation> frames_at(const std::vector<double>& times) {
  std::vector<Observation> frames(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    frames[i].frame = static_cast<long>(i);
    frames[i].time_s = times[i];
  }
  return frames;
}

std::vector<std::string> notes_on(const std::vector<Observation>& frames) {
  Observations all;
  for (const Observation& frame : frames) all.push_back(frame);
  return notes_on_frames(all);
}

TEST(FrameNotes, ARegularRecordingHasNoNotes) {
  EXPECT_TRUE(notes_on({}).empty());
  EXPECT_TRUE(notes_on(frames_at({0.0, 0.033, 0.067, 0.1, 0.133})).empty());
  EXPECT_TRUE(notes_on(frames_at({NAN, NAN, NAN})).empty()) << "pictures without time";
}

TEST(FrameNotes, AGapInTimeIsReportedWithItsPosition) {
  const auto notes = notes_on(frames_at({0.0, 0.04, 0.08, 1.36, 1.4}));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0], "note: the frame rate varies (largest gap 1.28 s at 0.08 s). The stream's own times are used");
}

TEST(FrameNotes, SkippedFramesAreNoGap) {
  auto frames = frames_at({0.0, 0.04, 0.08, 0.28, 0.32});
  for (std::size_t i : {3U, 4U}) frames[i].frame += 4;
  EXPECT_TRUE(notes_on(frames).empty());
}

TEST(FrameNotes, DamagedFramesAreCountedAndTheirTimesIgnored) {
  auto frames = frames_at({0.0, 0.04, 9.0, 7.0, 0.16, 0.2});
  frames[2].decode_error = frames[3].decode_error = true;
  const auto notes = notes_on(frames);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0],
            "2 frames have no values (decode-error): the input is damaged from frame 2 on. Copy the recording again "
            "from the camera");
}

}  // namespace
}  // namespace moiregauge::internal

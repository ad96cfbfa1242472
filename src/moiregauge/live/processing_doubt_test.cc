// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/processing_doubt.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

// One sample of a target with u = 1 um.
Samples at(long frame, double x_mm) {
  Sample sample;
  sample.frame = frame;
  sample.displacement = {x_mm, 0.0};
  sample.u = {0.001, 0.001};
  sample.status = Status::kOk;
  return {sample};
}

// Evidence that frames repeat the one before them.
CameraProcessing repeated(std::vector<long> frames) {
  CameraProcessing processing;
  processing.repeated = std::move(frames);
  return processing;
}

// Returns the status of frame n at the positions `x_mm`. All frames from `first` on are repeated.
std::vector<Status> status_of(const std::vector<double>& x_mm, long first) {
  ProcessingDoubt doubt;
  std::vector<Status> out;
  std::vector<long> frames;
  for (std::size_t n = 0; n < x_mm.size(); ++n) {
    const auto frame = static_cast<long>(n);
    if (frame >= first) frames.push_back(frame);
    Samples samples = at(frame, x_mm[n]);
    doubt.apply(repeated(frames), false, {frame, 0.0}, samples);
    out.push_back(samples.front().status);
  }
  return out;
}

TEST(ProcessingDoubt, AMovingTargetIsUntrustedInARepeatedFrame) {
  const auto status = status_of({0.0, 0.1, 0.2, 0.3}, 2);
  EXPECT_EQ(status, (std::vector{Status::kOk, Status::kOk, Status::kUntrusted, Status::kUntrusted}));
}

TEST(ProcessingDoubt, AStillTargetStaysOk) {
  EXPECT_EQ(status_of(std::vector(12, 0.5), 1), std::vector(12, Status::kOk));
}

TEST(ProcessingDoubt, ATargetThatStoppedIsTrustedAgainAfterTheLongestLag) {
  std::vector<double> x_mm(2 + 2 * kLagSamples, 1.0);
  x_mm[0] = 0.0;  // moves between frames 0 and 1 only
  const auto status = status_of(x_mm, 0);
  EXPECT_EQ(status[1], Status::kUntrusted);
  EXPECT_EQ(status[kLagSamples], Status::kUntrusted);
  EXPECT_EQ(status[kLagSamples + 1], Status::kOk);
}

TEST(ProcessingDoubt, OldRepeatedFramesNeedNotBeKept) {
  ProcessingDoubt doubt;
  EXPECT_EQ(doubt.first_frame(), 0);
  for (long frame = 100; frame < 150; ++frame) {
    Samples samples = at(frame, 0.0);
    doubt.apply({}, false, {frame, 0.0}, samples);
  }
  EXPECT_EQ(doubt.first_frame(), 150 - static_cast<long>(kLagSamples));
}

TEST(ProcessingDoubt, PixelsRepeatedByEnlargingConcernAllSamples) {
  CameraProcessing processing;
  processing.steps.all = processing.steps.repeated = 1'000'000;
  ProcessingDoubt doubt;
  Samples samples = at(1, 0.0);
  doubt.apply(processing, false, {1, 0.0}, samples);
  EXPECT_EQ(samples.front().status, Status::kUntrusted);
}

// Returns the status of a target at rest behind an average with a share of the previous frame. The camera moved by
// `pitches`.
Status averaged(double share, double pitches) {
  CameraProcessing processing;
  processing.moving.values = processing.moving.two_apart = 1e5;
  processing.moving.one_apart = 1e5 / (1.0 + share);
  ProcessingDoubt doubt;
  Samples samples = at(1, 0.0);
  doubt.apply(processing, false, {1, pitches}, samples);
  return samples.front().status;
}

TEST(ProcessingDoubt, OverlappingImagesConcernTargetsAtRestToo) {
  EXPECT_EQ(averaged(0.2, 0.2), Status::kOk);
  EXPECT_EQ(averaged(0.2, 0.3), Status::kUntrusted);
}

TEST(ProcessingDoubt, AStrongAverageHidesTheCamerasMotion) {
  EXPECT_EQ(averaged(0.6, 0.002), Status::kOk);
  EXPECT_EQ(averaged(0.6, 0.02), Status::kUntrusted);
}

// Returns the status of a moving target whose blur grows with its movement by `slope`, in frames^2.
Status blurred(double slope, double u) {
  CameraProcessing processing;
  processing.echo.blur = {slope, u};
  ProcessingDoubt doubt;
  Samples before = at(0, 0.0), samples = at(1, 1.0);
  doubt.apply(processing, true, {0, 0.0}, before);
  doubt.apply(processing, true, {1, 0.0}, samples);
  return samples.front().status;
}

// The longest exposure has a slope of 1/6. Three equal frames have 2/3.
TEST(ProcessingDoubt, BlurOfLargeUncertaintyNeedsMoreEvidence) {
  EXPECT_EQ(blurred(0.66, 0.2), Status::kUntrusted);
  EXPECT_EQ(blurred(0.5, 0.2), Status::kOk);
  EXPECT_EQ(blurred(11.3, 4.7), Status::kOk);
  EXPECT_EQ(blurred(20.0, 4.7), Status::kUntrusted);
}

}  // namespace
}  // namespace moiregauge::internal

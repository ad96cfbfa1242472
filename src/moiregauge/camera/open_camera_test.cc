// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/open_camera.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

std::string error_of(const CameraArgs& args) {
  const auto source = open_camera(args);
  return source ? "" : source.error().message;
}

TEST(OpenCamera, TheTextDecidesTheKindOfSource) {
  for (const char* source : {"camera", "camera:Basler-1", "-", "rtsp://host/x", "https://host", "v4l2:/dev/video0"})
    EXPECT_TRUE(is_camera_source(source)) << source;
  for (const char* source : {"clip.mp4", "cameras", "", "folder/camera", "--"})
    EXPECT_FALSE(is_camera_source(source)) << source;
}

TEST(OpenCamera, AnOptionThatTheSourceDoesNotHaveIsRefused) {
  CameraArgs args;
  args.source = "-";
  args.exposure_us = 500.0;
  EXPECT_EQ(error_of(args), "the source has no --exposure: -: omit --exposure, or give a GenICam camera");
}

TEST(OpenCamera, ARegionIsFourNumbers) {
  for (const char* region : {"1,2,3", "1,2,3,4,5", "1;2;3;4", "0,0,0,10", "-1,0,10,10", "a,b,c,d", "1,2,3,4px"}) {
    CameraArgs args;
    args.source = "camera:none";
    args.region = region;
    EXPECT_NE(error_of(args).find("is not X,Y,WIDTH,HEIGHT"), std::string::npos) << region;
  }
}

}  // namespace
}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/camera_file.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

void expect_the_camera(const tl::expected<Camera, std::string>& read) {
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->width, 640);
  EXPECT_EQ(read->height, 480);
  EXPECT_EQ(read->fx, 534.5);
  EXPECT_EQ(read->fy, 535.25);
  EXPECT_EQ(read->cx, 320.5);
  EXPECT_EQ(read->cy, 240.0);
  EXPECT_EQ(read->k1, -0.25);
  EXPECT_EQ(read->k2, 0.0625);
  EXPECT_EQ(read->p1, 1e-3);
  EXPECT_EQ(read->p2, -2e-4);
  EXPECT_EQ(read->k3, 0.125);
}

TEST(CameraFile, TomlAndTheYamlOfOpencvAndRosGiveTheSameCamera) {
  expect_the_camera(parse_camera(
      "[camera]\nwidth = 640\nheight = 480\nfx = 534.5\nfy = 535.25\ncx = 320.5\ncy = 240\nk1 = -0.25\nk2 = 0.0625\n"
      "p1 = 1e-3\np2 = -2e-4\nk3 = 0.125\n",
      "camera.toml"));
  expect_the_camera(parse_camera(
      "%YAML:1.0\n---\ncalibration_time: \"Tue 09 May 2023 10:11:12\"\nimage_width: 640\nimage_height: 480\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 5.345e+02, 0., 3.205e+02, 0.,\n"
      "       5.3525e+02, 240., 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: "
      "d\n"
      "   data: [ -0.25, 6.25e-02,\n       1e-03, -2.e-04, 0.125 ]\navg_reprojection_error: 1.7e-01\n",
      "camera.yml"));
  expect_the_camera(parse_camera(
      "image_width: 640\nimage_height: 480\ncamera_name: narrow_stereo\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [534.5, 0, 320.5, 0, 535.25, 240, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n"
      "  rows: 1\n  cols: 5\n  data:\n  - -0.25\n  - 0.0625\n  - 0.001\n  - -0.0002\n  - 0.125\nrectification_matrix:\n"
      "  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n",
      "camera.yaml"));
}

TEST(CameraFile, ALensBeyondFiveTermsIsRefused) {
  const std::string matrix = "camera_matrix: [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\n";
  EXPECT_TRUE(parse_camera(matrix, "c.yaml"));
  EXPECT_TRUE(parse_camera(matrix + "distortion_coefficients: [1, 2, 3, 4, 5, 0, 0, 0]\n", "c.yaml"));
  EXPECT_FALSE(parse_camera(matrix + "distortion_coefficients: [1, 2, 3, 4, 5, 6, 7, 8]\n", "c.yaml"));
  EXPECT_FALSE(
      parse_camera(matrix + "distortion_model: equidistant\ndistortion_coefficients: [1, 2, 3, 4]\n", "c.yaml"));
  EXPECT_FALSE(parse_camera("camera_matrix: [500, 0.5, 320, 0, 500, 240, 0, 0, 1]\n", "c.yaml")) << "skew";
  EXPECT_FALSE(parse_camera("camera_matrix: [500, 0, 320]\n", "c.yaml"));
  EXPECT_FALSE(parse_camera("camera_matrix: [a, b]\n", "c.yaml"));
  EXPECT_FALSE(parse_camera("%YAML:1.0\n", "c.yaml"));
}

TEST(CameraFile, MistakesAreReportedWithTheirPositions) {
  const auto read = parse_camera("[camera]\nfx = -1.0\nfy = 500.0\ncx = 1.0\nk4 = 0.1\n", "c.toml");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().find("c.toml:2:6: fx must be greater than 0"), std::string::npos) << read.error();
  EXPECT_NE(read.error().find("requires cy"), std::string::npos) << read.error();
  EXPECT_NE(read.error().find("the key \"k4\" is unknown"), std::string::npos) << read.error();
  EXPECT_NE(parse_camera("x = 1\n", "c.toml").error().find("no [camera]"), std::string::npos);
  EXPECT_NE(read_camera("/nowhere/c.toml").error().find("/nowhere/c.toml: cannot be read"), std::string::npos);
}

TEST(CameraFile, AllMistakesInACalibrationAreReportedWithTheirPositions) {
  const auto read = parse_camera(
      "image_width: 10mm\nimage_height: 480\ncamera_matrix:\n  data: [1e999, 0, 320, 0, 500, 240, 0, 0, 1]\n"
      "distortion_coefficients: [0.1, 1,5]\ndistortion_model: equidistant\nimage_height: 481\n",
      "c.yaml");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error(),
            "c.yaml:1:1: image_width must be a whole number of pixels\n"
            "c.yaml:3:1: camera_matrix contains \"1e999\", which is not a finite number\n"
            "c.yaml:5:1: distortion_coefficients holds fewer than 4 numbers\n"
            "c.yaml:6:1: a fisheye lens is not supported, only the model with k1 k2 p1 p2 k3\n"
            "c.yaml:7:1: image_height is given twice (first in line 2), remove one");
}

TEST(CameraFile, TwoCamerasInAFileAreRefused) {
  const auto read = parse_camera(
      "left:\n  camera_matrix: [500, 0, 320, 0, 500, 240, 0, 0, 1]\nright:\n  camera_matrix: [510, 0, 320, 0, 510, "
      "240, 0, 0, 1]\n",
      "c.yaml");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error(), "c.yaml:4:3: camera_matrix is given twice (first in line 2), remove one");
}

TEST(CameraFile, AWidthWithoutAHeightIsNoSize) {
  const std::string matrix = "camera_matrix: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n";
  EXPECT_EQ(parse_camera("image_width: 640\n" + matrix, "c.yaml").error(), "c.yaml:1:1: image_height is missing");
  EXPECT_FALSE(parse_camera("[camera]\nheight = 480\nfx = 1.0\nfy = 1.0\ncx = 0.0\ncy = 0.0\n", "c.toml"));
}

TEST(CameraFile, AWrittenCameraReadsBackToTheLastBitWithItsUncertainty) {
  const double third = 1.0 / 3.0;
  const Camera camera{640,          480, 500 * third, 500 * third, 320 + third, 240, -0.1 * third, 1e-9 * third, 0,
                      1e-4 * third, 0};
  const CameraWidths u{third, 2 * third, 3, 1e-5 * third, 1e-6, 0.0, 1e-7, std::nan("")};
  const auto read = parse_known_camera(write_camera(camera, u), "camera.toml");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->camera.width, 640);
  EXPECT_EQ(read->camera.height, 480);
  EXPECT_EQ(read->camera.fx, camera.fx);
  EXPECT_EQ(read->camera.fy, camera.fy);
  EXPECT_EQ(read->camera.cx, camera.cx);
  EXPECT_EQ(read->camera.cy, camera.cy);
  EXPECT_EQ(read->camera.k1, camera.k1);
  EXPECT_EQ(read->camera.k2, camera.k2);
  EXPECT_EQ(read->camera.p1, camera.p1);
  EXPECT_EQ(read->camera.p2, camera.p2);
  ASSERT_TRUE(read->u);
  for (const std::size_t k : {0, 1, 2, 3, 4, 6}) EXPECT_EQ((*read->u)[k], u[k]) << k;
  for (const std::size_t k : {5, 7}) EXPECT_TRUE(std::isnan((*read->u)[k])) << k;
  EXPECT_FALSE(parse_known_camera("[camera]\nfx = 1.0\nfy = 1.0\ncx = 0.0\ncy = 0.0\n", "c.toml")->u);
  EXPECT_NE(parse_known_camera("[camera]\nfx = 1.0\nfy = 1.0\ncx = 0.0\ncy = 0.0\n[camera.u]\nf = 1.0\n", "c.toml")
                .error()
                .find("the key \"f\" is unknown"),
            std::string::npos);
}

}  // namespace
}  // namespace moiregauge::internal

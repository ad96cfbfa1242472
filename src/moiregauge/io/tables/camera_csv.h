// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "moiregauge/displacement/camera_pose.h"
#include "moiregauge/run/measure.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {

// Camera pose of one frame.
struct CameraRow {
  long frame = 0;
  double time_s = kNotMeasured;
  CameraPose pose;
};

// Column of camera.csv and of the group `camera` of displacement.h5.
struct CameraColumn {
  const char* name;
  const char* unit;
  double (*value)(const CameraPose&);
};
template <std::size_t kAxis>
inline constexpr std::array kCameraColumnsOf{
    +[](const CameraPose& p) { return degrees_from_radians(p.angle_rad[kAxis]); },
    +[](const CameraPose& p) { return p.shift_mm[kAxis]; },
    +[](const CameraPose& p) { return degrees_from_radians(p.u_angle_rad[kAxis]); },
    +[](const CameraPose& p) { return p.u_shift_mm[kAxis]; }};
inline constexpr std::array kCameraColumns{
    CameraColumn{"rx_deg", "deg", kCameraColumnsOf<0>[0]},   CameraColumn{"ry_deg", "deg", kCameraColumnsOf<1>[0]},
    CameraColumn{"rz_deg", "deg", kCameraColumnsOf<2>[0]},   CameraColumn{"tx_mm", "mm", kCameraColumnsOf<0>[1]},
    CameraColumn{"ty_mm", "mm", kCameraColumnsOf<1>[1]},     CameraColumn{"tz_mm", "mm", kCameraColumnsOf<2>[1]},
    CameraColumn{"u_rx_deg", "deg", kCameraColumnsOf<0>[2]}, CameraColumn{"u_ry_deg", "deg", kCameraColumnsOf<1>[2]},
    CameraColumn{"u_rz_deg", "deg", kCameraColumnsOf<2>[2]}, CameraColumn{"u_tx_mm", "mm", kCameraColumnsOf<0>[3]},
    CameraColumn{"u_ty_mm", "mm", kCameraColumnsOf<1>[3]},   CameraColumn{"u_tz_mm", "mm", kCameraColumnsOf<2>[3]}};

// Returns the camera pose of every selected frame. Empty: no pose is stated, because the method solves none, the focal
// length is unknown, or the run was refused.
[[nodiscard]] std::vector<CameraRow> camera_rows(const Measurement& measurement);

// Returns camera.csv (docs/file-formats.md).
[[nodiscard]] std::string camera_csv(const std::vector<CameraRow>& rows);

}  // namespace moiregauge::internal

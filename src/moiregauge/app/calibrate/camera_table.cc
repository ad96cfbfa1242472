// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/calibrate/camera_table.h"

#include <array>

namespace moiregauge::internal {
namespace {

constexpr std::array kCameras{
    NamedCamera{"imx250", "machine vision, 5 Mpx, global shutter", 2464, 2056, 3.45, 0.0, false,
                "Teledyne DALSA, Genie Nano manual, M2450"},
    NamedCamera{"imx255", "machine vision, 9 Mpx, global shutter", 4112, 2176, 3.45, 0.0, false,
                "Matrix Vision, mvBlueFOX3 manual, IMX255"},
    NamedCamera{"imx273", "machine vision, 1.6 Mpx, global shutter", 1456, 1088, 3.45, 0.0, false,
                "Teledyne DALSA, Genie Nano manual, M1450"},
    NamedCamera{"pi-gs", "Raspberry Pi Global Shutter camera (IMX296)", 1456, 1088, 3.45, 0.0, false,
                "Raspberry Pi documentation, camera hardware"},
    NamedCamera{"pi-hq", "Raspberry Pi High Quality camera (IMX477)", 4056, 3040, 1.55, 0.0, true,
                "Raspberry Pi documentation, camera hardware"},
    NamedCamera{"pi-3", "Raspberry Pi Camera Module 3 (IMX708)", 4608, 2592, 0.0, 66.0, true,
                "Raspberry Pi documentation, camera hardware"},
    NamedCamera{"pi-2", "Raspberry Pi Camera Module 2 (IMX219)", 3280, 2464, 0.0, 62.2, true,
                "Raspberry Pi documentation, camera hardware"},
    // 26 mm equivalent (by the diagonal of 4:3) is 67 deg; stabilised video uses about nine tenths of the width.
    NamedCamera{"phone-4k", "phone, main camera of 26 mm equivalent, video 2160p", 3840, 2160, 0.0, 62.0, true,
                "computed from the makers' equivalent focal length", true},
    NamedCamera{"phone-1080p", "phone, main camera of 26 mm equivalent, video 1080p", 1920, 1080, 0.0, 62.0, true,
                "computed from the makers' equivalent focal length", true},
};

}  // namespace

std::optional<NamedCamera> camera_named(const std::string& name) {
  for (const NamedCamera& camera : kCameras) {
    if (camera.name == name) return camera;
  }
  return std::nullopt;
}

std::string camera_names() {
  std::string names;
  for (const NamedCamera& camera : kCameras) names += (names.empty() ? "" : ", ") + std::string(camera.name);
  return names;
}

}  // namespace moiregauge::internal

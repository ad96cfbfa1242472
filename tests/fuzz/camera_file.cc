// SPDX-License-Identifier: Apache-2.0
// Input: any text as a camera file, in our TOML or in OpenCV's or ROS's YAML.
// Requires: finite values; an accepted camera can be written and read again.
#include "moiregauge/io/config/camera_file.h"

#include <cmath>

#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const auto known = parse_known_camera(fuzz::text_of({data, size}), "f");
  if (!known) {
    fuzz::demand(known.error().starts_with("f:"));
    return 0;
  }
  const Camera& camera = known->camera;
  for (const double value :
       {camera.fx, camera.fy, camera.cx, camera.cy, camera.k1, camera.k2, camera.p1, camera.p2, camera.k3})
    fuzz::demand(std::isfinite(value));
  fuzz::demand(camera.fx > 0.0 && camera.fy > 0.0 && camera.width >= 0 && camera.height >= 0);
  const auto again = parse_known_camera(write_camera(camera, known->u.value_or(CameraWidths{})), "f");
  fuzz::demand(again.has_value() && again->camera.fx == camera.fx && again->camera.k3 == camera.k3);
  return 0;
}

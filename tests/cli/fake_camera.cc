// SPDX-License-Identifier: Apache-2.0
// A GigE Vision camera on the loopback interface (Aravis's fake camera) that shows a rendered recording.
//
//     fake_camera SERIAL IMAGES LOST_SHARE
//
// Shows IMAGES frames of the small rig over and over: the even ones forwards, the odd ones backwards. So nothing jumps,
// and no two images in a row are the same, even if one between them is lost. Noise is independent for kPeriods periods.
// With the same noise in every period, a chance likeness of two images would count each time, and could look like an
// average over time. Its client sets rate and region. The image is in the top-left corner of the region. LOST_SHARE of
// the packets are lost. Prints `truth INDEX DX_MM DY_MM` for every image in this order, relative to the first, then
// `ready`. Runs until its standard input ends, then prints `sent FRAMES`.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <arv.h>

#include "moiregauge/simulator/simulator.h"

namespace {

using moiregauge::internal::Image;
namespace simulator = moiregauge::internal::simulator;

constexpr int kPeriods = 6;

struct Footage {
  std::vector<Image<std::uint8_t>> images;  // all periods
  std::atomic<std::size_t> sent = 0;
};

void fill(ArvBuffer* buffer, void* data, guint32 /*exposure_us*/, guint32 /*gain*/, ArvPixelFormat /*format*/) {
  auto& footage = *static_cast<Footage*>(data);
  int x = 0, y = 0, width = 0, height = 0;
  arv_buffer_get_image_region(buffer, &x, &y, &width, &height);
  std::size_t bytes = 0;  // Aravis states 0 here
  auto* out = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &bytes)));
  const auto& image = footage.images[footage.sent++ % footage.images.size()];
  for (int row = 0; row < height; ++row, out += width) {
    const int shown = row < image.height() ? std::min(width, image.width()) : 0;
    if (shown > 0) std::memcpy(out, image.row(row).data(), static_cast<std::size_t>(shown));
    std::memset(out + shown, 128, static_cast<std::size_t>(width - shown));
  }
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) {
    std::fputs("usage: fake_camera SERIAL IMAGES LOST_SHARE\n", stderr);
    return 2;
  }
  Footage footage;
  auto scenario = simulator::built_in("small-1x");
  if (!scenario) return 1;
  const auto target = std::find_if(scenario->markers.begin(), scenario->markers.end(), [](const auto& marker) {
    return marker.print.role == moiregauge::internal::Role::kTarget;
  });
  const int images = std::max(2, std::atoi(words[2]));
  const auto frame_of = [images](int i) { return long{std::min(2 * i, 2 * (images - i) - 1)}; };
  for (int period = 0; period < kPeriods; ++period, ++scenario->seed) {
    for (int i = 0; i < images; ++i)
      footage.images.push_back(simulator::render8(*scenario, frame_of(i), {0, simulator::Area::kMarkersOnly}));
  }
  for (int i = 0; i < images; ++i) {
    const auto truth = simulator::truth(*scenario, frame_of(i), *target);
    std::printf("truth %d %.9f %.9f\n", i, truth.dx_mm, truth.dy_mm);
  }
  ArvGvFakeCamera* camera = arv_gv_fake_camera_new("127.0.0.1", words[1]);
  g_object_set(camera, "gvsp-lost-ratio", std::strtod(words[3], nullptr), nullptr);
  arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera), fill, &footage);
  std::puts(arv_gv_fake_camera_is_running(camera) != 0 ? "ready" : "failed");
  std::fflush(stdout);
  while (std::getchar() != EOF) {
  }
  std::printf("sent %zu\n", footage.sent.load());
  g_object_unref(camera);
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Follows a camera frame by frame in constant memory: follow_camera FRAMES. The camera is a simulated one here. Its
// frames repeat after a while, so that many need little time.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <moiregauge/moiregauge.h>

namespace {

constexpr long kRendered = 40;

long peak_memory_kb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

}  // namespace

int main(int argc, char** argv) {
  const long frames = argc > 1 ? std::atol(argv[1]) : 1000;
  auto camera = moiregauge::Simulation::load("small-1xyz", {.frames = kRendered, .markers_only = true});
  if (!camera) return std::fprintf(stderr, "error: %s\n", camera.error().message.c_str()), 1;
  std::vector<std::vector<std::uint8_t>> images;
  int width = 0, height = 0;
  for (long n = 0; n < kRendered; ++n) {
    const auto view = camera->render(n);
    width = view.width, height = view.height;
    const auto* pixels = static_cast<const std::uint8_t*>(view.data);
    images.emplace_back(pixels, pixels + static_cast<std::ptrdiff_t>(width) * height);
  }
  auto tracker = moiregauge::Tracker::create({.site = camera->site()});
  if (!tracker) return std::fprintf(stderr, "error: %s\n", tracker.error().message.c_str()), 1;
  long ok = 0, wrong = 0, early_kb = 0;
  for (long n = 0; n < frames; ++n) {
    const long shown = n % kRendered;
    const auto frame =
        tracker->update({images[static_cast<std::size_t>(shown)].data(), width, height}, 0.1 * static_cast<double>(n));
    if (!frame) return std::fprintf(stderr, "error: %s\n", frame.error().message.c_str()), 1;
    if (n == frames / 10) early_kb = peak_memory_kb();
    for (const auto& sample : frame->samples) {
      if (sample.status != moiregauge::Status::kOk) continue;
      ++ok;
      const double error = sample.dy_mm - camera->truth(shown, "mid")->dy_mm;
      wrong += std::abs(error) > 5.0 * sample.u_dy_mm && n > 0 && std::abs(error) > 5e-4 ? 1 : 0;
    }
  }
  std::printf(
      "%ld frames, %ld ok, %ld of them off by more than 5 u; peak memory %ld kB after a tenth, %ld kB at the end\n",
      frames, ok, wrong, early_kb, peak_memory_kb());
  return wrong == 0 && ok > frames / 2 ? 0 : 1;
}

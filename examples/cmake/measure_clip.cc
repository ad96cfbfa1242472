// SPDX-License-Identifier: Apache-2.0
// Measures a clip in three lines: measure_clip CLIP prints the vertical displacement of every target.
#include <cstdio>

#include <moiregauge/moiregauge.h>

int main(int argc, char** argv) {
  using namespace moiregauge::literals;
  if (argc != 2) return std::fprintf(stderr, "usage: measure_clip CLIP (gratings of 10 mm pitch)\n"), 2;

  const auto run = moiregauge::measure(argv[1], {.pitch = 10_mm});
  if (!run) return std::fprintf(stderr, "error: %s\n", run.error().message.c_str()), 1;
  for (const auto& target : run->targets)
    for (const auto& s : target.samples)
      std::printf("%s, frame %ld: dy = %+.4f mm, u = %.4f mm, %s\n", target.name.c_str(), s.frame, s.dy_mm, s.u_dy_mm,
                  moiregauge::to_string(s.status));
  return run->exit_code;
}

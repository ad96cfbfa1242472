// SPDX-License-Identifier: Apache-2.0
// A whole measurement from a program of one's own: measure_clip INPUT PITCH_MM prints the vertical displacement of
// every target in every frame, with its standard uncertainty.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <moiregauge/decoder/video_source.h>
#include <moiregauge/io/pictures/picture_source.h>
#include <moiregauge/run/measure.h>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "error: usage: measure_clip INPUT PITCH_MM: name a video or a folder of pictures\n");
    return 2;
  }
  moiregauge::MeasureOptions options;
  options.method = moiregauge::method_named("precise");
  options.pitch_mm = std::atof(argv[2]);
  const auto open = [&] {
    const moiregauge::InputOptions how{.fps = 10.0};
    return std::filesystem::is_directory(argv[1]) ? moiregauge::open_pictures(argv[1], how)
                                                  : moiregauge::open_video(argv[1], how);
  };
  const auto measured = moiregauge::measure(open, options, [](long, long) { return true; });
  if (!measured) {
    std::fprintf(stderr, "error: %s\n", measured.error().message.c_str());
    return 3;
  }
  for (const moiregauge::Sample& sample : measured->samples)
    std::printf("frame %ld: dy = %+.4f mm, u = %.4f mm, %s\n", sample.frame, sample.displacement.y, sample.u.y,
                moiregauge::word_for(sample.status));
  return static_cast<int>(measured->exit);
}

// SPDX-License-Identifier: Apache-2.0
// Where a simulated recording goes: a folder of pictures or a video.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/encoder/video_writer.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::cli {

struct PicturesPlan {
  std::optional<VideoFormat> video;  // nothing: DIR/frames/%06d.png
  simulator::Area area = simulator::Area::kWholeFrame;
  int threads = 0;
  bool quiet = false;
};

// Draws every frame into the folder. An error reads "path: why". Bytes do not depend on the number of threads.
[[nodiscard]] tl::expected<void, std::string> write_pictures(const simulator::Scenario& scenario,
                                                             const PicturesPlan& plan, const std::string& folder);

}  // namespace moiregauge::internal::cli

// SPDX-License-Identifier: Apache-2.0
// Writes a simulated recording to an image folder or a video.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/encoder/video_writer.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::cli {

struct PicturesPlan {
  std::optional<VideoFormat> video;  // none: DIR/frames/%06d.png
  simulator::Area area = simulator::Area::kWholeFrame;
  int threads = 0;
  bool quiet = false;
};

// Draws every frame into the folder. Fails with the path and the reason. Files do not depend on the number of threads.
[[nodiscard]] tl::expected<void, std::string> write_pictures(const simulator::Scenario& scenario,
                                                             const PicturesPlan& plan, const std::string& folder);

}  // namespace moiregauge::internal::cli

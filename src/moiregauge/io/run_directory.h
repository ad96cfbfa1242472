// SPDX-License-Identifier: Apache-2.0
// DIR of a run: displacement.csv, run.json, run.mgj, overlay.png, of a solved scene camera.toml and site.toml; written
// beside it under another name and renamed as a whole.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "moiregauge/run/result_sink.h"

namespace moiregauge {

// Draws overlay.png; handed in, because drawing stands beside io.
using DrawOverlay = std::function<std::vector<std::uint8_t>(const Measurement&)>;

class RunDirectory : public ResultSink {
 public:
  RunDirectory(std::string path, DrawOverlay draw_overlay)
      : path_(std::move(path)), draw_overlay_(std::move(draw_overlay)) {}
  // For new results of what was measured into another folder, or the same: its run.mgj and overlay.png are kept.
  [[nodiscard]] static RunDirectory solved_from(std::string path, std::string measured) {
    RunDirectory directory(std::move(path), {});
    directory.solved_from_ = std::move(measured);
    return directory;
  }

  // May this place be written? An existing run is replaced only if it came from the same input; anything else that is not
  // an empty folder is left alone. Asked before measuring, so that hours are not lost.
  // The input's fingerprint takes a pass over all its bytes: it is asked for only where a run stands already.
  [[nodiscard]] tl::expected<void, OutputError> check(const std::function<std::string()>& input_sha256) const;
  [[nodiscard]] tl::expected<void, OutputError> write(const Measurement& measurement, const MeasureOptions& options) override;

 private:
  std::string path_;
  DrawOverlay draw_overlay_;
  std::string solved_from_;  // empty: just measured
};

}  // namespace moiregauge

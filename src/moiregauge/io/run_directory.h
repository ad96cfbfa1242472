// SPDX-License-Identifier: Apache-2.0
// DIR of a run: displacement.csv, run.json, overlay.png; written beside it under another name and renamed as a whole.
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
  RunDirectory(std::string path, DrawOverlay draw_overlay) : path_(std::move(path)), draw_overlay_(std::move(draw_overlay)) {}

  // May this place be written? An existing run is replaced only if it came from the same input; anything else that is not
  // an empty folder is left alone. Asked before measuring, so that hours are not lost.
  [[nodiscard]] tl::expected<void, OutputError> check(const std::string& input_sha256) const;
  [[nodiscard]] tl::expected<void, OutputError> write(const Measurement& measurement, const MeasureOptions& options) override;

 private:
  std::string path_;
  DrawOverlay draw_overlay_;
};

}  // namespace moiregauge

// SPDX-License-Identifier: Apache-2.0
// Writes the folder of --stabilised: every marker of every measured frame, as seen by a camera that never moved
// (docs/file-formats.md). It is written under a temporary name and renamed as a whole.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/observation/views/marker_crop.h"
#include "moiregauge/run/frame_sink.h"
#include "moiregauge/run/result_sink.h"

namespace moiregauge::internal {

class StabilisedFolder : public FrameSink {
 public:
  explicit StabilisedFolder(const std::string& path);
  ~StabilisedFolder() override;  // removes an unfinished folder
  StabilisedFolder(const StabilisedFolder&) = delete;
  StabilisedFolder& operator=(const StabilisedFolder&) = delete;

  // Creates the temporary folder. Call it before the run. Fails if the path is in use (usage) or cannot be written.
  [[nodiscard]] tl::expected<void, OutputError> open();
  void add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) override;
  // Publishes the folder. Without any crop there is no folder.
  [[nodiscard]] tl::expected<void, OutputError> finish();

 private:
  struct Place {
    std::string folder;  // derived from the marker's name
    CropPlan plan;
  };
  void plan_crops(const Reference& reference);
  void write_crops(const Frame& frame, int bits, const View& view);
  void keep_failure(const std::string& why);

  std::string path_, partial_;
  std::vector<Place> places_;  // one per marker of the site
  std::optional<Site> site_;
  std::string rows_;
  long crops_ = 0;
  std::optional<OutputError> failure_;
};

// Returns true if one path is the other or is inside it. Then neither can be replaced as a whole.
[[nodiscard]] bool overlaps(const std::string& a, const std::string& b);

}  // namespace moiregauge::internal

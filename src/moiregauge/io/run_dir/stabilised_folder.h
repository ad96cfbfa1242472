// SPDX-License-Identifier: Apache-2.0
// DIR of --stabilised: every marker of every measured frame as a camera that never moved would see it
// (docs/file-formats.md). Written beside its place under another name and renamed as a whole.
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
  explicit StabilisedFolder(std::string path);
  ~StabilisedFolder() override;  // what was not finished is taken away
  StabilisedFolder(const StabilisedFolder&) = delete;
  StabilisedFolder& operator=(const StabilisedFolder&) = delete;

  // Before any work: fails when the place is taken (usage) or nothing can be written there.
  [[nodiscard]] tl::expected<void, OutputError> open();
  void add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) override;
  // Puts the folder in its place. Without a single crop there is none.
  [[nodiscard]] tl::expected<void, OutputError> finish();

 private:
  struct Place {
    std::string folder;  // named after the marker
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

// Is one of two paths the other, or inside it? Then neither can be replaced as a whole.
[[nodiscard]] bool overlaps(const std::string& a, const std::string& b);

}  // namespace moiregauge::internal

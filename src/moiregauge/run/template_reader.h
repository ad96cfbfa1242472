// SPDX-License-Identifier: Apache-2.0
// Fits templates in the frames of a method that reads none. The test for an average over time needs them.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/observation/frame/observe.h"

namespace moiregauge::internal {

class TemplateReader {
 public:
  // Learns the templates from the image of the reference frame.
  void refer(const GreyPicture& picture, const Reference& reference);
  [[nodiscard]] bool is_ready() const { return reference_.has_value(); }
  // Adds fitted templates to a frame that another method read. Returns the reference with templates; nullptr: without
  // templates, or no marker moved within the last frames, so that nothing was fitted.
  [[nodiscard]] const Reference* fit(const GreyPicture& picture, Observation& seen);

 private:
  [[nodiscard]] bool moves(const Observation& seen);

  std::optional<Reference> reference_;
  std::vector<std::vector<ImagePoint>> last_;  // px, centres of the markers in up to three frames, newest first
};

}  // namespace moiregauge::internal

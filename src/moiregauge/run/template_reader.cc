// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/template_reader.h"

#include <algorithm>
#include <limits>

#include "moiregauge/observation/frame/follow_marker.h"

namespace moiregauge::internal {
namespace {

constexpr double kMoved_px = 0.03;     // less hides no visible share of the previous frame. Chosen.
constexpr std::size_t kLagFrames = 3;  // longest lag of the tests

// Returns the centre of each marker's grating in the image, px; NaN if it was not read.
std::vector<ImagePoint> centres_of(const Reference& reference, const Observation& seen) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<ImagePoint> centres(seen.markers.size(), ImagePoint{nan, nan});
  if (!seen.references_seen) return centres;
  const View view{seen.stage2, reference.lens};
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const MarkerObservation& now = seen.markers[i];
    const auto& grating = reference.site.markers[i].grating;
    if (!grating || now.loss != Loss::kNone) continue;
    const auto moved =
        displacement_at(reference.plans[i], reference.seen.markers[i].patch, now.patch, now.window_shift);
    centres[i] = view(grating->centre + known_part(moved));
  }
  return centres;
}

}  // namespace

void TemplateReader::refer(const GreyPicture& picture, const Reference& reference) {
  reference_ = reference;
  learn_prints(picture, *reference_);
  last_.clear();
}

bool TemplateReader::moves(const Observation& seen) {
  std::vector<ImagePoint> now = centres_of(*reference_, seen);
  const bool moved = std::any_of(last_.begin(), last_.end(), [&](const std::vector<ImagePoint>& then) {
    for (std::size_t i = 0; i < now.size(); ++i)
      if (length(now[i] - then[i]) > kMoved_px) return true;
    return false;
  });
  last_.insert(last_.begin(), std::move(now));
  if (last_.size() > kLagFrames) last_.pop_back();
  return moved;
}

const Reference* TemplateReader::fit(const GreyPicture& picture, Observation& seen) {
  if (!reference_ || !moves(seen) || !seen.references_seen) return nullptr;
  fit_templates(picture, *reference_, seen);
  return &*reference_;
}

}  // namespace moiregauge::internal

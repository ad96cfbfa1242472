// SPDX-License-Identifier: Apache-2.0
// Cases of the reference implementations: one pass over the frame, and the textbook chain.
#include <limits>
#include <stdexcept>

#include "cases.h"
#include "floor_pass.h"
#include "textbook_chain.h"

namespace moiregauge::internal::bench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

cv::Mat as_mat(const ImageView<std::uint8_t>& picture) {
  return {picture.height, picture.width, CV_8U, const_cast<std::uint8_t*>(picture.data),
          static_cast<std::size_t>(picture.stride)};
}

// Returns windows 4 px inside the gratings, as a user would draw them.
TextbookSite textbook_site(const Reference& reference) {
  constexpr int kInside = 4;
  TextbookSite site;
  const auto window = [&](const Marker& marker) {
    const auto centre = reference.view(marker.grating->centre);
    const double mm_per_px = reference.view.mm_per_px(marker.grating->centre);
    const int width = static_cast<int>(marker.grating->width_mm / mm_per_px) - 2 * kInside;
    const int height = static_cast<int>(marker.grating->height_mm / mm_per_px) - 2 * kInside;
    return cv::Rect(static_cast<int>(centre.x) - width / 2, static_cast<int>(centre.y) - height / 2, width, height);
  };
  std::size_t references = 0;
  for (const Marker& marker : reference.site.markers) {  // order of the rig: NW, NE, SW, SE, target
    if (marker.role == Role::kReference) {
      site.references.at(references++) = window(marker);
      continue;
    }
    site.target = window(marker);
    site.mm_per_px = reference.view.mm_per_px(marker.grating->centre);
    site.pitch_px = marker.grating->pitch_mm / site.mm_per_px;
  }
  site.disc_px = reference.seen.markers[reference.circles.front().marker].circle->diameter_px;
  return site;
}

std::shared_ptr<Work> floor_work(const Recording& recording) {
  auto work = std::make_shared<Work>();
  work->bytes = recording.frame_bytes();
  work->frame = [](const Shot& shot) {
    const auto& p = shot.picture;
    benchmark::DoNotOptimize(
        floor_pass({p.data, static_cast<std::size_t>(p.stride) * static_cast<std::size_t>(p.height)}));
    return true;
  };
  return work;
}

std::shared_ptr<Work> textbook_work(const Recording& recording) {
  const auto made =
      TextbookChain::make(as_mat(recording.reference_frame().view()), textbook_site(recording.reference()));
  if (!made) throw std::runtime_error("the textbook chain does not find its circles");
  const auto chain = std::make_shared<TextbookChain>(*made);
  std::size_t target = 0;
  while (recording.reference().site.markers[target].role != Role::kTarget) ++target;
  auto work = std::make_shared<Work>();
  work->bytes = recording.frame_bytes();
  work->error_unit = "mm";
  work->frame = [chain](const Shot& shot) { return chain->displacement_mm(as_mat(shot.picture)).has_value(); };
  work->error = [chain, target, &recording](const Shot& shot) {
    const auto d = chain->displacement_mm(as_mat(shot.picture));
    return recording.error(target, {d ? d->x : kNone, d ? d->y : kNone}, shot.frame);
  };
  return work;
}

std::shared_ptr<Work> textbook_detection_work(const Recording& recording) {
  const double disc_px = textbook_site(recording.reference()).disc_px;
  return detection_of(recording, [disc_px](const Shot& shot) -> std::optional<std::vector<ImagePoint>> {
    const auto seen = textbook_circles(as_mat(shot.picture), disc_px);
    if (!seen) return std::nullopt;
    std::vector<ImagePoint> found;
    for (const cv::Point2d p : *seen) found.push_back({p.x, p.y});
    return found;
  });
}

}  // namespace

void add_yardstick_cases() {
  using enum Memory;
  add_cases("floor", {kHot, kRing}, floor_work);
  add_cases("textbook", {kHot, kRing}, textbook_work);
  add_cases("textbook detection", {kRing}, textbook_detection_work);
}

}  // namespace moiregauge::internal::bench

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/views/marker_crop.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/image/spline.h"

namespace moiregauge::internal {
namespace {

constexpr double kReferenceMargin = 0.1;  // relative to the marker's longer side
constexpr double kTargetMargin = 0.5;
// Largest side of a crop, in sides of the image. It limits the memory for wrong sites. Chosen.
constexpr double kLargest = 2.0;

struct BoardBox {
  double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
  void add(BoardPoint centre, double half_x, double half_y) {
    x0 = std::min(x0, centre.x - half_x);
    x1 = std::max(x1, centre.x + half_x);
    y0 = std::min(y0, centre.y - half_y);
    y1 = std::max(y1, centre.y + half_y);
  }
};

BoardBox board_box_of(const Reference& reference, std::size_t i) {
  const Marker& marker = reference.site.markers[i];
  BoardBox box;
  if (marker.circle) {
    double half = 0.5 * marker.circle->diameter_mm;
    if (const auto& seen = reference.seen.markers[i].circle; half <= 0.0 && seen)
      half = 0.5 * seen->diameter_px * reference.view.mm_per_px(marker.circle->centre);
    box.add(marker.circle->centre, half, half);
  }
  if (marker.grating) {
    const Grating& g = *marker.grating;
    const double c = std::abs(std::cos(g.angle_rad)), s = std::abs(std::sin(g.angle_rad));
    box.add(g.centre, 0.5 * (c * g.width_mm + s * g.height_mm), 0.5 * (s * g.width_mm + c * g.height_mm));
  }
  return box;
}

ImagePoint seen_at(const View& view, const CropPlan& plan, int column, int row) {
  return view(BoardPoint{plan.first.x + column * plan.mm_per_px, plan.first.y - row * plan.mm_per_px});
}

struct CropBox {
  int x0 = 0, y0 = 0, width = 0, height = 0;
};

// Returns the part of the image under the crop, which the crop's border determines.
CropBox part_under(const View& view, const CropPlan& plan, int width, int height) {
  double x0 = width, x1 = 0.0, y0 = height, y1 = 0.0;
  const auto add = [&](int column, int row) {
    const ImagePoint p = seen_at(view, plan, column, row);
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  };
  for (int column = 0; column < plan.width; ++column) {
    add(column, 0);
    add(column, plan.height - 1);
  }
  for (int row = 0; row < plan.height; ++row) {
    add(0, row);
    add(plan.width - 1, row);
  }
  const int left = static_cast<int>(std::max(0.0, x0 - kSplineRim)),
            top = static_cast<int>(std::max(0.0, y0 - kSplineRim));
  const int right = static_cast<int>(std::min<double>(width, x1 + kSplineRim)),
            bottom = static_cast<int>(std::min<double>(height, y1 + kSplineRim));
  return {left, top, right - left, bottom - top};
}

template <typename Grey>
Crop cut_out_of(const ImageView<Grey>& picture, int bits, const View& view, const CropPlan& plan) {
  Crop crop{Image<std::uint8_t>(plan.width, plan.height), 0.0};
  const CropBox part = part_under(view, plan, picture.width, picture.height);
  if (part.width < 4 || part.height < 4) return crop;
  Spline spline;
  spline.fit(picture, part.x0, part.y0, part.width, part.height);
  const double per_grey = 255.0 / ((1 << bits) - 1);
  long inside = 0;
  for (int row = 0; row < plan.height; ++row) {
    const auto out = crop.grey.row(row);
    for (int column = 0; column < plan.width; ++column) {
      const ImagePoint p = seen_at(view, plan, column, row);
      double grey = 0.0;
      if (!spline.at(p.x, p.y, grey)) continue;
      out[static_cast<std::size_t>(column)] = static_cast<std::uint8_t>(std::clamp(per_grey * grey + 0.5, 0.0, 255.0));
      ++inside;
    }
  }
  crop.inside = static_cast<double>(inside) / (static_cast<double>(plan.width) * plan.height);
  return crop;
}

}  // namespace

CropPlan plan_crop(const Reference& reference, std::size_t i) {
  const BoardBox box = board_box_of(reference, i);
  const BoardPoint centre{0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)};
  const double share = reference.site.markers[i].role == Role::kTarget ? kTargetMargin : kReferenceMargin;
  const double margin = share * std::max(box.x1 - box.x0, box.y1 - box.y0);
  CropPlan plan;
  plan.mm_per_px = reference.view.finest_mm_per_px(centre);
  const double largest = kLargest * std::max(reference.width, reference.height);
  const auto pixels = [&](double mm) {  // odd, so that the marker's centre is that of a pixel
    return 2 * static_cast<int>(std::min(0.5 * mm / plan.mm_per_px, 0.5 * largest)) + 1;
  };
  plan.width = pixels(box.x1 - box.x0 + 2.0 * margin);
  plan.height = pixels(box.y1 - box.y0 + 2.0 * margin);
  plan.first = {centre.x - 0.5 * (plan.width - 1) * plan.mm_per_px,
                centre.y + 0.5 * (plan.height - 1) * plan.mm_per_px};
  return plan;
}

Crop cut_out(const GreyPicture& picture, const View& view, const CropPlan& plan) {
  return std::visit([&](const auto& luma) { return cut_out_of(luma, picture.bits, view, plan); }, picture.luma);
}

}  // namespace moiregauge::internal

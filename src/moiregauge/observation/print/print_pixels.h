// SPDX-License-Identifier: Apache-2.0
// Gathers the pixels of a grating's window, from which a template is learned.
#pragma once

#include <algorithm>
#include <cmath>

#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/phase/fit/print_bins.h"

namespace moiregauge::internal {

// Adds the grey levels of the window's pixels to the bins. An earlier fit (`light`, may be null) corrects them for light
// and contrast.
template <typename Grey>
void gather_grey(const ImageView<Grey>& picture, const PrintFromImage& map, const PatchWindow& w, const PatchFit* light,
                 PrintBins& bins) {
  const PixelBox box = box_round(map.inverse(), w);
  const int first_x = std::max(0, box.x0), last_x = std::min(picture.width - 1, box.x1);
  const int first_y = std::max(0, box.y0), last_y = std::min(picture.height - 1, box.y1);
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) {
      const ImagePoint at{double(x), double(y)};
      const PrintPoint p = map(at);
      if (!(std::abs(p.x - w.centre.x) <= w.half_x && std::abs(p.y - w.centre.y) <= w.half_y)) continue;
      double grey = picture.at(x, y);
      if (light != nullptr) {
        const auto [background, contrast] = light->light_and_contrast(at);
        grey = (grey - background) / contrast;
      }
      bins.add(p, grey);
    }
  }
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/overlays/scale_bar.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr double kPartOfWidth = 0.2;  // longest bar, share of the image width
constexpr double kMargin = 10.0;      // units from the image's edges
constexpr double kBarWidth = 4.0, kEndHeight = 6.0;

}  // namespace

double round_length(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  return power * (length >= 5.0 * power ? 5.0 : length >= 2.0 * power ? 2.0 : 1.0);
}

void draw_scale_bar(overlay::Pen& pen, const Reference& reference, double unit_mm, const char* unit,
                    const overlay::Box& picture) {
  const ScaleCheck check = scale_check(reference);
  const double units_per_page_px = check.mm_per_px / unit_mm / (pen.page_x(1.0) - pen.page_x(0.0));
  if (!(units_per_page_px > 0.0) || !std::isfinite(units_per_page_px)) return;
  const double length = round_length(kPartOfWidth * picture.width * units_per_page_px);
  const double bar = length / units_per_page_px;
  const std::string words = fmt::format("{:g} {} ({})", length, unit, tape_text(check, reference.site, unit_mm, unit));
  const double margin = kMargin * pen.unit(), line = pen.line_height();
  const double width = std::max(bar, pen.text_width(words)) + 2.0 * margin, height = 1.3 * line + 2.0 * margin;
  const double right = picture.x + picture.width - width, bottom = picture.y + picture.height - height;
  const std::array<overlay::Box, 4> corners{{{right, bottom, width, height},
                                             {picture.x, bottom, width, height},
                                             {right, picture.y, width, height},
                                             {picture.x, picture.y, width, height}}};
  const auto& box = *std::min_element(corners.begin(), corners.end(),
                                      [&](const auto& a, const auto& b) { return pen.covered(a) < pen.covered(b); });
  const bool is_right = box.x > picture.x;
  const double from = is_right ? box.x + width - margin - bar : box.x + margin;
  const double foot = box.y + height - margin;
  pen.colour(overlay::kWhite);
  pen.bar(from, from + bar, foot, kBarWidth, kEndHeight);
  pen.label(is_right ? from + bar - pen.text_width(words) : from, foot - 0.7 * line, words, picture);
  pen.keep_free(box);
}

}  // namespace moiregauge::internal

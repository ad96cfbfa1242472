// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/surface/picture_box.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal::figure {
namespace {

constexpr double kFinestPixels = 4.2;  // per point, 300 per inch; more would only enlarge the files
constexpr std::uint8_t kPaper = 255;

// Returns the means of n x n pixels.
Image<std::uint8_t> reduced(GreyView picture, int n) {
  Image<std::uint8_t> out(picture.width / n, picture.height / n);
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      int sum = n * n / 2;
      for (int v = 0; v < n; ++v) {
        for (int u = 0; u < n; ++u) sum += picture.at(n * x + u, n * y + v);
      }
      out.at(x, y) = static_cast<std::uint8_t>(sum / (n * n));
    }
  }
  return out;
}

std::uint8_t linear(GreyView picture, IdealPoint p) {
  const double x0 = std::floor(p.x), y0 = std::floor(p.y);
  if (!(x0 >= 0.0 && y0 >= 0.0 && x0 + 1.0 < picture.width && y0 + 1.0 < picture.height)) return kPaper;
  const int x = static_cast<int>(x0), y = static_cast<int>(y0);
  const double u = p.x - x0, v = p.y - y0;
  const double above = (1 - u) * picture.at(x, y) + u * picture.at(x + 1, y);
  const double below = (1 - u) * picture.at(x, y + 1) + u * picture.at(x + 1, y + 1);
  return static_cast<std::uint8_t>(std::lround((1 - v) * above + v * below));
}

// Returns the part, shortened and shifted to be inside the image.
Part kept_inside(GreyView picture, Part part) {
  part.width = std::min(part.width, picture.width);
  part.height = std::min(part.height, picture.height);
  part.x = std::clamp(part.x, 0, picture.width - part.width);
  part.y = std::clamp(part.y, 0, picture.height - part.height);
  return part;
}

}  // namespace

PictureBox::PictureBox(Canvas& canvas, GreyView picture, Part part, Spot corner, double width)
    : part_(kept_inside(picture, part)) {
  const int n = std::max(1, static_cast<int>(std::floor(part_.width / (kFinestPixels * width))));
  part_.width -= part_.width % n;
  part_.height -= part_.height % n;
  scale_ = width / part_.width;
  box_ = {corner.x, corner.y, width, scale_ * part_.height};
  canvas.picture(reduced(picture.part(part_.x, part_.y, part_.width, part_.height), n).view(), box_);
  canvas.frame(box_, {kBlack, 0.4});
}

Spot PictureBox::at(ImagePoint p) const {
  return {box_.x + scale_ * (p.x + 0.5 - part_.x), box_.y + scale_ * (p.y + 0.5 - part_.y)};
}

Part square_round(ImagePoint centre, int side) {
  return {static_cast<int>(std::lround(centre.x)) - side / 2, static_cast<int>(std::lround(centre.y)) - side / 2, side,
          side};
}

Image<std::uint8_t> stabilised(GreyView now, const IdealFromBoard& sees_now, const IdealFromBoard& sees_reference) {
  const auto now_from_reference = sees_now * sees_reference.inverse();
  Image<std::uint8_t> out(now.width, now.height);
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x)
      out.at(x, y) = linear(now, now_from_reference({static_cast<double>(x), static_cast<double>(y)}));
  }
  return out;
}

}  // namespace moiregauge::internal::figure

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/record/marker_windows.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace moiregauge::internal {
namespace {

// Added to the margin of crops (chosen): the camera's motion between two frames, and the neighbourhood that circle
// detection reads.
constexpr double kMargin_px = 24.0;
constexpr int kHalfRange8 = 128;

template <typename Grey>
void copy_out(const ImageView<Grey>& from, const PixelBox& box, std::vector<std::byte>& to) {
  const auto row_bytes = sizeof(Grey) * static_cast<std::size_t>(box.x1 - box.x0 + 1);
  for (int y = box.y0; y <= box.y1; ++y) {
    const auto* row = reinterpret_cast<const std::byte*>(from.row(y).data() + box.x0);
    to.insert(to.end(), row, row + row_bytes);
  }
}

// Returns the bytes after the window.
template <typename Grey>
const std::byte* copy_in(const std::byte* from, const PixelBox& box, Image<Grey>& to) {
  const auto row_bytes = sizeof(Grey) * static_cast<std::size_t>(box.x1 - box.x0 + 1);
  for (int y = box.y0; y <= box.y1; ++y, from += row_bytes) std::memcpy(to.row(y).data() + box.x0, from, row_bytes);
  return from;
}

template <typename Grey>
void clear(const PixelBox& box, Grey grey, Image<Grey>& image) {
  for (int y = box.y0; y <= box.y1; ++y) {
    const auto row = image.row(y);
    std::fill(row.begin() + box.x0, row.begin() + box.x1 + 1, grey);
  }
}

template <typename Grey>
LumaView show_on(Image<Grey>& image, Grey grey, const StoredFrame& stored, std::vector<PixelBox>& shown) {
  for (const PixelBox& box : shown) clear(box, grey, image);
  const std::byte* from = stored.pixels.data();
  for (const PixelBox& box : stored.windows) from = copy_in(from, box, image);
  shown = stored.windows;
  return image.view();
}

}  // namespace

MarkerWindows::MarkerWindows(const Reference& reference)
    : lens_(reference.lens), width_(reference.width), height_(reference.height) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    plans_.push_back(plan_crop(reference, i));
    last_.push_back(window(reference.view, i, {0.0, 0.0}));
  }
}

PixelBox MarkerWindows::window(const View& view, std::size_t marker, Extent<frame::Board> shift) const {
  const CropPlan& plan = plans_[marker];
  const double dx = std::isfinite(shift.x) ? shift.x : 0.0, dy = std::isfinite(shift.y) ? shift.y : 0.0;
  double x0 = width_, x1 = -1.0, y0 = height_, y1 = -1.0;
  for (const int corner : {0, 1, 2, 3}) {
    const double right = corner % 2 == 0 ? 0.0 : plan.mm_per_px * (plan.width - 1);
    const double down = corner / 2 == 0 ? 0.0 : plan.mm_per_px * (plan.height - 1);
    const ImagePoint p = view(BoardPoint{plan.first.x + dx + right, plan.first.y + dy - down});
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return {0, 0, width_ - 1, height_ - 1};
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
  const auto inside = [](double at, int size) { return static_cast<int>(std::clamp(at, 0.0, size - 1.0)); };
  return {inside(std::floor(x0 - kMargin_px), width_), inside(std::floor(y0 - kMargin_px), height_),
          inside(std::ceil(x1 + kMargin_px), width_), inside(std::ceil(y1 + kMargin_px), height_)};
}

const std::vector<PixelBox>& MarkerWindows::in(const Observation& seen) {
  if (!seen.references_seen) return last_;
  const View view{seen.stage2, lens_};
  for (std::size_t i = 0; i < last_.size(); ++i)
    last_[i] = window(view, i, i < seen.markers.size() ? seen.markers[i].window_shift : Extent<frame::Board>{0.0, 0.0});
  return last_;
}

StoredFrame store(const LumaView& luma, int bits, std::vector<PixelBox> windows) {
  StoredFrame stored;
  stored.bits = bits;
  stored.windows = std::move(windows);
  for (const PixelBox& box : stored.windows)
    std::visit([&](const auto& view) { copy_out(view, box, stored.pixels); }, luma);
  return stored;
}

PixelBox whole_frame(const LumaView& luma) { return {0, 0, width_of(luma) - 1, height_of(luma) - 1}; }

FrameCanvas::FrameCanvas(int width, int height, int bits) : bits_(bits) {
  if (bits == 8)
    bytes_ = Image<std::uint8_t>(width, height, kHalfRange8);
  else
    words_ = Image<std::uint16_t>(width, height, static_cast<std::uint16_t>(kHalfRange8 << (bits - 8)));
}

LumaView FrameCanvas::show(const StoredFrame& stored) {
  if (bits_ == 8) return show_on(bytes_, std::uint8_t{kHalfRange8}, stored, shown_);
  return show_on(words_, static_cast<std::uint16_t>(kHalfRange8 << (bits_ - 8)), stored, shown_);
}

}  // namespace moiregauge::internal

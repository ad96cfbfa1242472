// SPDX-License-Identifier: Apache-2.0
// The parts of a frame that a recording keeps: a window around every marker.
#pragma once

#include <cstddef>
#include <vector>

#include "moiregauge/observation/views/marker_crop.h"

namespace moiregauge::internal {

// Plans the windows of one reference frame.
class MarkerWindows {
 public:
  explicit MarkerWindows(const Reference& reference);
  // Returns the windows in a frame, inside the image. They contain each marker with a margin in which it can be found
  // again, also as a target moves. Without references the windows are those of the last frame that had them.
  [[nodiscard]] const std::vector<PixelBox>& in(const Observation& seen);

 private:
  [[nodiscard]] PixelBox window(const View& view, std::size_t marker, Extent<frame::Board> shift) const;

  std::vector<CropPlan> plans_;  // one per site marker
  Camera lens_;
  int width_ = 0;  // px
  int height_ = 0;
  std::vector<PixelBox> last_;
};

// Part of a frame, or a whole one.
struct StoredFrame {
  long number = 0;
  double time_s = 0.0;
  int bits = 8;
  std::vector<PixelBox> windows;
  std::vector<std::byte> pixels;  // rows of all windows one after the other, in words of the frame's depth
};

// Copies windows of a frame.
[[nodiscard]] StoredFrame store(const LumaView& luma, int bits, std::vector<PixelBox> windows);
// Returns the window that is the whole frame.
[[nodiscard]] PixelBox whole_frame(const LumaView& luma);

// Rebuilds frames from their windows, on a flat grey of half the range.
class FrameCanvas {
 public:
  FrameCanvas(int width, int height, int bits);
  // Returns the frame. It is valid until the next call.
  [[nodiscard]] LumaView show(const StoredFrame& stored);

 private:
  int bits_;
  Image<std::uint8_t> bytes_;  // one of them is empty
  Image<std::uint16_t> words_;
  std::vector<PixelBox> shown_;  // windows that are not grey
};

}  // namespace moiregauge::internal

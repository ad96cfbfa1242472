// SPDX-License-Identifier: Apache-2.0
// All frames of a run as the bundle takes them, made one at a time: with its information matrices a frame of five markers
// is 16 kB, and an hour has 100 000.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

// The part of a frame that is at hand for all of them.
struct FrameStart {
  long frame = 0;
  double time_s = kNotTimed;
  Pose pose;                                // where to start
  std::vector<Extent<frame::Board>> shift;  // of the targets, where to start; one per site marker, mm
  std::vector<bool> has_points;             // one per site marker
};

class FrameSeries {
 public:
  // Makes a frame with the start's pose, shift and points; always the same one.
  using Make = std::function<BundleFrame(std::size_t)>;

  FrameSeries() = default;
  FrameSeries(std::shared_ptr<const std::vector<FrameStart>> starts, Make make)
      : starts_(std::move(starts)), make_(std::move(make)) {}

  [[nodiscard]] std::size_t size() const { return starts_ ? starts_->size() : 0; }
  [[nodiscard]] std::span<const FrameStart> starts() const {
    return starts_ ? std::span<const FrameStart>(*starts_) : std::span<const FrameStart>();
  }
  [[nodiscard]] BundleFrame operator[](std::size_t k) const { return make_(k); }
  [[nodiscard]] BundleFrame front() const { return make_(0); }
  [[nodiscard]] std::vector<BundleFrame> at(std::span<const std::size_t> places) const {
    std::vector<BundleFrame> out;
    for (const std::size_t k : places) out.push_back(make_(k));
    return out;
  }

  // Returns other frames with the same starts.
  [[nodiscard]] FrameSeries with(Make make) const { return {starts_, std::move(make)}; }
  // Returns the same frames without that marker.
  [[nodiscard]] FrameSeries without_marker(std::size_t marker) const {
    auto starts = std::make_shared<std::vector<FrameStart>>(*starts_);
    for (FrameStart& start : *starts) start.has_points[marker] = false;
    return {std::move(starts), [make = make_, marker](std::size_t k) {
              BundleFrame frame = make(k);
              frame.points[marker].reset();
              return frame;
            }};
  }

 private:
  std::shared_ptr<const std::vector<FrameStart>> starts_;
  Make make_;
};

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// Inputs of the bundle adjustment from all frames of a run, made one at a time. A frame with five markers is 16 kB with
// its information matrices, and an hour has 100 000 frames.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

// Part of a frame that is kept in memory for all frames.
struct FrameStart {
  long frame = 0;
  double time_s = kNotTimed;
  Pose pose;                                // start value
  std::vector<Extent<frame::Board>> shift;  // start values for the targets, one per site marker, mm
  std::vector<bool> has_points;             // one per site marker
  // Targets whose image is blurred, clipped or partly covered, one per site marker or empty. They do not determine the
  // scene.
  std::vector<bool> is_flawed = {};
};

class FrameSeries {
 public:
  // Makes frame k with the start's pose, shift and points. It returns the same frame whenever it is called.
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

  // Returns frame k, or these frames, without flawed targets.
  [[nodiscard]] BundleFrame without_flawed_targets(std::size_t k) const {
    BundleFrame frame = make_(k);
    const std::vector<bool>& is_flawed = (*starts_)[k].is_flawed;
    for (std::size_t i = 0; i < is_flawed.size(); ++i) {
      if (is_flawed[i]) frame.points[i].reset();
    }
    return frame;
  }
  [[nodiscard]] std::vector<BundleFrame> without_flawed_targets(std::span<const std::size_t> places) const {
    std::vector<BundleFrame> out;
    for (const std::size_t k : places) out.push_back(without_flawed_targets(k));
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

// SPDX-License-Identifier: Apache-2.0
#include "recording.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <benchmark/benchmark.h>

namespace moiregauge::internal::bench {
namespace {

constexpr const char* kScenario = "rig-1xyz";
constexpr long kFrames = 24;              // 100 and 213 MB: more than most last-level caches
constexpr long kStep = 4;                 // frames of the scenario: 1.7 px of camera movement per step
constexpr double kBeyondCache = 1.5;      // size of the cold windows, relative to the last-level cache
constexpr double kMarginDiameters = 1.0;  // diameters: margin around the markers for the search for circles
constexpr double kCacheLine = 64.0;       // bytes

simulator::Scenario scenario_of(const Size& size) {
  auto scenario = *simulator::built_in(kScenario);
  scenario.camera.cx += 0.5 * (size.width - scenario.camera.width);
  scenario.camera.cy += 0.5 * (size.height - scenario.camera.height);
  scenario.camera.width = size.width;
  scenario.camera.height = size.height;
  return scenario;
}

struct MarkerRows {
  int begin = 0;
  int end = 0;
};

MarkerRows rows_of_markers(const simulator::Scenario& scenario, const std::vector<Shot>& shots, double margin_px) {
  double top = scenario.camera.height, bottom = 0.0;
  for (const Shot& shot : shots) {
    for (const auto& marker : scenario.markers) {
      const Grating& grating = *marker.print.grating;
      for (const double x : {-0.5, 0.5}) {
        for (const double y : {-0.5, 0.5}) {
          const Extent<frame::Board> corner{x * grating.width_mm, y * grating.height_mm};
          const double row = simulator::project(scenario, shot.frame, marker, grating.centre + corner).y;
          top = std::min(top, row - margin_px);
          bottom = std::max(bottom, row + margin_px);
        }
      }
    }
  }
  return {std::max(0, static_cast<int>(top)), std::min(scenario.camera.height, static_cast<int>(bottom) + 1)};
}

double diameter_px(const Reference& reference, const CirclePoint& circle) {
  return reference.seen.markers[circle.marker].circle->diameter_px;
}

}  // namespace

const char* word_for(Memory memory) {
  return memory == Memory::kHot ? "hot" : memory == Memory::kRing ? "ring" : "cold";
}

std::size_t last_level_cache_bytes() {
  std::size_t most = 0;
  for (const auto& cache : benchmark::CPUInfo::Get().caches)
    most = std::max(most, static_cast<std::size_t>(cache.size));
  return most;
}

const Recording& Recording::of(const Size& size) {
  static std::map<int, std::unique_ptr<Recording>> recordings;
  auto& recording = recordings[size.height];
  if (!recording) recording.reset(new Recording(size));
  return *recording;
}

Recording::Recording(const Size& size) : scenario_(scenario_of(size)) {
  for (long n = 0; n <= kFrames; ++n) frames_.push_back(render8(scenario_, n * kStep));
  auto reference = make_reference({frames_.front().view(), 8}, simulator::site_of(scenario_), Camera{}, {});
  if (!reference) throw std::runtime_error("the reference frame cannot be measured: " + reference.error().message);
  reference_ = std::move(*reference);
  for (long n = 1; n <= kFrames; ++n) ring_.push_back({frames_[static_cast<std::size_t>(n)].view(), n * kStep});
  for (long n = kFrames - 1; n > 1; --n) ring_.push_back({frames_[static_cast<std::size_t>(n)].view(), n * kStep});
  hot_.assign(1, ring_.front());
}

const std::vector<Shot>& Recording::shots(Memory memory) const {
  if (memory == Memory::kCold && cold_.empty()) cold_ = cold_copies();
  return memory == Memory::kHot ? hot_ : memory == Memory::kRing ? ring_ : cold_;
}

// Copies only the rows with markers. The other rows are never read and take no memory.
std::vector<Shot> Recording::cold_copies() const {
  const double share =
      kBeyondCache * static_cast<double>(last_level_cache_bytes()) / static_cast<double>(window_bytes());
  const auto rounds = static_cast<std::size_t>(std::ceil(share / static_cast<double>(ring_.size())));
  const MarkerRows rows =
      rows_of_markers(scenario_, ring_, kMarginDiameters * diameter_px(reference_, reference_.circles.front()));
  std::vector<Shot> shots;
  for (std::size_t n = 0; n < std::max<std::size_t>(rounds, 1) * ring_.size(); ++n) {
    const Shot& from = ring_[n % ring_.size()];
    copies_.emplace_back(new std::uint8_t[frame_bytes()]);  // not initialised: unused pages take no memory
    const ImageView<std::uint8_t> to{copies_.back().get(), from.picture.width, from.picture.height, from.picture.width};
    for (int y = rows.begin; y < rows.end; ++y) {
      const auto row = from.picture.row(y);
      std::copy(row.begin(), row.end(), copies_.back().get() + y * to.stride);
    }
    shots.push_back({to, from.frame});
  }
  return shots;
}

std::size_t Recording::window_bytes() const {
  double bytes = 0.0;
  const auto add = [&](double width_px, double height_px) { bytes += (width_px + kCacheLine) * height_px; };
  for (const CirclePoint& circle : reference_.circles)
    add(diameter_px(reference_, circle), diameter_px(reference_, circle));
  for (const Marker& marker : reference_.site.markers) {
    const double mm_per_px = reference_.view.mm_per_px(marker.grating->centre);
    add(marker.grating->width_mm / mm_per_px, marker.grating->height_mm / mm_per_px);
  }
  return static_cast<std::size_t>(bytes);
}

Error Recording::error(std::size_t marker, Extent<frame::Board> measured, long frame) const {
  const auto* who = simulator::find_marker(scenario_, reference_.site.markers[marker].name);
  const auto now = simulator::truth(scenario_, frame, *who);
  const auto then = simulator::truth(scenario_, 0, *who);
  return {measured.x - (now.dx_mm - then.dx_mm), measured.y - (now.dy_mm - then.dy_mm)};
}

Error Recording::circle_error(const std::vector<ImagePoint>& found, long frame) const {
  const CirclePoint& circle = reference_.circles.front();
  const auto* who = simulator::find_marker(scenario_, reference_.site.markers[circle.marker].name);
  const ImagePoint truth = simulator::project(scenario_, frame, *who, circle.board);
  const auto nearest = std::min_element(
      found.begin(), found.end(), [&](ImagePoint a, ImagePoint b) { return length(a - truth) < length(b - truth); });
  if (nearest == found.end()) return {std::nan(""), std::nan("")};
  return {nearest->x - truth.x, nearest->y - truth.y};
}

}  // namespace moiregauge::internal::bench

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "moiregauge/simulator/background.h"
#include "moiregauge/simulator/exposure.h"
#include "moiregauge/simulator/gaussian.h"
#include "moiregauge/simulator/lighting.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::simulator {
namespace {

// What turns light into stored numbers.
class Readout {
 public:
  Readout(const Scenario& scenario, long frame)
      : sigma_(scenario.sensor.noise_sigma),
        gain_(scenario.sensor.noise_gain),
        row_(scenario.sensor.row_noise),
        gamma_(scenario.sensor.gamma),
        scale_(std::ldexp(1.0, scenario.sensor.bits - 8)),
        highest_(std::ldexp(1.0, scenario.sensor.bits) - 1.0),
        noise_(scenario.seed, shot_of(scenario, frame)),
        row_noise_(scenario.seed + kRows, shot_of(scenario, frame)) {}
  // Of what pixel number `pixel`, in row y, received.
  [[nodiscard]] double stored(double grey, int y, std::uint64_t pixel) const {
    const double variance = sigma_ * sigma_ + gain_ * std::max(grey, 0.0);
    if (variance > 0.0) grey += std::sqrt(variance) * noise_.at(pixel);
    if (row_ != 0.0) grey += row_ * row_noise_.at(static_cast<std::uint64_t>(y));
    return stored(grey);
  }
  // Without noise.
  [[nodiscard]] double stored(double grey) const {
    if (gamma_ != 1.0) grey = 255.0 * std::pow(std::clamp(grey / 255.0, 0.0, 1.0), 1.0 / gamma_);
    return std::clamp(std::floor(grey * scale_ + 0.5), 0.0, highest_);
  }

 private:
  static constexpr std::uint64_t kRows = 7003;
  double sigma_, gain_, row_, gamma_, scale_, highest_;
  Noise noise_, row_noise_;
};

template <typename Grey>
class Rendering {
 public:
  Rendering(const Scenario& scenario, long frame, Area area)
      : scenario_(scenario),
        area_(area),
        lighting_(scenario, frame),
        readout_(scenario, frame),
        background_(scenario, frame) {
    for (const SceneMarker& decoy : background_.decoys()) markers_.emplace_back(scenario, decoy, frame);
    for (const SceneMarker& marker : scenario.markers) markers_.emplace_back(scenario, marker, frame);
    const long shot = shot_of(scenario, frame);
    for (const SceneMarker& marker : scenario.markers) {
      const auto& spans = marker.cover.frames;
      const auto holds = [&](FrameSpan span) { return shot >= span.from && shot < span.to; };
      if (std::any_of(spans.begin(), spans.end(), holds))
        markers_.push_back(ExposedMarker::cover_of(scenario, marker, frame));
    }
  }

  void fill(int y, std::span<Grey> out) const {
    std::vector<double> light(out.size(), scenario_.light.background);
    if (area_ == Area::kWholeFrame) {
      background_.fill(y, light);
      for (const ExposedMarker& marker : markers_) {
        if (marker.covers_row(y)) marker.lay_over(y, light);
      }
      return store(y, 0, scenario_.camera.width, light, out);
    }
    const double flat = scenario_.light.background * lighting_.brightness_of(y);
    if constexpr (std::is_floating_point_v<Grey>) {
      std::fill(out.begin(), out.end(), flat);
    } else {
      std::fill(out.begin(), out.end(), static_cast<Grey>(readout_.stored(flat)));
    }
    for (const ExposedMarker& marker : markers_) {
      if (marker.covers_row(y)) marker.lay_over(y, light);
    }
    // Windows may share pixels: each is lit and read once.
    std::vector<std::uint8_t> is_done(out.size(), 0);
    for (const ExposedMarker& marker : markers_) {
      if (!marker.covers_row(y)) continue;
      for (int from = marker.left(); from < marker.right();) {
        int to = from;
        const auto done = [&](int x) -> std::uint8_t& { return is_done[static_cast<std::size_t>(x)]; };
        while (to < marker.right() && done(to) == 0) done(to++) = 1;
        store(y, from, to, light, out);
        from = std::max(to, from + 1);
      }
    }
  }

 private:
  // Lights the pixels and reads them out.
  void store(int y, int from, int to, std::span<double> light, std::span<Grey> out) const {
    const auto first_pixel = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(scenario_.camera.width);
    lighting_.fall_on(y, from, to, light);
    for (int x = from; x < to; ++x) {
      const auto i = static_cast<std::size_t>(x);
      if constexpr (std::is_floating_point_v<Grey>) {
        out[i] = light[i];
      } else {
        out[i] = static_cast<Grey>(readout_.stored(light[i], y, first_pixel + i));
      }
    }
  }

  const Scenario& scenario_;
  Area area_;
  Lighting lighting_;
  Readout readout_;
  Background background_;
  std::vector<ExposedMarker> markers_;
};

template <typename Grey>
Image<Grey> rendered(const Scenario& scenario, long frame, const RenderOptions& options) {
  Image<Grey> image(scenario.camera.width, scenario.camera.height);
  const Rendering<Grey> rendering(scenario, frame, options.area);
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, scenario.camera.height, 8), [&](const tbb::blocked_range<int>& rows) {
      for (int y = rows.begin(); y < rows.end(); ++y) rendering.fill(y, image.row(y));
    });
  });
  return image;
}

}  // namespace

Picture render(const Scenario& scenario, long frame, const RenderOptions& options) {
  if (scenario.sensor.bits > 8) return rendered<std::uint16_t>(scenario, frame, options);
  return rendered<std::uint8_t>(scenario, frame, options);
}

Image<std::uint8_t> render8(const Scenario& scenario, long frame, const RenderOptions& options) {
  Scenario eight_bits = scenario;
  eight_bits.sensor.bits = 8;
  return rendered<std::uint8_t>(eight_bits, frame, options);
}

Image<double> render_ideal(const Scenario& scenario, long frame, const RenderOptions& options) {
  return rendered<double>(scenario, frame, options);
}

}  // namespace moiregauge::simulator

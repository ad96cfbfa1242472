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
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::simulator {
namespace {

// Light that falls on a pixel, relative to the centre of the picture.
struct Lighting {
  double vignetting, slope_x, slope_y, middle_x, middle_y, corner2;
  explicit Lighting(const Scenario& scenario)
      : vignetting(scenario.light.vignetting),
        slope_x(scenario.light.slope_x),
        slope_y(scenario.light.slope_y),
        middle_x(0.5 * (scenario.camera.width - 1)),
        middle_y(0.5 * (scenario.camera.height - 1)),
        corner2(middle_x * middle_x + middle_y * middle_y) {}
  [[nodiscard]] double at(int x, int y) const {
    const double dx = x - middle_x, dy = y - middle_y;
    return (1.0 - vignetting * (dx * dx + dy * dy) / corner2) *
           (1.0 + slope_x * dx / middle_x + slope_y * dy / middle_y);
  }
};

// What turns light into stored numbers.
struct Readout {
  double sigma, gain, scale, highest;
  Noise noise;
  Readout(const Scenario& scenario, long frame)
      : sigma(scenario.sensor.noise_sigma),
        gain(scenario.sensor.noise_gain),
        scale(std::ldexp(1.0, scenario.sensor.bits - 8)),
        highest(std::ldexp(1.0, scenario.sensor.bits) - 1.0),
        noise(scenario.seed, frame) {}
  [[nodiscard]] double stored(double grey, std::uint64_t pixel) const {
    const double variance = sigma * sigma + gain * std::max(grey, 0.0);
    if (variance > 0.0) grey += std::sqrt(variance) * noise.at(pixel);
    return std::clamp(std::floor(grey * scale + 0.5), 0.0, highest);
  }
};

template <typename Grey>
class Rendering {
 public:
  Rendering(const Scenario& scenario, long frame, Area area)
      : scenario_(scenario), area_(area), lighting_(scenario), readout_(scenario, frame), background_(scenario, frame) {
    for (const SceneMarker& decoy : background_.decoys()) markers_.emplace_back(scenario, decoy, frame);
    for (const SceneMarker& marker : scenario.markers) markers_.emplace_back(scenario, marker, frame);
    for (const SceneMarker& marker : scenario.markers) {
      const auto& spans = marker.cover.frames;
      const auto holds = [&](FrameSpan span) { return frame >= span.from && frame < span.to; };
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
    const double flat = scenario_.light.background * readout_.scale;
    std::fill(out.begin(), out.end(),
              std::is_floating_point_v<Grey> ? Grey(flat / readout_.scale) : Grey(std::lround(flat)));
    for (const ExposedMarker& marker : markers_) {
      if (marker.covers_row(y)) marker.lay_over(y, light);
    }
    for (const ExposedMarker& marker : markers_) {
      if (marker.covers_row(y)) store(y, marker.left(), marker.right(), light, out);
    }
  }

 private:
  void store(int y, int from, int to, std::span<const double> light, std::span<Grey> out) const {
    const auto first_pixel = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(scenario_.camera.width);
    for (int x = from; x < to; ++x) {
      const auto i = static_cast<std::size_t>(x);
      const double grey = light[i] * lighting_.at(x, y);
      if constexpr (std::is_floating_point_v<Grey>) {
        out[i] = grey;
      } else {
        out[i] = static_cast<Grey>(readout_.stored(grey, first_pixel + i));
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

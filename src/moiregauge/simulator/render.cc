// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "moiregauge/simulator/recorder.h"
#include "moiregauge/simulator/rendering/background.h"
#include "moiregauge/simulator/rendering/exposure.h"
#include "moiregauge/simulator/rendering/lighting.h"
#include "moiregauge/simulator/rendering/processing.h"
#include "moiregauge/simulator/scenario/gaussian.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::simulator {
namespace {

// Conversion of light into stored grey levels: noise, gamma, tone curve, quantisation.
class Readout {
 public:
  Readout(const Scenario& scenario, long frame)
      : sigma_(scenario.sensor.noise_sigma),
        gain_(scenario.sensor.noise_gain),
        row_(scenario.sensor.row_noise),
        gamma_(scenario.sensor.gamma),
        tone_(scenario.processing.tone),
        scale_(std::ldexp(1.0, scenario.sensor.bits - 8)),
        highest_(std::ldexp(1.0, scenario.sensor.bits) - 1.0),
        noise_(scenario.seed, shot_of(scenario, frame)),
        row_noise_(scenario.seed + kRows, shot_of(scenario, frame)) {}
  // Returns the stored value for the light of pixel number `pixel` in row y.
  [[nodiscard]] double stored(double grey, int y, std::uint64_t pixel) const {
    return quantised(toned(grey, y, pixel));
  }
  [[nodiscard]] double toned(double grey, int y, std::uint64_t pixel) const {
    const double variance = sigma_ * sigma_ + gain_ * std::max(grey, 0.0);
    if (variance > 0.0) grey += std::sqrt(variance) * noise_.at(pixel);
    if (row_ != 0.0) grey += row_ * row_noise_.at(static_cast<std::uint64_t>(y));
    return toned(grey);
  }
  // Returns the stored value without noise.
  [[nodiscard]] double stored(double grey) const { return quantised(toned(grey)); }
  [[nodiscard]] double toned(double grey) const {
    if (gamma_ != 1.0) grey = 255.0 * std::pow(std::clamp(grey / 255.0, 0.0, 1.0), 1.0 / gamma_);
    return tone_.is_linear() ? grey : encoded(tone_, grey);
  }
  [[nodiscard]] double quantised(double grey) const {
    return std::clamp(std::floor(grey * scale_ + 0.5), 0.0, highest_);
  }

 private:
  static constexpr std::uint64_t kRows = 7003;
  double sigma_, gain_, row_, gamma_;
  ToneCurve tone_;
  double scale_, highest_;
  Noise noise_, row_noise_;
};

// Output of a rendering: light (real numbers), grey levels after noise and tone curve (real numbers), or stored
// integers.
enum class Stage { kLight, kToned, kStored };

template <typename Grey>
class Rendering {
 public:
  Rendering(const Scenario& scenario, long frame, Area area, Stage stage)
      : scenario_(scenario),
        area_(area),
        stage_(stage),
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
      std::fill(out.begin(), out.end(), stage_ == Stage::kLight ? flat : cut(readout_.toned(flat)));
    } else {
      std::fill(out.begin(), out.end(), static_cast<Grey>(readout_.stored(flat)));
    }
    for (const ExposedMarker& marker : markers_) {
      if (marker.covers_row(y)) marker.lay_over(y, light);
    }
    // Windows may overlap; each pixel is lit and read out once.
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

  // Returns the region in which anything is drawn, extended by `reach` px.
  [[nodiscard]] DrawnParts drawn(int reach) const {
    const Camera& camera = scenario_.camera;
    DrawnParts parts(camera.width, camera.height);
    if (area_ == Area::kWholeFrame) parts.add(0, 0, camera.width, camera.height);
    for (const ExposedMarker& marker : markers_)
      parts.add(marker.left() - reach, marker.top() - reach, marker.right() + reach, marker.bottom() + reach);
    return parts;
  }

 private:
  // Clips to the range of the sensor.
  [[nodiscard]] static double cut(double grey) { return std::clamp(grey, 0.0, 255.0); }
  // Applies the lighting to pixels from..to of row y and reads them out.
  void store(int y, int from, int to, std::span<double> light, std::span<Grey> out) const {
    const auto first_pixel = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(scenario_.camera.width);
    lighting_.fall_on(y, from, to, light);
    for (int x = from; x < to; ++x) {
      const auto i = static_cast<std::size_t>(x);
      if constexpr (std::is_floating_point_v<Grey>) {
        out[i] = stage_ == Stage::kLight ? light[i] : cut(readout_.toned(light[i], y, first_pixel + i));
      } else {
        out[i] = static_cast<Grey>(readout_.stored(light[i], y, first_pixel + i));
      }
    }
  }

  const Scenario& scenario_;
  Area area_;
  Stage stage_;
  Lighting lighting_;
  Readout readout_;
  Background background_;
  std::vector<ExposedMarker> markers_;
};

template <typename Grey>
Image<Grey> rendered(const Rendering<Grey>& rendering, const Camera& camera) {
  Image<Grey> image(camera.width, camera.height);
  tbb::parallel_for(tbb::blocked_range<int>(0, camera.height, 8), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) rendering.fill(y, image.row(y));
  });
  return image;
}

template <typename Grey>
Image<Grey> stored(const Scenario& scenario, long frame, Area area) {
  if (!has_spatial_steps(scenario.processing))
    return rendered(Rendering<Grey>(scenario, frame, area, Stage::kStored), scenario.camera);
  const Rendering<double> rendering(scenario, frame, area, Stage::kToned);
  Image<double> picture = rendered(rendering, scenario.camera);
  develop(scenario.processing, rendering.drawn(reach_of(scenario.processing)), picture);
  const Readout readout(scenario, frame);
  Image<Grey> image(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y) {
    const auto from = picture.row(y);
    const auto to = image.row(y);
    for (std::size_t x = 0; x < from.size(); ++x) to[x] = static_cast<Grey>(readout.quantised(from[x]));
  }
  return image;
}

template <typename Make>
auto on_threads(int threads, const Make& make) {
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  return arena.execute(make);
}

}  // namespace

Picture render_still(const Scenario& scenario, long frame, const RenderOptions& options) {
  return on_threads(options.threads, [&]() -> Picture {
    if (scenario.sensor.bits > 8) return stored<std::uint16_t>(scenario, frame, options.area);
    return stored<std::uint8_t>(scenario, frame, options.area);
  });
}

Picture render(const Scenario& scenario, long frame, const RenderOptions& options) {
  return Recorder(scenario, options).frame(frame);
}

Image<std::uint8_t> render8(const Scenario& scenario, long frame, const RenderOptions& options) {
  Scenario eight_bits = scenario;
  eight_bits.sensor.bits = 8;
  return std::get<Image<std::uint8_t>>(render(eight_bits, frame, options));
}

Image<double> render_ideal(const Scenario& scenario, long frame, const RenderOptions& options) {
  return on_threads(options.threads, [&] {
    return rendered(Rendering<double>(scenario, frame, options.area, Stage::kLight), scenario.camera);
  });
}

}  // namespace moiregauge::internal::simulator

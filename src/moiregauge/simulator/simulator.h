// SPDX-License-Identifier: Apache-2.0
// Renders images with known truth. Shares no formulas with the instrument, so that an error there cannot cancel out
// here.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/simulator/scenario/built_in.h"
#include "moiregauge/simulator/scenario/scenario.h"
#include "moiregauge/site/site.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal::simulator {

enum class Area { kWholeFrame, kMarkersOnly };  // kMarkersOnly: the windows of the markers on a flat grey

struct RenderOptions {
  int threads = 0;  // 0: one per core; the number does not change the result
  Area area = Area::kWholeFrame;
};

// Stored image: 8 bits, or 10 or 12 bits in 16-bit words.
using Picture = std::variant<Image<std::uint8_t>, Image<std::uint16_t>>;
[[nodiscard]] LumaView view_of(const Picture& picture);

// Returns one frame as the camera stores it. Temporal processing requires all earlier frames; use a `Recorder` for many
// frames.
[[nodiscard]] Picture render(const Scenario& scenario, long frame, const RenderOptions& options = {});
// Returns one frame without temporal processing.
[[nodiscard]] Picture render_still(const Scenario& scenario, long frame, const RenderOptions& options = {});
// Returns one frame as `render`, but always in 8 bits.
[[nodiscard]] Image<std::uint8_t> render8(const Scenario& scenario, long frame, const RenderOptions& options = {});
// Returns the light in grey levels, without noise, quantisation, tone curve and clipping.
[[nodiscard]] Image<double> render_ideal(const Scenario& scenario, long frame, const RenderOptions& options = {});

// Returns the image position, at the middle of the exposure, of a point of a marker (board mm as stated in site.toml).
[[nodiscard]] ImagePoint project(const Scenario& scenario, long frame, const SceneMarker& marker, BoardPoint point);
// Returns the same for a fixed point of the board at z = 0.
[[nodiscard]] ImagePoint project(const Scenario& scenario, long frame, BoardPoint point);

struct Truth {
  double dx_mm = 0.0;  // mm
  double dy_mm = 0.0;  // mm
};
// Returns the mean displacement over the exposure, relative to that of frame 0.
[[nodiscard]] Truth truth(const Scenario& scenario, long frame, const SceneMarker& marker);

// Returns the site as the user states it, with the scenario's site errors: references first, no false candidates.
[[nodiscard]] Site site_of(const Scenario& scenario);

// Returns the marker with this name; null if there is none.
[[nodiscard]] const SceneMarker* find_marker(const Scenario& scenario, const std::string& name);

}  // namespace moiregauge::internal::simulator

// SPDX-License-Identifier: Apache-2.0
// Pictures with known truth. Knows nothing of the instrument, so that a formula wrong there is not wrong here too.
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

enum class Area { kWholeFrame, kMarkersOnly };  // markers only: their windows, the rest one flat grey

struct RenderOptions {
  int threads = 0;  // 0: as many as there are; never changes a pixel
  Area area = Area::kWholeFrame;
};

// 8 bits, or 10 and 12 in 16-bit words.
using Picture = std::variant<Image<std::uint8_t>, Image<std::uint16_t>>;
[[nodiscard]] LumaView view_of(const Picture& picture);

// Returns one frame as the camera stores it. With temporal processing that takes all frames before it: a `Recorder` is
// cheaper for many of them.
[[nodiscard]] Picture render(const Scenario& scenario, long frame, const RenderOptions& options = {});
// Returns the same without temporal processing.
[[nodiscard]] Picture render_still(const Scenario& scenario, long frame, const RenderOptions& options = {});
// The same as `render` in 8 bits whatever the scenario says, without the variant.
[[nodiscard]] Image<std::uint8_t> render8(const Scenario& scenario, long frame, const RenderOptions& options = {});
// The light itself in grey levels: no noise, no quantisation, no clipping.
[[nodiscard]] Image<double> render_ideal(const Scenario& scenario, long frame, const RenderOptions& options = {});

// Where a point of a marker's print (board millimetres as site.toml has them) is in the middle of the exposure.
[[nodiscard]] ImagePoint project(const Scenario& scenario, long frame, const SceneMarker& marker, BoardPoint point);
// Of a marker without movement of its own at z = 0.
[[nodiscard]] ImagePoint project(const Scenario& scenario, long frame, BoardPoint point);

// Mean displacement over the exposure, relative to frame 0.
struct Truth {
  double dx_mm = 0.0;
  double dy_mm = 0.0;
};
[[nodiscard]] Truth truth(const Scenario& scenario, long frame, const SceneMarker& marker);

// What a user would know of it: references first, look-alikes left out.
[[nodiscard]] Site site_of(const Scenario& scenario);

[[nodiscard]] const SceneMarker* find_marker(const Scenario& scenario, const std::string& name);

}  // namespace moiregauge::internal::simulator

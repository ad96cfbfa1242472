// SPDX-License-Identifier: Apache-2.0
// Estimates the camera's tone curve from printed edges (docs/methods/precise/light.md). In light, a blurred edge is
// symmetric about the middle between black and white. A tone curve bends its dark and bright ends differently.
#pragma once

#include <optional>
#include <span>

#include "moiregauge/image/tone.h"
#include "moiregauge/phase/fit/print_template.h"

namespace moiregauge::internal {

// Template of a grating with its mean level and contrast, relative to the brightest grey level (or light).
struct ToneSample {
  const PrintTemplate* print = nullptr;
  double level = 0.0;
  double contrast = 0.0;  // factor of the template
};

struct ToneExponent {
  double value = 1.0;  // power of the level that makes edges symmetric
  double u = 0.0;      // standard uncertainty (k = 1), from the scatter over gratings and axes
  int edges = 0;       // number of axes of gratings that showed it
};

// Returns the power that makes the edges symmetric, after `from` was inverted. `from` is the identity for grey levels,
// or else the curve that mapped them to light.
// Fails (nothing): fewer than two axes of gratings show straight edges with flat black and white next to them. Examples
// are dots, lines too thin for the blur, and a single noisy grating.
// Error: `u` of the result.
[[nodiscard]] std::optional<ToneExponent> edge_exponent(std::span<const ToneSample> samples, const ToneCurve& from);

}  // namespace moiregauge::internal

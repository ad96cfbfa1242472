// SPDX-License-Identifier: Apache-2.0
// The camera's tone curve as the edges of a print show it. Blur in light leaves a printed edge symmetric about the middle
// between black and white; a tone curve bends dark and bright ends differently.
#pragma once

#include <optional>
#include <span>

#include "moiregauge/image/tone.h"
#include "moiregauge/phase/fit/print_template.h"

namespace moiregauge::internal {

// A print's template with its level and contrast, in parts of the brightest grey level (or light).
struct ToneSample {
  const PrintTemplate* print = nullptr;
  double level = 0.0;
  double contrast = 0.0;  // times the template
};

struct ToneExponent {
  double value = 1.0;  // (template)^value has symmetric edges
  double u = 0.0;      // standard uncertainty, from the scatter over edges of different prints and axes
  int edges = 0;       // how many prints and axes showed it
};

// Returns the power that makes the edges of prints symmetric, were the samples' levels first mapped back by `from`:
// identity for grey levels, or the curve that made light of them. Returns nothing where fewer than two axes of prints show
// straight edges with flat black and white next to them (dots, lines too thin for the blur, a single noisy print).
[[nodiscard]] std::optional<ToneExponent> edge_exponent(std::span<const ToneSample> samples, const ToneCurve& from);

}  // namespace moiregauge::internal

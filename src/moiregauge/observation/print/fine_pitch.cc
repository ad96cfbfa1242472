// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/fine_pitch.h"

#include <cstdio>

#include "moiregauge/observation/raster/raster.h"

namespace moiregauge::internal {

std::optional<std::string> fine_pitch_note(const Site& site, const View& view) {
  const Marker* finest = nullptr;
  double finest_px = 0.0, finest_good = 0.0;
  int others = -1;
  for (const Marker& marker : site.markers) {
    if (!marker.grating) continue;
    const bool binary = marker.grating->pattern != Pattern::kCosine;
    const double good = binary ? kGoodBinaryPitchPx : kGoodCosinePitchPx;
    const double px = fundamental_pitch_mm(*marker.grating) / view.mm_per_px(marker.grating->centre);
    if (!(px < good)) continue;
    ++others;
    if (finest != nullptr && px / good >= finest_px / finest_good) continue;
    finest = &marker, finest_px = px, finest_good = good;
  }
  if (finest == nullptr) return std::nullopt;
  char more[40] = "", text[320];
  if (others > 0) std::snprintf(more, sizeof more, " (and %d more)", others);
  const bool binary = finest_good == kGoodBinaryPitchPx;
  std::snprintf(
      text, sizeof text,
      "displacements may be less certain than u: the pitch of '%.60s' is %.1f px%s, and below %.0f px %s. Move closer, "
      "or use a longer lens or a larger pitch",
      finest->name.c_str(), finest_px, more, finest_good,
      binary ? "the harmonics of a binary grating alias" : "pixels and blur attenuate a cosine grating");
  return text;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// Computes the positions of a marker set from a few numbers. A circle is next to its grating, on the outer side, where
// detection without a site file expects it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/site/site.h"

namespace moiregauge::internal::sheet {

struct SetRequest {
  double pitch_mm = 10.0;
  Pattern pattern = Pattern::kGrid;
  int references = 4;  // 4 or 6
  int targets = 1;     // in a row at half height
  // Width and height between the centres of the outermost circles, mm.
  Extent<frame::Board> span{};
  // Sizes in mm. 0: defaults of 4, 6 and 2 pitches.
  double reference_size_mm = 0.0;
  double target_size_mm = 0.0;
  double circle_diameter_mm = 0.0;
};

struct Box {
  BoardPoint low, high;  // mm
  [[nodiscard]] double width() const { return high.x - low.x; }
  [[nodiscard]] double height() const { return high.y - low.y; }
  [[nodiscard]] BoardPoint middle() const { return {0.5 * (low.x + high.x), 0.5 * (low.y + high.y)}; }
};

// Return the bounding box of a marker, or of several.
[[nodiscard]] Box extent_of(const Marker& marker);
[[nodiscard]] Box extent_of(const std::vector<Marker>& markers);

// Returns the white margin that detection needs, mm: a pitch, or a circle's radius if that is larger.
[[nodiscard]] double quiet_zone_mm(const Marker& marker);
// Returns the gap between two boxes, mm. Negative if they overlap.
[[nodiscard]] double gap_between(const Box& a, const Box& b);

// Returns the site: references NW NE SW SE (and N, S), targets T1, T2, ... from left to right, origin in the centre.
// Fails with the markers that do not fit, and a remedy.
[[nodiscard]] tl::expected<Site, std::string> site_of_set(const SetRequest& request);

// Returns the largest span of markers that fit into `room` with white margins. It is in whole centimetres above 10 cm,
// otherwise in millimetres. Not positive: nothing fits.
[[nodiscard]] Extent<frame::Board> widest_span(const SetRequest& request, Extent<frame::Board> room);

// Returns the largest pitch below that of the request with which its markers fit, in steps of at most a twentieth of it.
// The span is that of the request, or the widest one in `room` if given. Nothing: a smaller pitch does not help.
[[nodiscard]] std::optional<double> fitting_pitch(SetRequest request, std::optional<Extent<frame::Board>> room);

}  // namespace moiregauge::internal::sheet

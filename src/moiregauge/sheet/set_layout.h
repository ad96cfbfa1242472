// SPDX-License-Identifier: Apache-2.0
// Where the markers of a set stand: from a few numbers to a Site. Circle beside grating, outside it, as the
// instrument looks for them without a site file too.
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
  // Width and height between the centres of the outermost circles.
  Extent<frame::Board> span{};
  // 0: 4, 6 and 2 pitches.
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

// All ink of a marker, and of several.
[[nodiscard]] Box extent_of(const Marker& marker);
[[nodiscard]] Box extent_of(const std::vector<Marker>& markers);

// White that a print needs round it to be found: a pitch, or a circle's radius where that is more.
[[nodiscard]] double quiet_zone_mm(const Marker& marker);
// What two extents leave between them, mm; negative when they overlap.
[[nodiscard]] double gap_between(const Box& a, const Box& b);

// References NW NE SW SE (and N, S), targets T1, T2, ... from left to right; the origin is the middle.
// fails   with what does not fit, and what would
[[nodiscard]] tl::expected<Site, std::string> site_of_set(const SetRequest& request);

// The widest span whose markers, with white round them, fit into so much room; in whole centimetres where that is more
// than 10 cm, else in millimetres. Not positive: nothing fits.
[[nodiscard]] Extent<frame::Board> widest_span(const SetRequest& request, Extent<frame::Board> room);

}  // namespace moiregauge::internal::sheet

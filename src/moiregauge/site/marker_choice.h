// SPDX-License-Identifier: Apache-2.0
// Choice of the user among the markers of a site: roles, names, and where to look for them in the image.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Rectangle in the image, px, as displayed. x and y are its upper left corner.
struct PixelRegion {
  double x = 0.0, y = 0.0;
  double width = 0.0, height = 0.0;
  [[nodiscard]] bool holds(ImagePoint p) const { return p.x >= x && p.x < x + width && p.y >= y && p.y < y + height; }
};

// Part of the image in which markers are looked for. A circle or grating is in it if its centre is.
struct SearchArea {
  std::vector<PixelRegion> regions;   // empty: the whole image
  std::vector<PixelRegion> excluded;  // takes precedence
  [[nodiscard]] bool holds(ImagePoint p) const;
};

struct NewName {
  std::string from, to;
};

struct MarkerChoice {
  // All markers of a role. Empty: those of the site. A marker of the site in neither list is removed if the list of its
  // own role is given.
  std::vector<std::string> references, targets;
  std::vector<std::string> ignored;
  std::vector<NewName> names;  // applied last
  [[nodiscard]] bool is_empty() const {
    return references.empty() && targets.empty() && ignored.empty() && names.empty();
  }
};

// Returns the site with the chosen markers, roles and names, references first.
// Fails: "what: where: what to do" for an unknown name, a name chosen twice, or a target without a grating.
[[nodiscard]] tl::expected<Site, std::string> choose_markers(const Site& site, const MarkerChoice& choice);

// Returns for each marker of the chosen site its index in `site`. The choice must be valid for it.
[[nodiscard]] std::vector<std::size_t> chosen_indices(const Site& site, const MarkerChoice& choice);

}  // namespace moiregauge::internal

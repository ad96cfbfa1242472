// SPDX-License-Identifier: Apache-2.0
// Choice of markers as typed. `measure`, `inspect` and `solve` share it.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/app/usage_error.h"
#include "moiregauge/site/marker_choice.h"

namespace moiregauge::internal {

struct MarkerChoiceArgs {
  std::vector<std::string> references, targets, ignored;
  std::vector<std::string> names;    // "T1=midspan"
  std::vector<std::string> regions;  // "x,y,w,h"
  std::vector<std::string> excluded_regions;
};

// Returns the choice of names. Fails: a name is not valid for a marker.
[[nodiscard]] tl::expected<MarkerChoice, UsageError> marker_choice_of(const MarkerChoiceArgs& args);
// Returns the search area. Fails: a region is not four numbers, or it is empty.
[[nodiscard]] tl::expected<SearchArea, UsageError> search_area_of(const MarkerChoiceArgs& args);

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
// Body of /api/inspect, and the command line that does the same.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"

namespace moiregauge::internal {

struct InspectBody {
  std::string path;       // relative to the folder
  std::string site_text;  // text of a site file; empty: none
  long frame = 0;
  MeasureArgs args;  // pitch, axes and choice of markers; no file
};

// Reads the body. Fails with "what: where: what to do": an unknown key, or a value of another type.
[[nodiscard]] tl::expected<InspectBody, std::string> inspect_body(const nlohmann::json& json);

// Returns the options that both `inspect` and `measure` take for this choice: --pitch, --references and so on. `site`:
// path of the site file, empty: none.
[[nodiscard]] std::vector<std::string> option_words(const InspectBody& body, const std::string& site);

}  // namespace moiregauge::internal

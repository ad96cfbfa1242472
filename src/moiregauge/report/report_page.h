// SPDX-License-Identifier: Apache-2.0
// Writes report.html, a self-contained page of a whole run for any browser, without a network (docs/file-formats.md).
//
// The template is web/dist/report.html, bundled from web/src and embedded when the program is built. Results are
// inserted as JSON (texts, spectra, run.json) and as packed columns (samples). Nothing is measured here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// Returns the page. `run_json` and `overlay` are the files written next to it. If `overlay` is empty, the page has no
// image.
[[nodiscard]] std::string report_page(const Measurement& measurement, const MeasureOptions& options,
                                      const std::string& run_json, const std::vector<std::uint8_t>& overlay);

// Returns the bundled page with its two marks. Generated code (cmake/EmbedFile.cmake).
[[nodiscard]] std::string_view report_template();

}  // namespace moiregauge::internal

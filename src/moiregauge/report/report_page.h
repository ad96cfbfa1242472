// SPDX-License-Identifier: Apache-2.0
// report.html: one page that shows a whole run, by itself, in any browser, without a network (docs/file-formats.md).
//
// The page is web/dist/report.html, bundled from web/src and embedded when the program is built. What a run found is
// put into it as JSON (words, spectra, run.json) and as packed columns (the samples). Nothing is measured here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// run_json, overlay   as they are written beside the page; an empty overlay leaves its picture out
[[nodiscard]] std::string report_page(const Measurement& measurement, const MeasureOptions& options,
                                      const std::string& run_json, const std::vector<std::uint8_t>& overlay);

// The page as it was bundled, with its two marks. Generated (cmake/EmbedFile.cmake).
[[nodiscard]] std::string_view report_template();

}  // namespace moiregauge::internal

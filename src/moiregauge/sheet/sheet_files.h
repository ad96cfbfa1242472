// SPDX-License-Identifier: Apache-2.0
// A set as files: one PDF with a page per sheet, an SVG per sheet, and the mounting plan. Vectors at exact size: edges
// are right to 0.001 mm in the PDF and 0.002 mm in the SVG (cairo's fixed point). The same set gives the same bytes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "moiregauge/sheet/print_path.h"
#include "moiregauge/sheet/sheet_set.h"

namespace moiregauge::internal::sheet {

struct SheetFiles {
  std::string pdf;                                       // sheets.pdf
  std::string plan;                                      // mounting.pdf
  std::vector<std::pair<std::string, std::string>> svg;  // name without its ending, text; in the order of the sheets
};

// `created`: date of the PDFs as in "2026-03-01T12:00:00Z"; empty: none is written. Empty bytes: cairo had no memory.
[[nodiscard]] SheetFiles files_of(const SheetSet& set, const Ink& ink, const std::string& created);

}  // namespace moiregauge::internal::sheet

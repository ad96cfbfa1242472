// SPDX-License-Identifier: Apache-2.0
// Writes a marker set as files: one PDF with a page per sheet, an SVG per sheet, and the mounting plan. The same set
// gives the same bytes.
// They are vectors at exact size: edges are correct to 0.001 mm in the PDF and 0.002 mm in the SVG (cairo's fixed
// point).
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
  std::vector<std::pair<std::string, std::string>> svg;  // name without extension, text; in sheet order
};

// Returns the files. `created`: date of the PDFs, such as "2026-03-01T12:00:00Z"; empty: no date. Empty bytes: cairo is
// out of memory.
[[nodiscard]] SheetFiles files_of(const SheetSet& set, const Ink& ink, const std::string& created);

}  // namespace moiregauge::internal::sheet

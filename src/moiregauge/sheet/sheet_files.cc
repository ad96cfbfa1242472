// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/sheet_files.h"

#include <cctype>
#include <functional>
#include <map>
#include <string_view>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include "moiregauge/drawing/surface/surface.h"
#include "moiregauge/sheet/draw_sheet.h"
#include "moiregauge/sheet/draw_tile.h"
#include "moiregauge/sheet/mounting_plan.h"

namespace moiregauge::internal::sheet {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;

// Returns a valid file name for any marker name.
std::string file_name(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80 ||
                          c == '-' || c == '_';
    plain += is_plain ? c : '_';
  }
  return plain.empty() ? "_" : plain;
}

struct Page {
  Paper paper;
  std::function<void(cairo_t*)> draw;
};

std::string pdf_of(const std::vector<Page>& pages, const std::string& title, const std::string& created) {
  std::string bytes;
  const Surface surface(cairo_pdf_surface_create_for_stream(append_bytes, &bytes, 72.0, 72.0), cairo_surface_destroy);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                 created.empty() ? nullptr : created.c_str());
  for (const Page& page : pages) {
    cairo_pdf_surface_set_size(surface.get(), kPointsPerMm * page.paper.width_mm, kPointsPerMm * page.paper.height_mm);
    const Context context(cairo_create(surface.get()), cairo_destroy);
    cairo_scale(context.get(), kPointsPerMm, kPointsPerMm);
    page.draw(context.get());
    cairo_show_page(context.get());
  }
  cairo_surface_finish(surface.get());
  return cairo_surface_status(surface.get()) == CAIRO_STATUS_SUCCESS ? bytes : std::string{};
}

// Renumbers cairo's surfaces and images from 1 in every file, because cairo numbers them per process. Their names
// follow id=" and #, and end with digits.
std::string renumbered(const std::string& svg) {
  std::map<std::string, std::string, std::less<>> names;
  std::string text;
  std::size_t done = 0;
  for (std::size_t at = 0; (at = svg.find_first_of("#\"", at)) != std::string::npos; ++at) {
    const std::string_view rest = std::string_view(svg).substr(at + 1);
    for (const std::string_view kind : {"surface", "image"}) {
      if (rest.substr(0, kind.size()) != kind) continue;
      const std::size_t end = rest.find_first_not_of("0123456789", kind.size());
      const std::string_view name = rest.substr(0, end);
      if (name.size() == kind.size()) continue;
      const auto found =
          names.try_emplace(std::string(name), std::string(kind) + std::to_string(names.size() + 1)).first;
      text.append(svg, done, at + 1 - done).append(found->second);
      done = at + 1 + name.size();
    }
  }
  return text.append(svg, done);
}

// Returns an SVG in mm, for drawing programs and laser cutters.
std::string svg_of(const Page& page) {
  std::string text;
  const Surface surface(
      cairo_svg_surface_create_for_stream(append_bytes, &text, page.paper.width_mm, page.paper.height_mm),
      cairo_surface_destroy);
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_MM);
  {
    const Context context(cairo_create(surface.get()), cairo_destroy);
    page.draw(context.get());
  }
  cairo_surface_finish(surface.get());
  return cairo_surface_status(surface.get()) == CAIRO_STATUS_SUCCESS ? renumbered(text) : std::string{};
}

// Returns the pages of the PDF: a sheet, or its parts if it is larger than the paper.
std::vector<Page> printed_pages(const SheetSet& set, const Ink& ink) {
  std::vector<Page> pages;
  for (const Sheet& sheet : set.sheets) {
    if (!sheet.tiling) pages.push_back({sheet.paper, [&sheet, &ink](cairo_t* cr) { draw_sheet(cr, sheet, ink); }});
    for (int part = 0; part < (sheet.tiling ? sheet.tiling->columns * sheet.tiling->rows : 0); ++part) {
      const int column = part % sheet.tiling->columns, row = part / sheet.tiling->columns;
      pages.push_back(
          {sheet.tiling->paper, [&sheet, &ink, column, row](cairo_t* cr) { draw_tile(cr, sheet, column, row, ink); }});
    }
  }
  return pages;
}

}  // namespace

SheetFiles files_of(const SheetSet& set, const Ink& ink, const std::string& created) {
  SheetFiles files;
  std::vector<Page> pages;
  for (const Sheet& sheet : set.sheets)
    pages.push_back({sheet.paper, [&sheet, &ink](cairo_t* cr) { draw_sheet(cr, sheet, ink); }});
  files.pdf = pdf_of(printed_pages(set, ink), "moiregauge marker sheets", created);
  for (std::size_t i = 0; i < pages.size(); ++i) {
    std::string name = file_name(set.sheets[i].name);
    const auto is_taken = [&] {
      for (const auto& other : files.svg) {
        if (other.first == name) return true;
      }
      return false;
    };
    while (is_taken()) name += "_";
    files.svg.emplace_back(name, svg_of(pages[i]));
  }
  files.plan = pdf_of({{plan_paper(), [&set](cairo_t* cr) { draw_mounting_plan(cr, set); }}},
                      "moiregauge mounting plan", created);
  return files;
}

}  // namespace moiregauge::internal::sheet

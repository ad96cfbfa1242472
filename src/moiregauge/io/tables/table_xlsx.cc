// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/table_xlsx.h"

#include <cmath>
#include <utility>

#include <xlsxwriter.h>

#include "moiregauge/io/tables/scratch_file.h"

namespace moiregauge::internal {
namespace {

// Writes the cells of one row from the left.
class RowWriter {
 public:
  RowWriter(lxw_worksheet* sheet, std::size_t row) : sheet_(sheet), row_(static_cast<lxw_row_t>(row)) {}
  void text(const std::string& value, lxw_format* format = nullptr) {
    worksheet_write_string(sheet_, row_, column_++, value.c_str(), format);
  }
  void number(double value) {
    if (std::isfinite(value))
      worksheet_write_number(sheet_, row_, column_++, value, nullptr);
    else
      worksheet_write_formula_str(sheet_, row_, column_++, "=NA()", nullptr, "#N/A");
  }

 private:
  lxw_worksheet* sheet_;
  lxw_row_t row_;
  lxw_col_t column_ = 0;
};

void put_table(lxw_worksheet* sheet, lxw_format* bold, const RunTable& table, const TableStyle& style) {
  const std::vector<WideColumn> columns = wide_columns(style);
  RowWriter head(sheet, 0);
  head.text("frame", bold);
  head.text("time_s", bold);
  for (const TableMarker& marker : table.markers) {
    for (const WideColumn& column : columns) head.text(marker.name + "_" + column.name, bold);
    head.text(marker.name + "_ok", bold);
  }
  worksheet_freeze_panes(sheet, 1, 0);
  std::size_t number = 1;
  for (const WideRow& row : wide_rows(table)) {
    RowWriter line(sheet, number++);
    line.number(static_cast<double>(row.frame));
    line.number(row.time_s);
    for (const Sample* s : row.samples) {
      for (const WideColumn& column : columns) line.number(s == nullptr ? kNotMeasured : column.value(*s));
      line.number(s != nullptr && s->status == Status::kOk ? 1.0 : 0.0);
    }
  }
}

void put_origin(lxw_worksheet* sheet, lxw_format* bold, const RunTable& table) {
  const std::pair<const char*, std::string> facts[] = {
      {"moiregauge", table.version},
      {"method", table.method},
      {"input", table.input},
      {"input_sha256", table.input_sha256},
      {"reference_frame", std::to_string(table.reference_frame)},
      {"complete", table.complete ? "yes" : "no"},
      {"dx_mm, dy_mm", "displacement since the reference frame; right and up are positive"},
      {"u_dx_mm, u_dy_mm", "standard uncertainty, k = 1"},
      {"ok", "1: reliable; 0: see the status in displacement.csv"}};
  std::size_t number = 0;
  for (const auto& [name, value] : facts) {
    RowWriter line(sheet, number++);
    line.text(name, bold);
    line.text(value);
  }
}

}  // namespace

std::string table_xlsx(const RunTable& table, const TableStyle& style) {
  const ScratchFile file;
  if (file.path().empty()) return {};
  lxw_workbook* workbook = workbook_new(file.path().c_str());
  if (workbook == nullptr) return {};
  lxw_doc_properties properties{};
  properties.created = 1;  // s since 1970: the time of writing would change the bytes
  workbook_set_properties(workbook, &properties);
  lxw_format* bold = workbook_add_format(workbook);
  format_set_bold(bold);
  put_table(workbook_add_worksheet(workbook, "displacement"), bold, table, style);
  put_origin(workbook_add_worksheet(workbook, "run"), bold, table);
  return workbook_close(workbook) == LXW_NO_ERROR ? file.bytes() : std::string{};
}

}  // namespace moiregauge::internal

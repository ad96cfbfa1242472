// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/table_mat.h"

#include <memory>

#include <matio.h>

#include "moiregauge/io/tables/scratch_file.h"

namespace moiregauge::internal {
namespace {

struct Free {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, Free>;

// Returns a column of numbers, copied.
Variable column_of(const char* name, std::vector<double>& values) {
  std::size_t size[2] = {values.size(), 1};
  return Variable(Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, values.data(), 0));
}

// Returns a text, copied. The library takes no constant data.
Variable text_variable(const char* name, std::string text) {
  std::size_t size[2] = {1, text.size()};
  return Variable(Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, size, text.data(), 0));
}

template <typename Value>
std::vector<double> values_of(const std::vector<WideRow>& rows, Value value) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const WideRow& row : rows) values.push_back(value(row));
  return values;
}

// Returns the struct array of the targets. The struct owns its fields.
Variable targets_of(const RunTable& table, const std::vector<WideRow>& rows, const std::vector<WideColumn>& columns) {
  std::vector<const char*> names{"name"};
  for (const WideColumn& column : columns) names.push_back(column.name);
  names.push_back("ok");
  std::size_t size[2] = {1, table.markers.size()};
  Variable targets(Mat_VarCreateStruct("targets", 2, size, names.data(), static_cast<unsigned>(names.size())));
  for (std::size_t i = 0; targets && i < table.markers.size(); ++i) {
    const auto put = [&](const char* name, Variable field) {
      Mat_VarSetStructFieldByName(targets.get(), name, i, field.release());
    };
    put("name", text_variable("name", table.markers[i].name));
    for (const WideColumn& column : columns) {
      auto values = values_of(rows, [&](const WideRow& row) {
        return row.samples[i] == nullptr ? kNotMeasured : column.value(*row.samples[i]);
      });
      put(column.name, column_of(column.name, values));
    }
    auto ok = values_of(rows, [&](const WideRow& row) {
      return row.samples[i] != nullptr && row.samples[i]->status == Status::kOk ? 1.0 : 0.0;
    });
    put("ok", column_of("ok", ok));
  }
  return targets;
}

}  // namespace

std::string table_mat(const RunTable& table, const TableStyle& style) {
  const ScratchFile file;
  if (file.path().empty()) return {};
  const std::vector<WideRow> rows = wide_rows(table);
  const std::string head = "MATLAB 5.0 MAT-file, written by moiregauge " + table.version;  // without a time
  mat_t* mat = Mat_CreateVer(file.path().c_str(), head.c_str(), MAT_FT_MAT5);
  if (mat == nullptr) return {};
  auto frames = values_of(rows, [](const WideRow& row) { return static_cast<double>(row.frame); });
  auto times = values_of(rows, [](const WideRow& row) { return row.time_s; });
  bool is_written = true;
  const auto put = [&](const Variable& variable) {
    is_written = is_written && variable && Mat_VarWrite(mat, variable.get(), MAT_COMPRESSION_NONE) == 0;
  };
  put(column_of("frame", frames));
  put(column_of("time_s", times));
  put(targets_of(table, rows, wide_columns(style)));
  put(text_variable("method", table.method));
  put(text_variable("input", table.input));
  if (Mat_Close(mat) != 0 || !is_written) return {};
  return file.bytes();
}

}  // namespace moiregauge::internal

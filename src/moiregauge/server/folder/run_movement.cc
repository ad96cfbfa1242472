// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/run_movement.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <vector>

namespace moiregauge::internal {
namespace {

constexpr std::int64_t kMaxCsv = 256 << 20;  // bytes
constexpr std::size_t kCsvPiece = 1 << 20;   // bytes of one read
constexpr std::size_t kColumns = 8;

double csv_number(std::string_view text) {
  double value = std::nan("");
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void widen(double value, double& lowest, double& highest) {
  if (std::isnan(value)) return;
  lowest = std::min(lowest, value);
  highest = std::max(highest, value);
}

void add_row(std::string_view line, Movements& movements) {
  std::array<std::string_view, kColumns> fields;
  for (std::string_view& field : fields) {
    const std::size_t comma = std::min(line.find(','), line.size());
    field = line.substr(0, comma);
    line.remove_prefix(std::min(comma + 1, line.size()));
  }
  if (fields[7] != "ok") return;
  MarkerMovement& movement = movements[std::string(fields[2])];
  widen(csv_number(fields[3]), movement.lowest_dx_mm, movement.highest_dx_mm);
  widen(csv_number(fields[4]), movement.lowest_dy_mm, movement.highest_dy_mm);
}

}  // namespace

void add_rows(std::string_view lines, Movements& movements) {
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    add_row(lines.substr(0, end), movements);
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
}

Movements movements_of(const std::string& displacement_csv) {
  Movements movements;
  std::ifstream in(displacement_csv, std::ios::binary | std::ios::ate);
  if (!in || in.tellg() > kMaxCsv) return movements;
  in.seekg(0);
  std::string text;
  std::vector<char> piece(kCsvPiece);
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())), in.gcount() > 0) {
    text.append(piece.data(), static_cast<std::size_t>(in.gcount()));
    const std::size_t whole = text.rfind('\n') + 1;  // 0 if there is no line end
    add_rows(std::string_view(text).substr(0, whole), movements);
    text.erase(0, whole);
  }
  add_rows(text, movements);
  return movements;
}

}  // namespace moiregauge::internal

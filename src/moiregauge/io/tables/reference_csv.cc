// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/reference_csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/tables/time_cell.h"

namespace moiregauge::internal {
namespace {

using Cells = std::vector<std::string>;

constexpr std::size_t kMaxShown = 40;  // bytes of a cell in a message
constexpr std::size_t kMaxNames = 20;  // column names in a message

std::string shown(const std::string& cell) {
  return cell.size() > kMaxShown ? cell.substr(0, kMaxShown) + "..." : cell;
}

std::string without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \r\t");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \r\t") - first + 1));
}

char separator_of(const std::string& line) {
  for (const char c : {'\t', ';'}) {
    if (line.find(c) != std::string::npos) return c;
  }
  return ',';
}

Cells cells_in(const std::string& line, char separator) {
  Cells cells(1);
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"')
      is_quoted = !is_quoted;
    else if (c == separator && !is_quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  for (std::string& cell : cells) cell = without_blanks(cell);
  return cells;
}

bool is_skipped(const std::string& line) {
  const std::string text = without_blanks(line);
  return text.empty() || text.front() == '#' || text.front() == '%' || text.rfind("//", 0) == 0;
}

// Returns the number; NaN for an empty cell or NaN itself.
std::optional<double> real_in(std::string cell) {
  if (cell.empty()) return kNotMeasured;
  if (std::count(cell.begin(), cell.end(), ',') == 1 && cell.find('.') == std::string::npos) cell[cell.find(',')] = '.';
  const char* first = cell.data() + (cell.front() == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(first, cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size()) return std::nullopt;
  if (std::isinf(value)) return std::nullopt;
  return std::isnan(value) ? kNotMeasured : value;
}

std::optional<std::size_t> number_of_column(const std::string& text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number == 0) return std::nullopt;
  return number - 1;
}

class ReferenceParser {
 public:
  ReferenceParser(const std::string& path, const ReferenceColumns& columns) : path_(path), columns_(columns) {
    value_ = number_of_column(columns.value);
    if (!columns.rate_hz) time_ = number_of_column(columns.time);
    second_ = seconds_of_unit(columns.time_unit).value_or(1.0);
  }

  tl::expected<void, ReferenceMistake> take(const std::string& line, std::size_t number) {
    line_ = number;
    if (is_skipped(line)) return {};
    if (series_.value.empty()) separator_ = separator_of(line);
    const Cells cells = cells_in(line, separator_);
    return has_columns() && !(series_.value.empty() && is_header(cells)) ? take_row(cells) : take_header(cells);
  }

  tl::expected<ReferenceRecord, ReferenceMistake> finish() {
    if (!series_.value.empty())
      return ReferenceRecord{std::move(series_), columns_.time_unit.empty() ? named_unit_ : ""};
    if (const auto missing = missing_column()) return unknown_column(*missing);
    return file_mistake("the reference has no row of numbers", path_, "choose another column with --column");
  }

  [[nodiscard]] tl::unexpected<ReferenceMistake> is_utf16() const {
    return file_mistake("the reference is UTF-16 text", path_, "save it as CSV in UTF-8");
  }
  [[nodiscard]] tl::unexpected<ReferenceMistake> too_long(std::size_t number) const {
    return file_mistake("a line of the reference is too long", fmt::format("{}:{}", path_, number),
                        "give a CSV file with one row per line");
  }

 private:
  [[nodiscard]] bool has_columns() const { return value_ && (time_ || columns_.rate_hz); }
  [[nodiscard]] std::optional<std::string> missing_column() const {
    if (!value_) return columns_.value;
    if (!columns_.rate_hz && !time_) return columns_.time;
    return std::nullopt;
  }
  static tl::unexpected<ReferenceMistake> file_mistake(const std::string& what, const std::string& where,
                                                       const std::string& remedy) {
    return tl::unexpected(ReferenceMistake{false, fmt::format("{}: {}: {}", what, where, remedy)});
  }
  [[nodiscard]] tl::unexpected<ReferenceMistake> unknown_column(const std::string& name) const {
    const std::string known = names_.empty() ? "a number" : fmt::format("one of {}", fmt::join(names_, ", "));
    return tl::unexpected(ReferenceMistake{true, fmt::format("the reference has no column \"{}\": {}: give {} with "
                                                             "--column and --time-column",
                                                             shown(name), path_, known)});
  }

  // A header line has neither a value nor a time in the chosen columns.
  [[nodiscard]] bool is_header(const Cells& cells) const {
    const auto is_number = [&](std::size_t i) {
      return i < cells.size() && !cells[i].empty() && real_in(cells[i]).has_value();
    };
    const auto is_time = [&](std::size_t i) {
      return is_number(i) || (i < cells.size() && clock_time(cells[i]).has_value());
    };
    return !is_number(*value_) && (columns_.rate_hz || !is_time(*time_));
  }

  tl::expected<void, ReferenceMistake> take_header(const Cells& cells) {
    const bool is_all_numbers =
        std::all_of(cells.begin(), cells.end(), [](const std::string& cell) { return real_in(cell).has_value(); });
    if (is_all_numbers || ++headers_ > kMaxHeaderLines) {
      if (const auto missing = missing_column()) return unknown_column(*missing);
      if (is_all_numbers) return unknown_column(columns_.value);
      return file_mistake(fmt::format("the first {} lines of the reference hold no numbers", kMaxHeaderLines), path_,
                          "choose another column with --column");
    }
    for (const std::string& cell : cells) {
      if (names_.size() < kMaxNames && !cell.empty()) names_.push_back(shown(cell));
    }
    const auto find = [&](const std::string& name, std::optional<std::size_t>& place) {
      const auto found = std::find(cells.begin(), cells.end(), name);
      if (!place && found != cells.end()) place = static_cast<std::size_t>(found - cells.begin());
    };
    find(columns_.value, value_);
    if (columns_.rate_hz) return {};
    find(columns_.time, time_);
    if (time_ && *time_ < cells.size()) take_time_unit(cells[*time_]);
    return {};
  }

  void take_time_unit(const std::string& name) {
    const auto unit = time_unit_in(name);
    if (!unit || !columns_.time_unit.empty()) return;
    second_ = *seconds_of_unit(*unit);
    named_unit_ = second_ == 1.0 ? "" : *unit;
  }

  // Returns the time of a row in s.
  tl::expected<double, ReferenceMistake> time_of(const Cells& cells) {
    if (columns_.rate_hz) return static_cast<double>(series_.value.size()) / *columns_.rate_hz;
    const auto clock = *time_ < cells.size() ? clock_time(cells[*time_]) : std::nullopt;
    if (series_.value.empty()) first_row_ = clock;
    if (clock && first_row_ && clock->has_date == first_row_->has_date) return since_first_row(*clock);
    if (first_row_)
      return file_mistake("a row of the reference has another form of time than the first",
                          fmt::format("{}:{}", path_, line_), "correct the line");
    auto stamp = cell_of(cells, *time_);
    if (!stamp) return stamp;
    return second_ * *stamp;
  }

  // A time of day that falls by more than half a day has passed midnight.
  double since_first_row(const ClockTime& clock) {
    constexpr double kDay_s = 86400.0;
    const double seconds = clock.seconds - first_row_->seconds;
    if (clock.has_date || series_.time_s.empty()) return seconds;
    const double behind = series_.time_s.back() - 0.5 * kDay_s - seconds;
    return seconds + kDay_s * std::max(0.0, std::ceil(behind / kDay_s));
  }

  tl::expected<void, ReferenceMistake> take_row(const Cells& cells) {
    if (series_.value.size() >= kMaxReferenceRows)
      return file_mistake(fmt::format("the reference has more than {} rows", kMaxReferenceRows), path_,
                          "give a part of it, or fewer samples per second");
    const auto value = cell_of(cells, *value_);
    if (!value) return tl::unexpected(value.error());
    const auto stamp = time_of(cells);
    if (!stamp) return tl::unexpected(stamp.error());
    const double time = *stamp;
    const std::string where = fmt::format("{}:{}", path_, line_);
    if (!std::isfinite(time))
      return file_mistake("a row of the reference has no time", where, "give a time in each row, or --rate HZ");
    if (!series_.time_s.empty() && !(time > series_.time_s.back()))
      return file_mistake(
          fmt::format("the times of the reference do not increase ({} after {})", time, series_.time_s.back()), where,
          "choose the column with --time-column, or give --rate HZ");
    series_.time_s.push_back(time);
    series_.value.push_back(*value);
    return {};
  }

  [[nodiscard]] tl::expected<double, ReferenceMistake> cell_of(const Cells& cells, std::size_t column) const {
    const std::string where = fmt::format("{}:{}", path_, line_);
    if (column >= cells.size()) {
      if (series_.value.empty()) return unknown_column(std::to_string(column + 1));
      return file_mistake(fmt::format("a row of the reference has {} cells, not {}", cells.size(), column + 1), where,
                          "correct the line");
    }
    const auto number = real_in(cells[column]);
    if (number) return *number;
    return file_mistake(
        fmt::format("a cell of the reference is no number (\"{}\", column {})", shown(cells[column]), column + 1),
        where, "correct it, or choose another column with --column and --time-column");
  }

  const std::string& path_;
  const ReferenceColumns& columns_;
  std::optional<std::size_t> time_, value_;
  char separator_ = 0;
  std::size_t line_ = 0, headers_ = 0;
  std::vector<std::string> names_;
  double second_ = 1.0;                 // s per unit of a time
  std::string named_unit_;              // by the header, unless s
  std::optional<ClockTime> first_row_;  // none: times are numbers
  Series series_;
};

}  // namespace

tl::expected<ReferenceRecord, ReferenceMistake> parse_reference_csv(std::istream& csv, const std::string& path,
                                                                    const ReferenceColumns& columns) {
  ReferenceParser parser(path, columns);
  std::string line;
  std::size_t number = 1;
  bool is_first_byte = true;
  for (std::istreambuf_iterator<char> at(csv), end; at != end || !line.empty();) {
    const bool is_end = at == end;
    const char c = is_end ? '\n' : *at;
    if (!is_end) ++at;
    if (c != '\n') {
      if (line.size() >= kMaxReferenceLine) return parser.too_long(number);
      line += c;
      continue;
    }
    if (is_first_byte && line.rfind("\xEF\xBB\xBF", 0) == 0) line.erase(0, 3);  // byte-order mark
    if (is_first_byte && (line.rfind("\xFF\xFE", 0) == 0 || line.rfind("\xFE\xFF", 0) == 0)) return parser.is_utf16();
    is_first_byte = false;
    if (const auto taken = parser.take(line, number); !taken) return tl::unexpected(taken.error());
    line.clear();
    ++number;
  }
  return parser.finish();
}

tl::expected<ReferenceRecord, ReferenceMistake> read_reference_csv(const std::string& path,
                                                                   const ReferenceColumns& columns) {
  std::error_code error;
  const std::string kind = kind_unless_plain(path);
  std::ifstream file;
  if (kind.empty()) file.open(path, std::ios::binary);
  if (!kind.empty() || !file.is_open())
    return tl::unexpected(ReferenceMistake{
        false, fmt::format("the reference could not be read: {}{}: give a CSV file of the other sensor", path,
                           !std::filesystem::exists(path, error) ? " (no such file)"
                           : kind.empty()                        ? ""
                                                                 : " (it is " + kind + ")")});
  return parse_reference_csv(file, path, columns);
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/uff58.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr double kUneven = 0.05;  // frame intervals: largest deviation of an even time stamp
constexpr const char* kMark = "    -1\n";

struct Reading {
  double time_s, value_mm;
};
using Readings = std::vector<Reading>;

// Formats a text line (80A1): non-ASCII characters become question marks, and longer texts are cut.
std::string words(std::string text) {
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  text.resize(std::min<std::size_t>(text.size(), 80));
  return (text.empty() ? "NONE" : text) + "\n";
}

std::string e13(double value) { return fmt::format("{:13.5E}", value); }
std::string e20(double value) { return fmt::format("{:20.12E}", value); }
// Formats D25.17, Fortran's double with exponent letter D.
std::string d25(double value) {
  std::string text = fmt::format("{:25.17E}", value);
  std::replace(text.begin(), text.end(), 'E', 'D');
  return text;
}

// Code 5: mm, mN, degrees Celsius. Values in SI units are these divided by the factors. Lines: I10,20A1,I10; 3D25.17;
// D25.17.
std::string units_dataset() {
  return fmt::format("{}   164\n{:>10}{:<20}{:>10}\n{}{}{}\n{}\n{}", kMark, 5, "mm (milli-newton)", 2, d25(1e3),
                     d25(1e3), d25(1.0), d25(273.15), kMark);
}

// Record 4I10, 3E13.5: node, two coordinate systems, colour, position.
std::string nodes_dataset(const RunTable& table) {
  std::string text = fmt::format("{}    15\n", kMark);
  for (std::size_t i = 0; i < table.markers.size(); ++i) {
    const TableMarker& m = table.markers[i];
    text +=
        fmt::format("{:>10}{:>10}{:>10}{:>10}{}{}{}\n", i + 1, 0, 0, 1, e13(m.place.x), e13(m.place.y), e13(m.z_mm));
  }
  return text + kMark;
}

// Record I10,3I5,2(1X,20A1): kind of data, exponents of length, force and temperature, label, unit.
std::string axis_record(int kind, int length, const char* label, const char* unit) {
  return fmt::format("{:>10}{:>5}{:>5}{:>5} {:<20} {:<20}\n", kind, length, 0, 0, label, unit);
}

std::string data_lines(const Readings& stretch, bool is_even) {
  std::string text;
  const std::size_t per_line = is_even ? 4 : 2;
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    if (!is_even) text += e13(stretch[i].time_s);
    text += e20(stretch[i].value_mm);
    if (i % per_line == per_line - 1 || i + 1 == stretch.size()) text += "\n";
  }
  return text;
}

struct Place {
  std::size_t marker;  // index in the table
  int axis;            // 0: x, 1: y
  int function;        // identification in record 6
};

// The mark, and the five text lines.
std::string head_of_dataset(const RunTable& table, const std::string& title) {
  std::string text = fmt::format("{}    58\n", kMark);
  text += words(title);
  text += words(
      fmt::format("moiregauge {}, method {}{}", table.version, table.method, table.complete ? "" : ", incomplete"));
  text += words("NONE");  // date of creation, which the folder does not contain
  text += words(std::filesystem::path(table.input).filename().string());
  return text + words("NONE");
}

std::string dataset(const RunTable& table, const Place& place, const Readings& stretch, std::size_t number) {
  constexpr int kTimeResponse = 1, kRealDouble = 4, kTime = 17, kDisplacement = 8;
  const std::string& name = table.markers[place.marker].name;
  const double span = stretch.back().time_s - stretch.front().time_s;
  const double step = stretch.size() > 1 ? span / static_cast<double>(stretch.size() - 1) : 0.0;
  bool is_even = true;
  for (std::size_t i = 0; i < stretch.size(); ++i)
    is_even = is_even &&
              std::abs(stretch[i].time_s - stretch.front().time_s - static_cast<double>(i) * step) <= kUneven * step;
  std::string text = head_of_dataset(table, fmt::format("{} {}: displacement since frame {}", name,
                                                        place.axis == 0 ? "dx" : "dy", table.reference_frame));
  text += fmt::format("{:>5}{:>10}{:>5}{:>10} {:<10}{:>10}{:>4} {:<10}{:>10}{:>4}\n", kTimeResponse, place.function,
                      number, 0, "NONE", place.marker + 1, place.axis + 1, "NONE", 0, 0);
  text += fmt::format("{:>10}{:>10}{:>10}{}{}{}\n", kRealDouble, stretch.size(), is_even ? 1 : 0,
                      e13(is_even ? stretch.front().time_s : 0.0), e13(is_even ? step : 0.0), e13(0.0));
  text += axis_record(kTime, 0, "Time", "s") + axis_record(kDisplacement, 1, "Displacement", "mm");
  text += axis_record(0, 0, "NONE", "NONE") + axis_record(0, 0, "NONE", "NONE");
  return text + data_lines(stretch, is_even) + kMark;
}

// Returns the unbroken stretches of one axis of a target. A missing sample or frame ends a stretch.
std::vector<Readings> stretches_of(const RunTable& table, const Place& place, long frame_step) {
  std::vector<Readings> found(1);
  long last = -1;
  for (const Sample& sample : table.samples) {
    if (sample.marker != place.marker) continue;
    const double value = place.axis == 0 ? sample.displacement.x : sample.displacement.y;
    if (std::isnan(value)) continue;
    if (last >= 0 && sample.frame - last != frame_step) found.emplace_back();
    found.back().push_back({sample.time_s, value});
    last = sample.frame;
  }
  return found.back().empty() ? std::vector<Readings>{} : found;
}

// Returns the distance of selected frames: `measure --frames A:B:STEP`.
long frame_step_of(const RunTable& table) {
  long step = 0, last = -1;
  for (const Sample& sample : table.samples) {
    if (last >= 0 && sample.frame > last) step = step == 0 ? sample.frame - last : std::min(step, sample.frame - last);
    last = sample.frame;
  }
  return std::max(step, 1L);
}

std::string gap_text(const RunTable& table, const Place& place, const std::vector<Readings>& stretches, long rows) {
  std::size_t there = 0;
  for (const Readings& stretch : stretches) there += stretch.size();
  return fmt::format(
      "the samples have gaps, which UFF 58 cannot hold: {} {} ({} of {} samples in {} stretches): give --gaps split, "
      "or a --time without gaps",
      table.markers[place.marker].name, place.axis == 0 ? "dx" : "dy", there, rows, stretches.size());
}

// Complex amplitude of one axis of a target at each peak. Returns nothing if it takes part in none.
std::string dataset_of_modes(const RunTable& table, const Place& place, const std::vector<ModeShape>& shapes) {
  constexpr int kSpectrum = 12, kComplexDouble = 6, kUneven58 = 0, kFrequency = 18, kDisplacement = 8;
  std::string lines;
  std::size_t count = 0;
  for (const ModeShape& shape : shapes) {
    for (const ModeEntry& entry : shape.entries) {
      if (entry.target != place.marker || (entry.axis == BoardAxis::kX ? 0 : 1) != place.axis) continue;
      const double amplitude = shape.peak.amplitude_mm;
      lines += e13(shape.peak.frequency_hz) + e20(amplitude * entry.real) + e20(amplitude * entry.imaginary) + "\n";
      ++count;
    }
  }
  if (count == 0) return {};
  std::string text =
      head_of_dataset(table, fmt::format("{} {}: mode shapes, phase to each peak's strongest axis",
                                         table.markers[place.marker].name, place.axis == 0 ? "dx" : "dy"));
  text += fmt::format("{:>5}{:>10}{:>5}{:>10} {:<10}{:>10}{:>4} {:<10}{:>10}{:>4}\n", kSpectrum, place.function, 1, 0,
                      "NONE", place.marker + 1, place.axis + 1, "NONE", 0, 0);
  text += fmt::format("{:>10}{:>10}{:>10}{}{}{}\n", kComplexDouble, count, kUneven58, e13(0.0), e13(0.0), e13(0.0));
  text += axis_record(kFrequency, 0, "Frequency", "Hz") + axis_record(kDisplacement, 1, "Displacement", "mm");
  text += axis_record(0, 0, "NONE", "NONE") + axis_record(0, 0, "NONE", "NONE");
  return text + lines + kMark;
}

}  // namespace

std::string uff58_of_modes(const RunTable& table, const std::vector<ModeShape>& shapes) {
  std::string text = units_dataset() + nodes_dataset(table);
  int function = 0;
  for (std::size_t marker = 0; marker < table.markers.size(); ++marker) {
    for (int axis = 0; axis < 2; ++axis) text += dataset_of_modes(table, {marker, axis, ++function}, shapes);
  }
  return text;
}

tl::expected<std::string, std::string> uff58(const RunTable& table, Gaps gaps) {
  for (const Sample& sample : table.samples) {
    if (std::isnan(sample.time_s))
      return tl::unexpected(std::string("the run has no times: --format uff58: measure the input again with --fps"));
  }
  const long frame_step = frame_step_of(table);
  std::string text = units_dataset() + nodes_dataset(table);
  int function = 0;
  bool has_any = false;
  for (std::size_t marker = 0; marker < table.markers.size(); ++marker) {
    for (int axis = 0; axis < 2; ++axis) {
      const Place place{marker, axis, ++function};
      const auto stretches = stretches_of(table, place, frame_step);
      const auto rows = std::count_if(table.samples.begin(), table.samples.end(),
                                      [&](const Sample& s) { return s.marker == marker; });
      if (stretches.empty()) continue;
      has_any = true;
      const bool is_whole = stretches.size() == 1 && stretches.front().size() == static_cast<std::size_t>(rows);
      if (!is_whole && gaps == Gaps::kRefuse) return tl::unexpected(gap_text(table, place, stretches, rows));
      for (std::size_t k = 0; k < stretches.size(); ++k) text += dataset(table, place, stretches[k], k + 1);
    }
  }
  if (!has_any)
    return tl::unexpected(
        std::string("no sample has numbers: --format uff58: choose a wider range with --time or --markers"));
  return text;
}

}  // namespace moiregauge::internal

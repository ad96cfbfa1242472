// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/summary_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/rounded_text.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/io/run_dir/run_json.h"
#include "moiregauge/observation/reference/scale_check.h"
#include "moiregauge/report/report_text.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::size_t kIndent = 8;  // width of "result: "

// Four points fit any homography, and a pose fits most movements of one of them: the check requires more.
std::string check_of(const Measurement& m) {
  if (m.references_verified) return "";
  return m.reference->circles.size() <= 4 ? "; references not cross-checked: this needs 6 references (5 with --camera)"
                                          : "; references not cross-checked";
}

// A wrong pitch shows nowhere else.
std::string scale_of_run(const Reference& reference) {
  const ScaleCheck check = scale_check(reference);
  return fmt::format("scale {:.3g} mm/px, {} (check with a tape)", check.mm_per_px,
                     tape_text(check, reference.site, 1.0, "mm"));
}

std::string found_line(const Measurement& m, const MeasureOptions& options) {
  if (!m.reference) {
    const std::size_t frames = m.observations.size();
    return frames > 0 ? fmt::format("found: no usable reference frame in {} frame{}", frames, frames == 1 ? "" : "s")
                      : "found: no usable reference frame";
  }
  const auto references = m.reference->circles.size();
  std::string targets;
  for (const TargetSummary& t : m.targets)
    targets += fmt::format("{}{}", targets.empty() ? "" : ", ", site_of(m, options).markers[t.marker].name);
  return fmt::format("found: {} references and {} ({}) in {} frames of {} x {} px; reference frame {}, method {}; {}{}",
                     references, m.targets.size() == 1 ? "1 target" : fmt::format("{} targets", m.targets.size()),
                     targets, m.observations.size(), m.input.width, m.input.height, m.reference->seen.frame,
                     options.method->name, scale_of_run(*m.reference), check_of(m));
}

using TableRow = std::vector<std::string>;

// Peak to peak, rms and U of one axis, with two significant digits of U.
void add_axis(TableRow& row, double peak_to_peak, double rms, double u) {
  const double expanded = kCoverageFactor * u;
  if (std::isnan(peak_to_peak) || std::isnan(expanded)) {
    row.insert(row.end(), 3, "-");
    return;
  }
  const int digits = decimals_for(expanded);
  for (const double value : {peak_to_peak, rms, expanded}) row.push_back(fmt::format("{:.{}f}", value, digits));
}

// The first column is aligned to the left, the others to the right.
std::string aligned(const std::vector<TableRow>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const TableRow& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string text;
  for (const TableRow& row : rows) {
    text += fmt::format("\n{:{}}{:<{}}", "", kIndent, row.front(), widths.front());
    for (std::size_t k = 1; k < row.size(); ++k) text += fmt::format("   {:>{}}", row[k], widths[k]);
  }
  return text;
}

// Explains the rows of a target that are not `ok`.
std::string statuses_text(const Measurement& m, const MeasureOptions& options, const TargetSummary& target) {
  std::map<Status, long> counts;
  for (const Sample& sample : m.samples) {
    if (sample.marker == target.marker && sample.status != Status::kOk) ++counts[sample.status];
  }
  std::string text;
  for (const auto& [status, count] : counts)
    text += fmt::format("\n{:{}}{}: {} row{} {} ({})", "", kIndent, site_of(m, options).markers[target.marker].name,
                        count, count == 1 ? "" : "s", word_for(status), words_of(status).meaning);
  return text;
}

// One row per target, the largest movement first.
std::string result_text(const Measurement& m, const MeasureOptions& options) {
  if (m.targets.empty()) return "result: none";
  std::string statuses;
  std::vector<TableRow> rows{{"target", "dx: peak to peak", "rms", "U", "dy: peak to peak", "rms", "U", "rows ok"}};
  for (const std::size_t k : by_movement(m.targets)) {
    const TargetSummary& t = m.targets[k];
    TableRow row{site_of(m, options).markers[t.marker].name};
    add_axis(row, t.peak_to_peak().x, t.rms.x, t.u.x);
    add_axis(row, t.peak_to_peak().y, t.rms.y, t.u.y);
    row.push_back(fmt::format("{} of {}", t.ok, t.frames));
    rows.push_back(std::move(row));
    statuses += statuses_text(m, options, t);
  }
  // A refused run has no trustworthy values, so none are printed.
  if (m.exit == Exit::kRefused) return "result: none, no row is reliable" + statuses;
  return fmt::format("result: displacement in mm, U with k = {:g}", kCoverageFactor) + aligned(rows) + statuses;
}

std::string next_line(const Measurement& m, const MeasureOptions& options, const std::string& output) {
  if (!m.reference)
    return fmt::format(
        "next: look at {}/overlay.png, which shows what was found, and correct the site file or the view", output);
  if (!m.remedy.empty()) return "next: " + m.remedy;
  const auto has = [&](Status status) {
    return std::any_of(m.samples.begin(), m.samples.end(), [&](const Sample& s) { return s.status == status; });
  };
  if (has(Status::kCameraMoved)) return "next: measure with --method two-stage, because the camera moved";
  if (has(Status::kUntrusted) && m.scene)
    return fmt::format(
        "next: see the warnings and {}/report.html, which shows the frames in which the references do "
        "not fit one rigid scene",
        output);
  if (has(Status::kUntrusted) && options.camera)
    return "next: check the file of --camera, or measure with --method precise, because four points do not fit this "
           "view";
  if (has(Status::kUntrusted))
    return "next: give --camera FILE with the calibrated lens, because four points do not fit this view (lens or "
           "depth)";
  if (m.exit == Exit::kIncomplete)
    return fmt::format("next: look for the rows that are not ok in {}/displacement.csv", output);
  return fmt::format("next: open {0}/report.html in a browser; {0}/displacement.csv holds every sample", output);
}

}  // namespace

std::string summary_text(const Measurement& measurement, const MeasureOptions& options, const std::string& output) {
  return found_line(measurement, options) + "\n" + result_text(measurement, options) + "\n" +
         next_line(measurement, options, output) + "\n";
}

int report(const Measurement& measurement, const MeasureOptions& options, const ReportArgs& args) {
  if (args.json) {
    print_out(fmt::format(
        "{}\n", run_json(measurement, options).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)));
  } else if (!args.quiet) {
    print_out(summary_text(measurement, options, args.output));
  }
  for (const std::string& warning : measurement.warnings) {
    const bool is_note = warning.starts_with("note: ");
    if (!args.quiet) print_note(fmt::format("{}{}\n", is_note ? "" : "warning: ", warning));
  }
  if (measurement.exit == Exit::kRefused)
    return fail(
        Exit::kRefused,
        fmt::format("the run is refused because {}: {}: {}",
                    measurement.refusal.empty() ? "no row is ok" : measurement.refusal, args.input,
                    measurement.remedy.empty() ? fmt::format("see {}/overlay.png", args.output) : measurement.remedy));
  return static_cast<int>(measurement.exit);
}

int fail_output(const OutputError& error) {
  return fail(error.usage ? Exit::kUsage : Exit::kOutputUnwritable, error.message);
}

}  // namespace moiregauge::internal::cli

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/summary_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/io/run_dir/run_json.h"
#include "moiregauge/observation/reference/scale_check.h"

namespace moiregauge::internal::cli {
namespace {

// Four points fit any homography, and a pose most of what one of them may do: that none moved is not proved.
std::string check_of(const Measurement& m) {
  if (m.references_verified) return "";
  return m.reference->circles.size() <= 4 ? "; references not verified: that none moves takes six to prove"
                                          : "; references not verified";
}

// A wrong pitch shows in nothing else.
std::string scale_of_run(const Reference& reference) {
  const ScaleCheck check = scale_check(reference);
  return fmt::format("scale {:.3g} mm/px, {} (check with a tape)", check.mm_per_px,
                     tape_text(check, reference.site, 1.0, "mm"));
}

std::string found_line(const Measurement& m, const MeasureOptions& options) {
  if (!m.reference) return fmt::format("found: {}", m.refusal);
  const auto references = m.reference->circles.size();
  std::string targets;
  for (const TargetSummary& t : m.targets)
    targets += fmt::format("{}{}", targets.empty() ? "" : ", ", site_of(m, options).markers[t.marker].name);
  return fmt::format("found: {} references and {} ({}) in {} frames of {} x {} px; reference frame {}, method {}; {}{}",
                     references, m.targets.size() == 1 ? "1 target" : fmt::format("{} targets", m.targets.size()),
                     targets, m.observations.size(), m.input.width, m.input.height, m.reference->seen.frame,
                     options.method->name, scale_of_run(*m.reference), check_of(m));
}

// Expanded uncertainty, k = 2, with as many digits of the result as it deserves.
std::string axis(const char* name, double lowest, double highest, double last, double u) {
  if (std::isnan(last) || std::isnan(u)) return fmt::format("{} not measured", name);
  const double expanded = 2.0 * u;
  const int digits = std::clamp(1 - static_cast<int>(std::floor(std::log10(std::max(expanded, 1e-6)))), 1, 6);
  return fmt::format("{} {:+.{}f} mm (range {:+.{}f} to {:+.{}f}), U = {:.{}f} mm (k = 2)", name, last, digits, lowest,
                     digits, highest, digits, expanded, digits);
}

std::string result_line(const Measurement& m, const MeasureOptions& options) {
  std::string text;
  for (const TargetSummary& t : m.targets) {
    std::string counts;
    for (const auto& [word, count] : t.status_counts)
      counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, word);
    // Of a refused run no number is stood by, and so none is told.
    const std::string result = m.exit == Exit::kRefused
                                   ? "no row to rely on"
                                   : fmt::format("last {}; {}", axis("dx", t.lowest.x, t.highest.x, t.last.x, t.u.x),
                                                 axis("dy", t.lowest.y, t.highest.y, t.last.y, t.u.y));
    text += fmt::format("{}{}: {}; rows: {}", text.empty() ? "result: " : "\n        ",
                        site_of(m, options).markers[t.marker].name, result, counts);
  }
  return text.empty() ? "result: none" : text;
}

std::string next_after_measure(const Measurement& m, const MeasureOptions& options, const std::string& output) {
  if (!m.reference)
    return fmt::format("next: look at {}/overlay.png: it shows what was seen; correct the site file or the view",
                       output);
  if (!m.remedy.empty()) return "next: " + m.remedy;
  const bool untrusted =
      std::any_of(m.samples.begin(), m.samples.end(), [](const Sample& s) { return s.status == Status::kUntrusted; });
  const bool moved =
      std::any_of(m.samples.begin(), m.samples.end(), [](const Sample& s) { return s.status == Status::kCameraMoved; });
  if (moved) return "next: the camera moved, which `conventional` cannot take out: measure with --method two-stage";
  if (untrusted && m.scene)
    return fmt::format(
        "next: the references do not fit one rigid scene: {}/report.html shows from which frame on, the warnings "
        "what is known of it",
        output);
  if (untrusted && options.camera)
    return "next: the references show that four points do not absorb this view although --camera is given: check that "
           "file, or measure with --method precise";
  if (untrusted)
    return "next: the references show that four points do not absorb this view (lens or depth): give --camera FILE "
           "with the lens's calibration";
  if (m.exit == Exit::kIncomplete)
    return fmt::format("next: look for the rows that are not ok in {}/displacement.csv", output);
  return fmt::format("next: open {0}/report.html in a browser; {0}/displacement.csv holds every sample", output);
}

}  // namespace

std::string summary_text(const Measurement& measurement, const MeasureOptions& options, const std::string& output) {
  return found_line(measurement, options) + "\n" + result_line(measurement, options) + "\n" +
         next_after_measure(measurement, options, output) + "\n";
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
    return fail(Exit::kRefused, fmt::format("refused: {}: {}: {}", args.input, measurement.refusal,
                                            measurement.remedy.empty() ? fmt::format("see {}/overlay.png", args.output)
                                                                       : measurement.remedy));
  return static_cast<int>(measurement.exit);
}

int fail_output(const OutputError& error) {
  return fail(error.usage ? Exit::kUsage : Exit::kOutputUnwritable, error.message);
}

}  // namespace moiregauge::internal::cli

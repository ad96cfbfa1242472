// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/comparison/compare_run.h"

#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/app/derive_run.h"
#include "moiregauge/base/length_text.h"
#include "moiregauge/drawing/figures/figure_comparison.h"
#include "moiregauge/io/run_dir/file_set.h"
#include "moiregauge/io/tables/time_cell.h"

namespace moiregauge::internal {
namespace {

constexpr const char* kMillimetre = "mm";

tl::unexpected<RunFailure> cannot_compare(Exit exit, std::string message) {
  return tl::unexpected(RunFailure{exit, std::move(message)});
}

tl::expected<void, RunFailure> check_compare_args(const CompareArgs& args) {
  const auto wrong = [](const std::string& message) { return cannot_compare(Exit::kUsage, message); };
  if (args.rate_hz && !(*args.rate_hz > 0.0 && std::isfinite(*args.rate_hz)))
    return wrong(fmt::format("the rate is not positive: --rate {}: give it in Hz, e.g. --rate 100", *args.rate_hz));
  if (args.rate_hz && !(args.time_column.empty() && args.time_unit.empty()))
    return wrong("--rate excludes --time-column and --time-unit: compare: give one of them");
  if (!args.time_unit.empty() && !seconds_of_unit(args.time_unit))
    return wrong(fmt::format("the unit is unknown: --time-unit {}: use s, ms, us, min or h", args.time_unit));
  if (args.scale && !(*args.scale != 0.0 && std::isfinite(*args.scale)))
    return wrong(fmt::format("the factor is zero or infinite: --scale {}: give another factor", *args.scale));
  if (args.sign != 1 && args.sign != -1)
    return wrong(fmt::format("the sign is neither 1 nor -1: --sign {}: give --sign -1, or --scale", args.sign));
  if (args.offset_s && !std::isfinite(*args.offset_s))
    return wrong("the offset is not finite: --offset: give it in seconds");
  return {};
}

// Returns the factor from the values of the file to the channel's unit.
tl::expected<double, RunFailure> reference_factor(const CompareArgs& args, const Channel& channel) {
  const double factor = args.sign * args.scale.value_or(1.0);
  if (args.unit.empty()) return factor;
  if (channel.unit != kMillimetre)
    return cannot_compare(Exit::kUsage,
                          fmt::format("the channel is in {}, not in mm: --unit {}: convert the reference with --scale",
                                      channel.unit, args.unit));
  const auto unit_mm = length_mm("1" + args.unit);
  if (!unit_mm)
    return cannot_compare(Exit::kUsage,
                          fmt::format("the unit is unknown: --unit {}: use mm, cm, m, um or in", args.unit));
  return factor * *unit_mm;
}

tl::expected<ReferenceRecord, RunFailure> reference_of(const CompareArgs& args) {
  ReferenceColumns columns;
  columns.rate_hz = args.rate_hz;
  if (!args.time_column.empty()) columns.time = args.time_column;
  columns.time_unit = args.time_unit;
  columns.value = !args.column.empty() ? args.column : args.rate_hz ? "1" : "2";
  auto record = read_reference_csv(args.reference, columns);
  if (record) return *std::move(record);
  return cannot_compare(record.error().is_usage ? Exit::kUsage : Exit::kInputUnreadable, record.error().message);
}

std::vector<NamedBytes> files_of_comparison(const ComparedRun& run) {
  std::vector<NamedBytes> files{{"comparison.csv", comparison_csv(run.comparison)},
                                {"comparison.json", comparison_json(run.comparison, run.origin)}};
  for (const auto& [name, figure] : figure::comparison_figures(run.comparison, run.origin.channel, run.origin.unit)) {
    figure::FigureFiles drawn = files_of(figure);
    files.emplace_back(name + ".svg", std::move(drawn.svg));
    files.emplace_back(name + ".png", std::move(drawn.png));
  }
  return files;
}

}  // namespace

tl::expected<ComparedRun, RunFailure> run_compare(const CompareArgs& args, const RunCallbacks& callbacks) {
  if (const auto checked = check_compare_args(args); !checked) return tl::unexpected(checked.error());
  auto reference = reference_of(args);
  if (!reference) return tl::unexpected(reference.error());
  const bool is_named = args.channel.find('=') != std::string::npos;
  const auto run = run_channels(args.solve, {is_named ? args.channel : "channel = " + args.channel}, callbacks);
  if (!run) return tl::unexpected(run.error());
  const Channel& channel = run->channels.front();
  const auto factor = reference_factor(args, channel);
  if (!factor) return tl::unexpected(factor.error());
  for (double& value : reference->series.value) value *= *factor;
  auto comparison = compare_records(run->series.front(), reference->series, args.offset_s);
  if (!comparison)
    return cannot_compare(Exit::kInputUnreadable, fmt::format("{}: {}: {}", comparison.error().what, args.reference,
                                                              comparison.error().remedy));
  if (!reference->time_unit.empty())
    comparison->warnings.push_back(fmt::format(
        "note: times of the reference are in {}, as its header says. --time-unit sets another", reference->time_unit));
  ComparedRun out{
      *std::move(comparison), {args.solve.run, args.reference, channel.text, channel.unit, *factor}, "", "", run->exit};
  out.folder = args.output.empty() ? (std::filesystem::path(args.solve.run) / "comparison").string() : args.output;
  if (const auto written = write_file_set(out.folder, files_of_comparison(out), Existing::kReplace); !written)
    return tl::unexpected(failure_of(written.error()));
  if (!args.output.empty()) return out;
  auto report =
      shown_in_report(args.solve.run, comparison_script(out.comparison, comparison_json(out.comparison, out.origin)),
                      out.comparison.warnings);
  if (!report) return tl::unexpected(report.error());
  out.report = *std::move(report);
  return out;
}

}  // namespace moiregauge::internal

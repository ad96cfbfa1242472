// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/derive_run.h"
#include "moiregauge/app/solve_run.h"
#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/plain_file.h"
#include "moiregauge/library/convert.h"

namespace moiregauge {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> failure(const internal::RunFailure& failed) {
  return internal::public_error(failed.exit, failed.message);
}

// Returns a range as the command line reads it. Shortest decimals keep every bit.
std::string range_text(const std::optional<FrameRange>& range, bool is_kept) {
  if (!is_kept) return "none";
  if (!range) return {};
  if (!range->time)
    return fmt::format("{}:{}", range->first, range->end < 0 ? std::string{} : std::to_string(range->end));
  const double end_s = range->time->end.value();
  return fmt::format("{}s:{}", range->time->first.value(),
                     std::isinf(end_s) ? std::string{} : fmt::format("{}s", end_s));
}

Expected<internal::SolveArgs> args_of(const std::string& run, const SolveOptions& options) {
  if ((options.site && !options.site_file.empty()) || (options.camera && !options.camera_file.empty()))
    return internal::public_error(
        internal::Exit::kUsage,
        "site and site_file, or camera and camera_file, exclude each other: SolveOptions: set "
        "one of them");
  internal::SolveArgs args;
  args.run = run;
  args.site = options.site_file;
  args.camera = options.camera_file;
  if (options.site) {
    auto site = internal::to_internal(*options.site);
    if (!site) return tl::unexpected(site.error());
    args.stated_site = *std::move(site);
  }
  if (options.camera) args.stated_camera = internal::to_internal(*options.camera);
  args.method = options.method;
  args.rest = range_text(options.rest, options.has_rest);
  args.zero = range_text(options.zero, options.has_zero);
  args.fps = options.fps;
  if (options.readout) args.readout = fmt::format("{}s", options.readout->value());
  args.output = options.output;
  return args;
}

DerivedChannel to_channel(const internal::DerivedColumn& column, const internal::ChannelStatistics& statistics) {
  DerivedChannel out;
  out.name = column.name;
  out.unit = column.unit;
  out.expression = column.expression;
  out.value = column.value;
  out.u = column.u;
  for (const internal::Status status : column.status) out.status.push_back(internal::public_status(status));
  out.mean = statistics.mean.value, out.u_mean = statistics.mean.u;
  out.rms = statistics.rms.value, out.u_rms = statistics.rms.u;
  out.peak_to_peak = statistics.peak_to_peak.value, out.u_peak_to_peak = statistics.peak_to_peak.u;
  return out;
}

}  // namespace

Expected<Result> read_run(const std::string& run, const SolveOptions& known) {
  const auto args = args_of(run, known);
  if (!args) return tl::unexpected(args.error());
  const auto solved = internal::solve_in_memory(*args, internal::RunBase::kResults);
  if (!solved) return failure(solved.error());
  const internal::Measurement& measured = solved->measurement;
  if (measured.exit != internal::Exit::kRefused) {
    const auto checked = internal::check_results(run, internal::site_of(measured, solved->options), measured.samples);
    if (!checked) return failure(checked.error());
  }
  Result result = internal::to_result(measured, solved->options);
  result.folder = run;
  return result;
}

Expected<Result> solve(const std::string& run, const SolveOptions& options) {
  const auto args = args_of(run, options);
  if (!args) return tl::unexpected(args.error());
  const auto solved = options.output.empty() ? internal::solve_in_memory(*args, internal::RunBase::kMeasured)
                                             : internal::run_solve(*args, {});
  if (!solved) return failure(solved.error());
  Result result = internal::to_result(solved->measurement, solved->options);
  result.folder = solved->folder;
  return result;
}

Expected<DerivedChannels> derive(const std::string& run, const DeriveOptions& options) {
  auto solve_args = args_of(run, options.solved);
  if (!solve_args) return tl::unexpected(solve_args.error());
  internal::DeriveArgs args;
  args.solve = *std::move(solve_args);
  args.solve.output.clear();
  args.channels = options.channels;
  args.layers = options.layers;
  args.output = options.output;
  args.is_in_memory = options.output.empty();
  const auto derived = internal::run_derive(args, {});
  if (!derived) return failure(derived.error());
  DerivedChannels out;
  out.frame = derived->table.frame;
  out.time_s = derived->table.time_s;
  out.warnings = derived->warnings;
  for (std::size_t i = 0; i < derived->table.columns.size(); ++i)
    out.channels.push_back(to_channel(derived->table.columns[i], derived->statistics[i]));
  return out;
}

Expected<void> write_report(const std::string& run, const std::string& file) {
  const std::string report = (fs::path(run) / "report.html").string();
  std::error_code error;
  if (!fs::exists(report, error) || !internal::kind_unless_plain(report).empty())
    return internal::public_error(
        internal::Exit::kInputUnreadable,
        fmt::format("the run has no report: {} does not exist: write the results with `moiregauge solve {}`", report,
                    run));
  std::ifstream page(report, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(page), std::istreambuf_iterator<char>()};
  if (const auto written = internal::write_file_atomically(file, bytes); !written)
    return internal::public_error(
        internal::Exit::kOutputUnwritable,
        fmt::format("the report could not be written: {}: free space or choose another file", written.error()));
  return {};
}

}  // namespace moiregauge

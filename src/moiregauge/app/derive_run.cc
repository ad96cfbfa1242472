// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/derive_run.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/tables/derived_csv.h"
#include "moiregauge/io/tables/displacement_csv.h"
#include "moiregauge/results/derived/channel_parser.h"
#include "moiregauge/results/derived/channel_values.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxChannels = 64;

tl::unexpected<RunFailure> cannot_derive(Exit exit, std::string message) {
  return tl::unexpected(RunFailure{exit, std::move(message)});
}

// A run solved again, with its joint errors.
struct JointRun {
  Measurement measurement;
  MeasureOptions options;
  JointErrors joint;
};

// displacement.csv must hold the samples that the channels are computed from.
tl::expected<void, RunFailure> check_results(const std::string& folder, const JointRun& run) {
  const std::string path = (fs::path(folder) / "displacement.csv").string();
  std::error_code error;
  if (!fs::exists(path, error) || !kind_unless_plain(path).empty())
    return cannot_derive(Exit::kInputUnreadable,
                         fmt::format("the run has no results: {} does not exist: finish it with measure --resume, or "
                                     "give a folder that `measure` wrote",
                                     path));
  std::ifstream file(path, std::ios::binary);
  const std::string written{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (written == displacement_csv(site_of(run.measurement, run.options), run.measurement.samples)) return {};
  return cannot_derive(Exit::kUsage,
                       fmt::format("the results have other values than the observations give: {}: repeat here the "
                                   "options of `solve`, or run `moiregauge solve` again",
                                   path));
}

tl::expected<JointRun, RunFailure> joint_run(const SolveArgs& args, const RunCallbacks& callbacks) {
  auto stored = run_to_solve(args);
  if (!stored) return tl::unexpected(stored.error());
  JointRun run{{}, std::move(stored->options), {}};
  static_cast<ObservationLog&>(run.measurement) = std::move(stored->seen);
  const long frames = static_cast<long>(run.measurement.observations.size());
  (void)callbacks.may_continue({Stage::kSolving, frames, frames, std::nullopt});
  evaluate(run.options, run.measurement, &run.joint);
  if (!run.measurement.contradiction.empty())
    return cannot_derive(Exit::kUsage, run.measurement.contradiction + ": give other frames, or --rest none");
  if (!run.measurement.reference || run.measurement.exit == Exit::kRefused)
    return cannot_derive(Exit::kRefused, fmt::format("the run has no reliable values: {} ({}): measure it again",
                                                     args.run, run.measurement.refusal));
  if (auto checked = check_results(args.run, run); !checked) return tl::unexpected(checked.error());
  if (run.joint.problem.empty()) return run;
  return cannot_derive(Exit::kUsage,
                       fmt::format("no uncertainty can be derived: {} ({}): measure with --method precise", args.run,
                                   run.joint.problem));
}

std::vector<std::string> target_names(const JointRun& run) {
  std::vector<std::string> names;
  for (const std::size_t i : run.joint.targets) names.push_back(site_of(run.measurement, run.options).markers[i].name);
  return names;
}

tl::expected<std::vector<Channel>, RunFailure> channels_of(const DeriveArgs& args, const JointRun& run) {
  if (args.channels.empty())
    return cannot_derive(Exit::kUsage,
                         fmt::format("no channel is given: {}: add --channel 'NAME = EXPRESSION'", args.solve.run));
  if (args.channels.size() > kMaxChannels)
    return cannot_derive(Exit::kUsage, fmt::format("there are {} channels, more than {}: --channel: run the command "
                                                   "twice, with another -o",
                                                   args.channels.size(), kMaxChannels));
  const auto names = target_names(run);
  std::vector<Channel> channels;
  for (const std::string& text : args.channels) {
    auto channel = parse_channel(text, names, channels);
    if (!channel)
      return cannot_derive(Exit::kUsage,
                           fmt::format("{}: --channel '{}', column {}: {}", channel.error().what, text.substr(0, 200),
                                       channel.error().column, channel.error().remedy));
    channels.push_back(*std::move(channel));
  }
  return channels;
}

DerivedColumn column_of(const Channel& channel, const ChannelSeries& series) {
  DerivedColumn column{channel.name, channel.unit, channel.text, {}, {}, series.status};
  for (Eigen::Index n = 0; n < series.size(); ++n) {
    column.value.push_back(series.value(n));
    column.u.push_back(std::isnan(series.value(n)) ? kNotMeasured : series.u(n));
  }
  return column;
}

Exit exit_of_table(const DerivedTable& table, Exit run) {
  std::size_t rows = 0, not_ok = 0;
  for (const DerivedColumn& column : table.columns) {
    for (const Status status : column.status) ++rows, not_ok += status != Status::kOk;
  }
  const bool is_incomplete = static_cast<double>(not_ok) > kNotOkShare * static_cast<double>(rows);
  return is_incomplete ? Exit::kIncomplete : run;
}

}  // namespace

tl::expected<DerivedResults, RunFailure> run_derive(const DeriveArgs& args, const RunCallbacks& callbacks) {
  const auto run = joint_run(args.solve, callbacks);
  if (!run) return tl::unexpected(run.error());
  const auto channels = channels_of(args, *run);
  if (!channels) return tl::unexpected(channels.error());
  DerivedResults out;
  for (const Channel& channel : *channels) {
    const auto series = channel_values(channel, run->measurement.samples, run->joint);
    if (!series)
      return cannot_derive(Exit::kUsage, fmt::format("the channel {} has no value: {}: name other targets",
                                                     channel.name, series.error()));
    out.table.frame = series->frame;
    out.table.time_s = series->time_s;
    out.table.columns.push_back(column_of(channel, *series));
  }
  out.exit = exit_of_table(out.table, run->measurement.exit);
  out.file = args.output.empty() ? (fs::path(args.solve.run) / "derived.csv").string() : args.output;
  if (const auto written = write_file_atomically(out.file, derived_csv(out.table)); !written)
    return cannot_derive(
        Exit::kOutputUnwritable,
        fmt::format("the file could not be written: {}: free space or choose another with -o", written.error()));
  return out;
}

}  // namespace moiregauge::internal

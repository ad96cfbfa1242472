// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/derive_run.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/frame_range_text.h"
#include "moiregauge/base/atomic_file.h"
#include "moiregauge/io/tables/derived_csv.h"
#include "moiregauge/io/tables/derived_json.h"
#include "moiregauge/io/tables/mode_files.h"
#include "moiregauge/io/tables/run_table.h"
#include "moiregauge/io/tables/uff58.h"
#include "moiregauge/results/derived/channel_parser.h"
#include "moiregauge/results/derived/channel_values.h"
#include "moiregauge/results/derived/layer_choices.h"
#include "moiregauge/results/derived/layers.h"
#include "moiregauge/results/derived/site_channels.h"
#include "moiregauge/results/derived/zeroed_samples.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

tl::unexpected<RunFailure> cannot_derive(Exit exit, std::string message) {
  return tl::unexpected(RunFailure{exit, std::move(message)});
}

// A run solved again without its zero, with its joint errors.
struct JointRun {
  Measurement measurement;
  MeasureOptions options;
  JointErrors joint;
  std::optional<FrameRange> zero;  // that of the run
};

// Returns the samples with the run's zero.
Samples samples_of_results(const JointRun& run) {
  Samples samples = run.measurement.samples;
  const auto zero = run.zero ? in_frames(*run.zero, run.measurement.observations) : std::nullopt;
  if (zero) (void)subtract_zero(run.joint, *zero, samples);  // a wrong zero gives other samples than the results
  return samples;
}

tl::expected<JointRun, RunFailure> joint_run(const SolveArgs& args, const RunCallbacks& callbacks) {
  auto stored = run_to_solve(args, RunBase::kResults);
  if (!stored) return tl::unexpected(stored.error());
  JointRun run{{}, std::move(stored->options), {}, {}};
  run.zero = std::exchange(run.options.zero, std::nullopt);
  static_cast<ObservationLog&>(run.measurement) = std::move(stored->seen);
  const long frames = static_cast<long>(run.measurement.observations.size());
  (void)callbacks.may_continue({Stage::kSolving, frames, frames, std::nullopt});
  evaluate(run.options, run.measurement, &run.joint);
  if (!run.measurement.contradiction.empty())
    return cannot_derive(Exit::kUsage, run.measurement.contradiction + ": give other frames, or --rest none");
  if (!run.measurement.reference || run.measurement.exit == Exit::kRefused)
    return cannot_derive(Exit::kRefused, fmt::format("the run has no reliable values: {} ({}): measure it again",
                                                     args.run, run.measurement.refusal));
  // displacement.csv must contain the samples that the channels are computed from.
  if (auto checked = check_results(args.run, site_of(run.measurement, run.options), samples_of_results(run)); !checked)
    return tl::unexpected(checked.error());
  return run;
}

std::vector<std::string> names_of_targets(const JointRun& run) {
  std::vector<std::string> names;
  for (const std::size_t i : run.joint.targets) names.push_back(site_of(run.measurement, run.options).markers[i].name);
  return names;
}

// Returns the channels of the site file, with a note on each that the run's targets do not allow.
tl::expected<std::vector<Channel>, RunFailure> channels_of_site(const DeriveArgs& args, const JointRun& run,
                                                                std::vector<std::string>& notes) {
  SiteChannels read = read_site_channels(run.options.channels, names_of_targets(run));
  for (const std::string& omitted : read.omitted)
    notes.push_back(fmt::format("note: a channel of the site file is omitted: {}", omitted));
  if (!read.channels.empty() || args.has_modes) return std::move(read.channels);
  return cannot_derive(Exit::kUsage, fmt::format("no channel is given: {}: add --channel 'NAME = EXPRESSION', or "
                                                 "[[channel]] to the site file",
                                                 args.solve.run));
}

// Returns the channels of the site file that typed ones may name. A typed one of the same name replaces it.
std::vector<Channel> channels_to_name(const std::vector<std::string>& texts, const JointRun& run) {
  std::vector<Channel> known = read_site_channels(run.options.channels, names_of_targets(run)).channels;
  std::erase_if(known, [&](const Channel& channel) {
    return std::any_of(texts.begin(), texts.end(),
                       [&](const std::string& text) { return name_in_channel(text) == channel.name; });
  });
  return known;
}

tl::expected<std::vector<Channel>, RunFailure> channels_of(const std::vector<std::string>& texts, const JointRun& run) {
  if (texts.size() > kMaxChannels)
    return cannot_derive(Exit::kUsage, fmt::format("there are {} channels, more than {}: --channel: run the command "
                                                   "twice, with another -o",
                                                   texts.size(), kMaxChannels));
  const auto names = names_of_targets(run);
  std::vector<Channel> channels = channels_to_name(texts, run);
  const auto known = static_cast<std::ptrdiff_t>(channels.size());
  for (const std::string& text : texts) {
    auto channel = parse_channel(text, names, channels);
    if (!channel)
      return cannot_derive(Exit::kUsage,
                           fmt::format("{}: --channel '{}', column {}: {}", channel.error().what, text.substr(0, 200),
                                       channel.error().column, channel.error().remedy));
    channels.push_back(*std::move(channel));
  }
  channels.erase(channels.begin(), channels.begin() + known);
  return channels;
}

// The run's own zero is the first layer.
tl::expected<std::vector<Layer>, RunFailure> layers_of(const DeriveArgs& args, const JointRun& run) {
  std::vector<Layer> layers;
  if (run.zero) layers.push_back({ZeroLayer{*run.zero}, "zero of the run"});
  for (const auto& [option, value] : args.layers) {
    if (option == "detrend") {
      layers.push_back({DetrendLayer{}, option});
    } else if (option == "zero") {
      const auto zero = frame_range_in(value, kZeroOption);
      if (!zero) return cannot_derive(Exit::kUsage, zero.error().message);
      layers.push_back({ZeroLayer{*zero}, fmt::format("{} {}", option, value)});
    } else {
      auto layer = parse_layer(option, value);
      if (!layer)
        return cannot_derive(Exit::kUsage,
                             fmt::format("the layer cannot be read: --{} {}: {}", option, value, layer.error()));
      layers.push_back(*std::move(layer));
    }
  }
  return layers;
}

tl::expected<ChannelSeries, RunFailure> values_of(const Channel& channel, const JointRun& run) {
  auto series = channel_values(channel, run.measurement.samples, run.joint);
  if (series) return *std::move(series);
  return cannot_derive(Exit::kUsage, fmt::format("the channel {} has no value: {}: {}", channel.name, series.error(),
                                                 run.joint.knows_common_errors
                                                     ? "name other targets"
                                                     : "name one displacement, or measure with --method precise"));
}

tl::expected<std::vector<ChannelSeries>, RunFailure> all_values(const std::vector<Channel>& channels,
                                                                const JointRun& run) {
  std::vector<ChannelSeries> all;
  for (const Channel& channel : channels) {
    auto series = values_of(channel, run);
    if (!series) return tl::unexpected(series.error());
    all.push_back(*std::move(series));
  }
  return all;
}

tl::expected<void, RunFailure> put_text(const fs::path& path, const std::string& bytes) {
  const auto written = write_file_atomically(path.string(), bytes);
  if (written) return {};
  return cannot_derive(
      Exit::kOutputUnwritable,
      fmt::format("the file could not be written: {}: free space or choose another with -o", written.error()));
}

// Writes derived.csv and derived.json.
tl::expected<void, RunFailure> write_tables(const fs::path& csv, const std::vector<Layer>& layers,
                                            DerivedResults& out) {
  const fs::path json = fs::path(csv).replace_extension(".json");
  for (const auto& [path, text] :
       {std::pair{csv, derived_csv(out.table)}, std::pair{json, derived_json(out.table, out.statistics, layers)}}) {
    if (auto written = put_text(path, text); !written) return written;
  }
  out.files.push_back(csv.string());
  return {};
}

tl::expected<void, RunFailure> add_modes(const std::string& folder, const JointRun& run, DerivedResults& out) {
  if (!run.joint.knows_common_errors)
    return cannot_derive(Exit::kUsage,
                         fmt::format("there are no mode shapes: {} (the method does not know the errors that targets "
                                     "share): measure with --method precise",
                                     folder));
  out.targets = names_of_targets(run);
  out.modes = mode_shapes(run.measurement.samples, run.joint, run.measurement.spectra);
  if (out.modes.empty()) out.warnings.push_back("note: no mode shape, because no target has a named peak");
  return {};
}

// The universal file needs at least one shape. An earlier one is removed, because it belongs to other modes.
tl::expected<void, RunFailure> put_modes(const fs::path& folder, const std::string& run, DerivedResults& out) {
  const auto table = read_run_table(run);
  if (!table) return cannot_derive(Exit::kInputUnreadable, table.error());
  for (const auto& [path, bytes] : {std::pair{folder / "modes.csv", modes_csv(out.modes, out.targets)},
                                    std::pair{folder / "modes.json", modes_json(out.modes, out.targets)}}) {
    if (auto written = put_text(path, bytes); !written) return written;
    out.files.push_back(path.string());
  }
  const fs::path universal = folder / "modes.uff";
  if (out.modes.empty()) {
    std::error_code ignored;
    fs::remove(universal, ignored);
    return {};
  }
  out.files.push_back(universal.string());
  return put_text(universal, uff58_of_modes(*table, out.modes));
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

tl::expected<RunChannels, RunFailure> run_channels(const SolveArgs& args, const std::vector<std::string>& channels,
                                                   const RunCallbacks& callbacks) {
  const auto run = joint_run(args, callbacks);
  if (!run) return tl::unexpected(run.error());
  auto parsed = channels_of(channels, *run);
  if (!parsed) return tl::unexpected(parsed.error());
  auto series = all_values(*parsed, *run);
  if (!series) return tl::unexpected(series.error());
  return RunChannels{*std::move(parsed), *std::move(series), run->measurement.exit};
}

tl::expected<DerivedResults, RunFailure> run_derive(const DeriveArgs& args, const RunCallbacks& callbacks) {
  const auto run = joint_run(args.solve, callbacks);
  if (!run) return tl::unexpected(run.error());
  DerivedResults out;
  const auto channels =
      args.channels.empty() ? channels_of_site(args, *run, out.warnings) : channels_of(args.channels, *run);
  if (!channels) return tl::unexpected(channels.error());
  const auto layers = layers_of(args, *run);
  if (!layers) return tl::unexpected(layers.error());
  const auto series = all_values(*channels, *run);
  if (!series) return tl::unexpected(series.error());
  auto whole = layered_channels(*channels, *series, *layers);
  if (!whole) return cannot_derive(Exit::kUsage, whole.error());
  out.table = std::move(whole->table);
  out.statistics = std::move(whole->statistics);
  out.exit = exit_of_table(out.table, run->measurement.exit);
  if (args.has_modes) {
    if (auto added = add_modes(args.solve.run, *run, out); !added) return tl::unexpected(added.error());
  }
  if (args.is_in_memory) return out;
  const fs::path csv = args.output.empty() ? fs::path(args.solve.run) / "derived.csv" : fs::path(args.output);
  if (!channels->empty()) {
    if (const auto written = write_tables(csv, *layers, out); !written) return tl::unexpected(written.error());
  }
  if (args.has_modes) {
    if (const auto written = put_modes(csv.parent_path(), args.solve.run, out); !written)
      return tl::unexpected(written.error());
  }
  if (!args.output.empty() || channels->empty()) return out;
  const auto choices = layer_choices(*channels, *series, *layers, kMaxPageValues);
  auto report = shown_in_report(args.solve.run, derived_script(*layers, choices), out.warnings);
  if (!report) return tl::unexpected(report.error());
  out.report = *std::move(report);
  return out;
}

tl::expected<std::string, RunFailure> shown_in_report(const std::string& run, const PageScript& script,
                                                      std::vector<std::string>& warnings) {
  auto updated = update_report(run, script);
  if (updated) return *std::move(updated);
  if (!updated.error().can_write) return cannot_derive(Exit::kOutputUnwritable, updated.error().message);
  warnings.push_back("note: " + updated.error().message);
  return std::string();
}

}  // namespace moiregauge::internal

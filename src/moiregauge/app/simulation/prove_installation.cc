// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/simulation/prove_installation.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/app/load_scenario.h"
#include "moiregauge/app/measurement_run.h"
#include "moiregauge/app/simulation/write_recording.h"
#include "moiregauge/app/solve_run.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using Failure = tl::unexpected<std::string>;

constexpr long kSelfTestFrames = 20;
// By chance one of 38 values exceeds 5 u in 45 000 seeds. The seed is fixed, so the result is the same everywhere.
constexpr double kMaxRatio = 5.0;

// A folder that is removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "moiregauge-self-test-XXXXXX").string();
    if (error)
      problem_ = error.message();
    else if (::mkdtemp(name.data()) == nullptr)
      problem_ = fmt::format("{}: {}", name, std::strerror(errno));
    else
      path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  fs::path path_;
  std::string problem_;
};

RecordingPlan plan_for(const simulator::Scenario& scenario) {
  VideoFormat format;
  format.width = scenario.camera.width;
  format.height = scenario.camera.height;
  format.fps = scenario.sensor.fps;
  return {format, simulator::Area::kMarkersOnly, 0, {}};
}

tl::expected<FinishedRun, std::string> measure_recording(const fs::path& folder) {
  MeasureArgs args;
  args.site = (folder / "site.toml").string();
  auto options = parse_measure_options(args);
  if (!options) return Failure(options.error().message);
  RunRequest request;
  request.input = (folder / file_name_for(VideoCodec::kFfv1)).string();
  request.options = *std::move(options);
  request.output = (folder / "run").string();
  auto finished = run_measurement(request, {});
  if (!finished) return Failure(finished.error().message);
  const Measurement& measured = finished->measurement;
  if (measured.exit != Exit::kMeasured)
    return Failure(fmt::format("the measurement ended with exit code {}{}{}: {}: report this",
                               static_cast<int>(measured.exit), measured.refusal.empty() ? "" : ", ", measured.refusal,
                               request.input));
  return *std::move(finished);
}

// The run directory must be complete, and its observations must give its table again.
tl::expected<void, std::string> check_folder(const fs::path& run) {
  std::error_code ignored;
  for (const char* name : {"displacement.csv", "displacement.h5", "run.json", "report.html", "overlay.png"}) {
    if (fs::file_size(run / name, ignored) == 0 || ignored)
      return Failure(fmt::format("a result is missing: {}: report this", (run / name).string()));
  }
  SolveArgs args;
  args.run = run.string();
  const auto solved = solve_in_memory(args, RunBase::kResults);
  if (!solved) return Failure(solved.error().message);
  const auto same = check_results(args.run, site_of(solved->measurement, solved->options), solved->measurement.samples);
  if (!same) return Failure(same.error().message);
  return {};
}

tl::expected<SelfTestFigures, std::string> compare_with_truth(const simulator::Scenario& scenario,
                                                              const Measurement& measured) {
  SelfTestFigures figures;
  figures.frames = static_cast<long>(measured.observations.size());
  for (const Sample& sample : measured.samples) {
    if (sample.frame == measured.reference->seen.frame) continue;
    const std::string& name = measured.reference->site.markers[sample.marker].name;
    const auto* marker = simulator::find_marker(scenario, name);
    if (marker == nullptr || sample.status != Status::kOk)
      return Failure(fmt::format("a sample is not ok: {}, frame {}: report this", name, sample.frame));
    const auto truth = simulator::truth(scenario, sample.frame, *marker);
    const double x = std::abs(sample.displacement.x - truth.dx_mm), y = std::abs(sample.displacement.y - truth.dy_mm);
    figures.largest_error_mm = std::max({figures.largest_error_mm, x, y});
    figures.largest_ratio = std::max({figures.largest_ratio, x / sample.u.x, y / sample.u.y});
    ++figures.samples;
  }
  if (figures.frames != kSelfTestFrames || figures.samples != kSelfTestFrames - 1)
    return Failure(fmt::format("only {} of {} frames were measured: report this", figures.samples, kSelfTestFrames));
  if (!(figures.largest_ratio < kMaxRatio))
    return Failure(fmt::format("a displacement is wrong: by {:.1f} u, {:.4f} mm: report this", figures.largest_ratio,
                               figures.largest_error_mm));
  return figures;
}

}  // namespace

tl::expected<SelfTestFigures, std::string> run_self_test() {
  const TemporaryFolder folder;
  if (!folder.problem().empty())
    return Failure(fmt::format("no temporary folder could be made: {}: set TMPDIR to a folder that is writable",
                               folder.problem()));
  const auto scenario = load_scenario({"small-1xyz", {}, std::nullopt, kSelfTestFrames});
  if (!scenario) return Failure(scenario.error());
  if (const auto written = write_recording(*scenario, plan_for(*scenario), folder.path().string()); !written)
    return Failure(
        fmt::format("the video could not be written: {}: set TMPDIR to a folder with free space", written.error()));
  const auto finished = measure_recording(folder.path());
  if (!finished) return Failure(finished.error());
  if (const auto checked = check_folder(folder.path() / "run"); !checked) return Failure(checked.error());
  return compare_with_truth(*scenario, finished->measurement);
}

}  // namespace moiregauge::internal

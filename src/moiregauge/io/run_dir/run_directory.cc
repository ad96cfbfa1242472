// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/run_directory.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/io/config/camera_file.h"
#include "moiregauge/io/config/site_file.h"
#include "moiregauge/io/journal/run_file.h"
#include "moiregauge/io/run_dir/run_json.h"
#include "moiregauge/io/run_dir/run_json_reader.h"
#include "moiregauge/io/run_dir/solved_scene.h"
#include "moiregauge/io/tables/camera_csv.h"
#include "moiregauge/io/tables/displacement_csv.h"
#include "moiregauge/io/tables/displacement_h5.h"
#include "moiregauge/results/derived/site_channels.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

using Done = tl::expected<void, std::string>;  // "path: what is wrong"

Done put_file(const fs::path& path, std::string_view bytes) { return write_file_atomically(path.string(), bytes); }

std::string sha256_of_run(const fs::path& dir) {
  std::ifstream file(dir / "run.json");
  return input_sha256_of_run(file);
}

// Keeps the files of the measurement. Hard links are enough in a folder that replaces `from`. Otherwise, or if the file
// system has no links, the files are copied.
Done keep_seen(const fs::path& dir, const fs::path& from, bool in_place) {
  for (const std::string_view name : {std::string_view("overlay.png"), std::string_view("stabilised.mp4"), kRunFileName,
                                      kLiveRowsName, kLiveFactsName}) {
    std::error_code error;
    if (!fs::exists(from / name, error)) continue;
    if (in_place) fs::create_hard_link(from / name, dir / name, error);
    if (!in_place || error) fs::copy_file(from / name, dir / name, error);
    if (!error && !sync_file((dir / name).string())) error.assign(errno, std::generic_category());
    if (error) return tl::unexpected(fmt::format("{}: {}", (dir / name).string(), error.message()));
  }
  return {};
}

std::vector<std::uint8_t> bytes_in_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

Done put_results(const fs::path& dir, const Measurement& measurement, const MeasureOptions& options,
                 const WriteReport& write_report) {
  if (measurement.reference) {
    const std::string csv = displacement_csv(site_of(measurement, options), measurement.samples);
    if (auto done = put_file(dir / "displacement.csv", csv); !done) return done;
    if (auto done = put_file(dir / "displacement.h5", displacement_h5(measurement, options)); !done) return done;
  }
  if (const auto camera = camera_rows(measurement); !camera.empty()) {
    if (auto done = put_file(dir / "camera.csv", camera_csv(camera)); !done) return done;
  }
  const std::optional<Scene>& scene = stated_scene(measurement);
  if (measurement.reference && scene) {
    const Site solved = solved_site(measurement.reference->site, *scene);
    const SiteChannels channels = read_site_channels(options.channels, target_names(solved));
    if (auto done = put_file(dir / "site.toml", write_site(solved, channels.texts)); !done) return done;
  }
  if (scene && determines_camera(*scene)) {
    Camera solved = scene->camera;
    solved.width = measurement.input.width;
    solved.height = measurement.input.height;
    if (auto done = put_file(dir / "camera.toml", write_camera(solved, u_of_camera(*scene))); !done) return done;
  }
  // File names are not always UTF-8, but JSON must be.
  const std::string json =
      run_json(measurement, options).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  if (auto done = put_file(dir / "run.json", json); !done) return done;
  if (!write_report) return {};
  return put_file(dir / "report.html", write_report(measurement, options, json, bytes_in_file(dir / "overlay.png")));
}

}  // namespace

OutputError RunDirectory::unwritable(const std::string& why, const Measurement& measurement) const {
  if (!solved_from_.empty())
    return {false,
            fmt::format("the results could not be written: {}: free space or choose another folder with -o", why)};
  return {false, fmt::format("the results could not be written: {} (all {} frames are kept): free space and run again "
                             "with --resume",
                             why, measurement.observations.size())};
}

tl::expected<void, OutputError> RunDirectory::check(const std::function<std::string()>& input_sha256) const {
  recover(place_);
  std::error_code error;
  const fs::path& dir = place_.results;
  if (!fs::exists(dir, error)) return {};
  const auto usage = [&](const char* why) {
    return tl::unexpected(OutputError{
        true, fmt::format("the output folder cannot be used: {} ({}): choose another with -o", place_.shown, why)});
  };
  if (!fs::is_directory(dir, error)) return usage("it is not a folder");
  if (fs::is_empty(dir, error)) return {};
  if (!fs::exists(dir / "run.json", error)) return usage("it holds other files");
  if (sha256_of_run(dir) != input_sha256()) return usage("it holds a run of another input");
  return {};
}

tl::expected<void, std::string> RunDirectory::put_files(const fs::path& dir, const Measurement& measurement,
                                                        const MeasureOptions& options) const {
  if (solved_from_.empty()) {
    const std::vector<std::uint8_t> overlay = draw_overlay_(measurement);
    const std::string_view bytes{reinterpret_cast<const char*>(overlay.data()), overlay.size()};
    if (auto done = bytes.empty() ? Done{} : put_file(dir / "overlay.png", bytes); !done) return done;
  } else if (auto done = keep_seen(dir, solved_from_, place_.results == place_of_run(solved_from_).results); !done) {
    return done;
  }
  auto done = put_results(dir, measurement, options, write_report_);
  for (const PutMore& more : more_)
    if (done) done = more(dir, measurement);
  return done;
}

tl::expected<void, OutputError> RunDirectory::write(const Measurement& measurement, const MeasureOptions& options) {
  if (auto allowed = check([&] { return measurement.input.sha256; }); !allowed) return allowed;
  std::error_code error;
  const bool is_new = solved_from_.empty();
  const fs::path folder = is_new ? place_.unfinished : place_.solved;
  if (!is_new) fs::remove_all(folder, error);  // left by a killed `solve`
  fs::create_directories(folder, error);
  if (error) return tl::unexpected(unwritable(folder.string() + ": " + error.message(), measurement));
  auto done = put_files(folder, measurement, options);
  is_unfinished_ = is_new && measurement.interrupted && fs::exists(place_.results, error) &&
                   !fs::is_empty(place_.results, error) && !holds_interrupted_run(place_.results);
  if (done && !is_unfinished_) {
    done = publish(folder, place_);
    if (!done) done = tl::unexpected(place_.shown + ": " + done.error());
  }
  if (done) return {};
  if (is_new)
    keep_journal_only(folder);
  else
    fs::remove_all(folder, error);
  return tl::unexpected(unwritable(done.error(), measurement));
}

}  // namespace moiregauge::internal

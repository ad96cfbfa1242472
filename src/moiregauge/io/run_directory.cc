// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_directory.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/io/camera_file.h"
#include "moiregauge/io/displacement_csv.h"
#include "moiregauge/io/run_file.h"
#include "moiregauge/io/run_json.h"
#include "moiregauge/io/site_file.h"
#include "moiregauge/io/solved_scene.h"

namespace moiregauge {
namespace {

namespace fs = std::filesystem;

OutputError unwritable(const std::string& path, const std::string& why) {
  return {false, fmt::format("cannot write results: {}: {}: free the space or choose another folder with -o", path, why)};
}

// A new file, written piece by piece and brought to the disk at the end.
class NewFile {
 public:
  explicit NewFile(const fs::path& path)
      : path_(path), file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
    if (file_ < 0) why_ = std::strerror(errno);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile() {
    if (file_ >= 0) ::close(file_);
  }
  bool put(std::string_view bytes) {
    while (file_ >= 0 && why_.empty() && !bytes.empty()) {
      const ssize_t done = ::write(file_, bytes.data(), bytes.size());
      if (done >= 0) bytes.remove_prefix(static_cast<std::size_t>(done));
      else if (errno != EINTR) why_ = std::strerror(errno);
    }
    return why_.empty();
  }
  tl::expected<void, OutputError> finish() {
    if (why_.empty() && ::fsync(file_) != 0) why_ = std::strerror(errno);
    if (file_ >= 0 && ::close(file_) != 0 && why_.empty()) why_ = std::strerror(errno);
    file_ = -1;
    if (!why_.empty()) return tl::unexpected(unwritable(path_, why_));
    return {};
  }

 private:
  std::string path_;
  int file_;
  std::string why_;  // it failed; empty while it did not
};

tl::expected<void, OutputError> put(const fs::path& path, std::string_view bytes) {
  NewFile file(path);
  file.put(bytes);
  return file.finish();
}

std::string sha256_of_run(const fs::path& dir) {
  std::ifstream file(dir / "run.json");
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (json.is_discarded() || !json.contains("input") || !json["input"].contains("sha256")) return {};
  return json["input"]["sha256"].is_string() ? json["input"]["sha256"].get<std::string>() : std::string{};
}

// What `measure` alone can make, or what it once made and `solve` keeps.
tl::expected<void, OutputError> put_seen(const fs::path& dir, const Measurement& measurement,
                                         const MeasureOptions& options, const DrawOverlay& draw_overlay) {
  const std::vector<std::uint8_t> overlay = draw_overlay(measurement);
  if (auto done = put(dir / "overlay.png", {reinterpret_cast<const char*>(overlay.data()), overlay.size()}); !done)
    return done;
  NewFile file(dir / kRunFileName);
  write_run(measurement, options, [&](std::string_view bytes) { return file.put(bytes); });
  return file.finish();
}

// For a folder that takes the place of `from` the same files under another name, else, or where the file system has no
// such thing, copies.
tl::expected<void, OutputError> keep_seen(const fs::path& dir, const fs::path& from, bool in_place) {
  for (const char* name : {"overlay.png", kRunFileName.data()}) {
    std::error_code error;
    if (!fs::exists(from / name, error)) continue;
    if (in_place) fs::create_hard_link(from / name, dir / name, error);
    if (!in_place || error) fs::copy_file(from / name, dir / name, error);
    if (error) return tl::unexpected(unwritable(dir / name, error.message()));
  }
  return {};
}

tl::expected<void, OutputError> put_results(const fs::path& dir, const Measurement& measurement,
                                            const MeasureOptions& options) {
  if (measurement.reference) {
    const std::string csv = displacement_csv(site_of(measurement, options), measurement.samples);
    if (auto done = put(dir / "displacement.csv", csv); !done) return done;
  }
  if (measurement.reference && measurement.scene && measurement.scene->solved) {
    const Site solved = solved_site(measurement.reference->site, *measurement.scene);
    if (auto done = put(dir / "site.toml", write_site(solved)); !done) return done;
  }
  if (measurement.scene && has_solved_lens(*measurement.scene)) {
    Camera solved = measurement.scene->camera;
    solved.width = measurement.input.width;
    solved.height = measurement.input.height;
    if (auto done = put(dir / "camera.toml", write_camera(solved, u_of_camera(*measurement.scene))); !done) return done;
  }
  // What other people called their files is not always UTF-8; the JSON is.
  const std::string json =
      run_json(measurement, options).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  return put(dir / "run.json", json);
}

// The folder itself, whatever name leads to it.
fs::path real_place(const std::string& path) {
  std::error_code error;
  fs::path place = fs::weakly_canonical(path, error);
  if (error) place = fs::path(path).lexically_normal();
  return place.has_filename() ? place : place.parent_path();
}

}  // namespace

tl::expected<void, OutputError> RunDirectory::check(const std::function<std::string()>& input_sha256) const {
  std::error_code error;
  if (!fs::exists(path_, error)) return {};
  const auto usage = [&](const char* why) {
    return tl::unexpected(OutputError{true, fmt::format("output folder is taken: {}: {}: choose another with -o", path_, why)});
  };
  if (!fs::is_directory(path_, error)) return usage("it is not a folder");
  if (fs::is_empty(path_, error)) return {};
  if (!fs::exists(fs::path(path_) / "run.json", error)) return usage("it holds something else than a run");
  if (sha256_of_run(path_) != input_sha256()) return usage("it holds a run of another input");
  return {};
}

tl::expected<void, OutputError> RunDirectory::write(const Measurement& measurement, const MeasureOptions& options) {
  if (auto allowed = check([&] { return measurement.input.sha256; }); !allowed) return allowed;
  std::error_code error;
  const fs::path target = real_place(path_);
  const fs::path partial = target.string() + fmt::format(".partial-{}", ::getpid());
  const fs::path old = target.string() + fmt::format(".old-{}", ::getpid());
  fs::create_directories(partial, error);
  if (error) return tl::unexpected(unwritable(partial, error.message()));
  auto done = solved_from_.empty() ? put_seen(partial, measurement, options, draw_overlay_)
                                   : keep_seen(partial, solved_from_, target == real_place(solved_from_));
  if (done) done = put_results(partial, measurement, options);
  if (!done) {
    fs::remove_all(partial, error);
    return done;
  }
  if (fs::exists(target, error)) fs::rename(target, old, error);
  if (!error) fs::rename(partial, target, error);
  if (error) {
    const std::string why = error.message();
    if (fs::exists(old, error) && !fs::exists(target, error)) fs::rename(old, target, error);
    fs::remove_all(partial, error);
    return tl::unexpected(unwritable(target, why));
  }
  fs::remove_all(old, error);
  return {};
}

}  // namespace moiregauge

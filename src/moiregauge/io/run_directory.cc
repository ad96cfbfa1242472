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

#include "moiregauge/io/displacement_csv.h"
#include "moiregauge/io/run_json.h"

namespace moiregauge {
namespace {

namespace fs = std::filesystem;

OutputError unwritable(const std::string& path, const std::string& why) {
  return {false, fmt::format("cannot write results: {}: {}: free the space or choose another folder with -o", path, why)};
}

tl::expected<void, OutputError> put(const fs::path& path, const char* bytes, std::size_t size) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return tl::unexpected(unwritable(path, std::strerror(errno)));
  while (size > 0) {
    const ssize_t done = ::write(file, bytes, size);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) {
      const std::string why = std::strerror(errno);
      ::close(file);
      return tl::unexpected(unwritable(path, why));
    }
    bytes += done;
    size -= static_cast<std::size_t>(done);
  }
  const bool synced = ::fsync(file) == 0;
  const std::string why = std::strerror(errno);
  if (::close(file) != 0 || !synced) return tl::unexpected(unwritable(path, why));
  return {};
}

std::string sha256_of_run(const fs::path& dir) {
  std::ifstream file(dir / "run.json");
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (json.is_discarded() || !json.contains("input") || !json["input"].contains("sha256")) return {};
  return json["input"]["sha256"].is_string() ? json["input"]["sha256"].get<std::string>() : std::string{};
}

tl::expected<void, OutputError> put_all(const fs::path& dir, const Measurement& measurement, const MeasureOptions& options,
                                        const DrawOverlay& draw_overlay) {
  const std::string csv = displacement_csv(site_of(measurement, options), measurement.samples);
  if (measurement.reference) {
    if (auto done = put(dir / "displacement.csv", csv.data(), csv.size()); !done) return done;
  }
  const std::vector<std::uint8_t> overlay = draw_overlay(measurement);
  if (auto done = put(dir / "overlay.png", reinterpret_cast<const char*>(overlay.data()), overlay.size()); !done) return done;
  // What other people called their files is not always UTF-8; the JSON is.
  const std::string json =
      run_json(measurement, options).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  return put(dir / "run.json", json.data(), json.size());
}

}  // namespace

tl::expected<void, OutputError> RunDirectory::check(const std::string& input_sha256) const {
  std::error_code error;
  if (!fs::exists(path_, error)) return {};
  const auto usage = [&](const char* why) {
    return tl::unexpected(OutputError{true, fmt::format("output folder is taken: {}: {}: choose another with -o", path_, why)});
  };
  if (!fs::is_directory(path_, error)) return usage("it is not a folder");
  if (fs::is_empty(path_, error)) return {};
  if (!fs::exists(fs::path(path_) / "run.json", error)) return usage("it holds something else than a run");
  if (sha256_of_run(path_) != input_sha256) return usage("it holds a run of another input");
  return {};
}

tl::expected<void, OutputError> RunDirectory::write(const Measurement& measurement, const MeasureOptions& options) {
  if (auto allowed = check(measurement.input.sha256); !allowed) return allowed;
  std::error_code error;
  fs::path target = fs::path(path_).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  const fs::path partial = target.string() + fmt::format(".partial-{}", ::getpid());
  const fs::path old = target.string() + fmt::format(".old-{}", ::getpid());
  fs::create_directories(partial, error);
  if (error) return tl::unexpected(unwritable(partial, error.message()));
  if (auto done = put_all(partial, measurement, options, draw_overlay_); !done) {
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

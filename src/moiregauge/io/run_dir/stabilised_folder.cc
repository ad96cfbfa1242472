// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/stabilised_folder.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/csv_field.h"
#include "moiregauge/io/pictures/png_file.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

fs::path without_slash(const std::string& path) {
  const fs::path normal = fs::path(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

OutputError unwritable(const std::string& why) {
  return {false, fmt::format("the stabilised images could not be written: {}: free space or choose another folder with "
                             "--stabilised",
                             why)};
}

// Returns a valid folder name for any marker name.
std::string folder_name(const std::string& marker) {
  std::string name;
  for (const char c : marker) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80 ||
                       c == '-' || c == '_' || (c == '.' && !name.empty());
    name += plain ? c : '_';
  }
  return name.empty() ? "_" : name;
}

}  // namespace

StabilisedFolder::StabilisedFolder(const std::string& path)
    : path_(without_slash(path).string()), partial_(path_ + ".unfinished") {}

StabilisedFolder::~StabilisedFolder() {
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

tl::expected<void, OutputError> StabilisedFolder::open() {
  std::error_code error;
  if (fs::exists(path_, error) && !(fs::is_directory(path_, error) && fs::is_empty(path_, error)))
    return tl::unexpected(
        OutputError{true, fmt::format("the folder is not empty: {}: choose another with --stabilised", path_)});
  fs::remove_all(partial_, error);  // left by a killed run
  fs::create_directories(partial_, error);
  if (error) return tl::unexpected(unwritable(fmt::format("{}: {}", path_, error.message())));
  return {};
}

void StabilisedFolder::keep_failure(const std::string& why) {
  if (failure_) return;
  failure_ = unwritable(why);
  std::error_code ignored;
  fs::remove_all(partial_, ignored);  // leaves the remaining disk space to the results
}

void StabilisedFolder::plan_crops(const Reference& reference) {
  site_ = reference.site;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    std::string folder = folder_name(reference.site.markers[i].name);
    const auto is_taken = [&](const Place& p) { return p.folder == folder; };
    while (std::any_of(places_.begin(), places_.end(), is_taken)) folder += "_";
    places_.push_back({folder, plan_crop(reference, i)});
    std::error_code error;
    fs::create_directories(fs::path(partial_) / folder, error);
    if (error) keep_failure(fmt::format("{}/{}: {}", partial_, folder, error.message()));
  }
}

void StabilisedFolder::write_crops(const Frame& frame, int bits, const View& view) {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Crop crop = cut_out({frame.luma, bits}, view, places_[i].plan);
    const std::string file = fmt::format("{}/{:06d}.png", places_[i].folder, frame.number);
    if (const auto done = write_png((fs::path(partial_) / file).string(), crop.grey.view(), 8); !done) {
      keep_failure(done.error());
      return;
    }
    rows_ += fmt::format("{},{},{},{},{:.4f},\n", frame.number, csv_number(frame.time_s),
                         csv_field(site_->markers[i].name), file, crop.inside);
    ++crops_;
  }
}

void StabilisedFolder::add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) {
  if (failure_) return;
  if (reference == nullptr || !seen.references_seen) {
    rows_ += fmt::format("{},{},,,,{}\n", frame.number, csv_number(frame.time_s), csv_field(seen.reference_problem));
    return;
  }
  if (!site_) plan_crops(*reference);
  if (!failure_) write_crops(frame, bits, {seen.stage2, reference->lens});
}

tl::expected<void, OutputError> StabilisedFolder::finish() {
  if (failure_) return tl::unexpected(*failure_);
  if (crops_ == 0) return {};
  nlohmann::ordered_json markers = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const CropPlan& plan = places_[i].plan;
    markers.push_back({{"name", site_->markers[i].name},
                       {"role", site_->markers[i].role == Role::kReference ? "reference" : "target"},
                       {"folder", places_[i].folder},
                       {"mm_per_px", plan.mm_per_px},
                       {"x_mm", plan.first.x},
                       {"y_mm", plan.first.y},
                       {"width", plan.width},
                       {"height", plan.height}});
  }
  const std::string json = nlohmann::ordered_json{{"schema", 1}, {"markers", markers}}.dump(
                               2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
                           "\n";
  const auto written = write_file_atomically((fs::path(partial_) / "stabilised.json").string(), json).and_then([&] {
    return write_file_atomically((fs::path(partial_) / "stabilised.csv").string(),
                                 "frame,time_s,marker,file,inside,why\n" + rows_);
  });
  if (!written) return tl::unexpected(unwritable(written.error()));
  std::error_code error;
  fs::rename(partial_, path_, error);
  if (error) return tl::unexpected(unwritable(fmt::format("{}: {}", path_, error.message())));
  return {};
}

bool overlaps(const std::string& a, const std::string& b) {
  std::error_code ignored;
  const auto plain = [&](const std::string& path) {
    const fs::path full = fs::absolute(without_slash(path), ignored).lexically_normal();
    const fs::path resolved = fs::weakly_canonical(full, ignored);
    return resolved.empty() ? full : resolved;
  };
  const fs::path p = plain(a), q = plain(b);
  const auto [in_p, in_q] = std::mismatch(p.begin(), p.end(), q.begin(), q.end());
  return in_p == p.end() || in_q == q.end();
}

}  // namespace moiregauge::internal

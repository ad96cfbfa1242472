// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/file_set.h"

#include <filesystem>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/io/run_dir/run_place.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

bool holds_only_such(const fs::path& folder, const std::vector<NamedBytes>& files) {
  std::set<std::string> endings;
  for (const auto& [name, bytes] : files) endings.insert(fs::path(name).extension().string());
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (!entry.is_regular_file(error) || !endings.contains(entry.path().extension().string())) return false;
  }
  return !error;
}

bool may_be_taken(const fs::path& folder, const std::vector<NamedBytes>& files, Existing existing) {
  std::error_code error;
  if (!fs::exists(folder, error)) return true;
  if (!fs::is_directory(folder, error)) return false;
  return fs::is_empty(folder, error) || (existing == Existing::kReplace && holds_only_such(folder, files));
}

}  // namespace

tl::expected<void, OutputError> write_file_set(const std::string& dir, const std::vector<NamedBytes>& files,
                                               Existing existing) {
  const RunPlace place = place_of_run(dir);
  if (!may_be_taken(place.results, files, existing))
    return tl::unexpected(OutputError{
        true, existing == Existing::kReplace
                  ? fmt::format("the output folder holds something else: {}: choose another with -o", place.shown)
                  : fmt::format("the output folder is not empty: {}: replace it with --replace, or choose another with "
                                "-o",
                                place.shown)});
  const fs::path partial = place.results.string() + ".partial";
  const auto fail = [&](const std::string& why) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    return tl::unexpected(OutputError{
        false, fmt::format("the files could not be written: {}: {}: free space or choose another folder with -o",
                           place.shown, why)});
  };
  std::error_code error;
  fs::remove_all(partial, error);  // left by a killed process
  fs::create_directories(partial, error);
  if (error) return fail(error.message());
  for (const auto& [name, bytes] : files) {
    if (const auto written = write_file_atomically((partial / name).string(), bytes); !written)
      return fail(written.error());
  }
  if (const auto placed = publish(partial, place); !placed) return fail(placed.error());
  return {};
}

}  // namespace moiregauge::internal

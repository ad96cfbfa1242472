// SPDX-License-Identifier: Apache-2.0
// Input: the text of a query on a catalogue of two clips, or the bytes of a catalogue (they begin with `SQLite format 3`).
// Requires: a query passes whole lines, changes neither the catalogue nor the folder, and fails with a message.
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <sqlite3.h>

#include "moiregauge/batch/catalogue.h"
#include "tests/fuzz/fuzz_folder.h"
#include "tests/fuzz/input_file.h"

namespace {

using namespace moiregauge::internal;

// SQLite calls the progress handler once per kStepsPerCall steps of its virtual machine, and ends a query after kMaxCalls.
constexpr int kStepsPerCall = 1000;
constexpr int kMaxCalls = 200;
constexpr int kMaxBytes = 64 * 1024;

// Limits each connection. An endless query is the user's own, and Ctrl-C ends it, but here it would hide faults.
int limit(sqlite3* database, const char**, const struct sqlite3_api_routines*) {
  static int calls;
  calls = 0;
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, kMaxBytes);
  sqlite3_progress_handler(
      database, kStepsPerCall, [](void*) { return static_cast<int>(++calls > kMaxCalls); }, nullptr);
  return SQLITE_OK;
}

bool limit_all() { return sqlite3_auto_extension(reinterpret_cast<void (*)()>(limit)) == SQLITE_OK; }

// Writes a catalogue of a measured clip and of one that waits.
std::string made_catalogue(const std::filesystem::path& path) {
  auto writer = CatalogueWriter::create(path);
  fuzz::demand(writer.has_value());
  CollectedClip clip{{"a", "/clips/a.mkv", ""}, ClipState{}, RunSummary{}};
  clip.state->is_finished = true;
  clip.run->warnings = {"movements may be invisible"};
  clip.run->targets.push_back({"T1", 8, 7, {0.1, 0.2}, {0.01, 0.02}, {0.001, 0.001}, {{'y', "steady", 2.5}}, ""});
  fuzz::demand(writer->add(clip).has_value());
  fuzz::demand(writer->add({{"b", "/clips/b.mkv", ""}, std::nullopt, std::nullopt}).has_value());
  fuzz::demand(writer->publish().has_value());
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void check(const std::filesystem::path& catalogue, const std::string& sql) {
  std::size_t lines = 0;
  const auto done = query_catalogue(catalogue, sql, [&](std::string_view line) {
    fuzz::demand(line.ends_with('\n'));
    ++lines;
  });
  fuzz::demand(done ? lines > 0 : !done.error().empty());
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool is_limited = limit_all();
  static const fuzz::FuzzFolder folder;
  static const std::filesystem::path catalogue = folder.path() / "catalogue.sqlite";
  static const std::string whole = made_catalogue(catalogue);
  fuzz::demand(is_limited);
  const std::string input = fuzz::text_of({data, size});
  const bool is_file = input.starts_with("SQLite format 3");
  const std::string& bytes = is_file ? input : whole;
  static_cast<void>(folder.put("catalogue.sqlite", bytes));
  if (is_file) {
    for (const char* table : {"runs", "targets", "peaks", "warnings", "sqlite_schema"})
      check(catalogue, std::string("SELECT * FROM ") + table);
  } else {
    check(catalogue, input);
  }
  std::ifstream file(catalogue, std::ios::binary);
  const std::string after{std::istreambuf_iterator<char>(file), {}};
  fuzz::demand(after == bytes);
  fuzz::demand(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
  return 0;
}

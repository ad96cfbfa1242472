// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/catalogue.h"

#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sqlite3.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/csv_field.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

// user_version states the version of this layout. The file is complete or does not exist, so it needs no journal.
constexpr const char* kTables = R"(
PRAGMA journal_mode = OFF;
PRAGMA synchronous = OFF;
PRAGMA user_version = 1;
BEGIN;
CREATE TABLE runs (run TEXT PRIMARY KEY, clip TEXT, outcome TEXT, exit_code INTEGER, message TEXT, seconds REAL,
  cpu_s REAL, max_resident_mb REAL, version TEXT, method TEXT, frames INTEGER, width INTEGER, height INTEGER, fps REAL,
  codec TEXT, sha256 TEXT, start_utc TEXT, complete INTEGER) WITHOUT ROWID;
CREATE TABLE targets (run TEXT, marker TEXT, frames INTEGER, ok INTEGER, peak_to_peak_dx_mm REAL,
  peak_to_peak_dy_mm REAL, rms_dx_mm REAL, rms_dy_mm REAL, u_dx_mm REAL, u_dy_mm REAL, f1_hz REAL, u_f1_hz REAL,
  PRIMARY KEY (run, marker)) WITHOUT ROWID;
CREATE TABLE peaks (run TEXT, marker TEXT, axis TEXT, kind TEXT, frequency_hz REAL, u_frequency_hz REAL,
  amplitude_mm REAL, damping REAL, u_damping REAL);
CREATE INDEX peaks_of_run ON peaks (run, marker);
CREATE TABLE warnings (run TEXT, text TEXT);
CREATE INDEX warnings_of_run ON warnings (run);
)";

constexpr std::array<const char*, 4> kInserts{
    "INSERT INTO runs VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)",
    "INSERT INTO targets VALUES (?,?,?,?,?,?,?,?,?,?,?,?)",
    "INSERT INTO peaks VALUES (?,?,?,?,?,?,?,?,?)",
    "INSERT INTO warnings VALUES (?,?)",
};
enum Insert : std::size_t { kRun, kTarget, kPeak, kWarning };

// Binds one value after the other. SQLite stores NaN as NULL.
class Row {
 public:
  explicit Row(sqlite3_stmt* statement) : statement_(statement) {}
  Row& text(const std::string& value) {
    sqlite3_bind_text(statement_, ++column_, value.data(), static_cast<int>(value.size()), SQLITE_TRANSIENT);
    return *this;
  }
  Row& real(double value) {
    sqlite3_bind_double(statement_, ++column_, value);
    return *this;
  }
  Row& whole(std::int64_t value) {
    sqlite3_bind_int64(statement_, ++column_, value);
    return *this;
  }
  Row& null() {
    sqlite3_bind_null(statement_, ++column_);
    return *this;
  }
  [[nodiscard]] bool insert() {
    const bool is_done = sqlite3_step(statement_) == SQLITE_DONE;
    sqlite3_reset(statement_);
    sqlite3_clear_bindings(statement_);
    return is_done;
  }

 private:
  sqlite3_stmt* statement_;
  int column_ = 0;
};

bool insert_run(sqlite3_stmt* statement, const CollectedClip& clip) {
  Row row(statement);
  row.text(clip.clip.name).text(one_line(clip.clip.input)).text(word_for(lamp_of(clip)));
  if (clip.is_finished()) {
    const ClipState& state = *clip.state;
    row.whole(state.exit_code).text(one_line(state.message)).real(state.wall_s).real(state.cpu_s);
    row.real(1e-6 * static_cast<double>(state.max_resident_bytes));
  } else {
    row.null().text("").null().null().null();
  }
  if (!clip.run) return row.insert();  // the other columns are NULL
  const RunSummary& run = *clip.run;
  row.text(run.version).text(run.method).whole(run.frames).whole(run.width).whole(run.height).real(run.fps);
  return row.text(run.codec).text(run.sha256).text(run.start_utc).whole(run.is_complete).insert();
}

bool insert_target(sqlite3_stmt* statement, const std::string& run, const TargetOfRun& target) {
  const PeakOfRun* peak = target.strongest_peak();
  Row row(statement);
  row.text(run).text(one_line(target.marker)).whole(target.frames).whole(target.ok);
  row.real(target.peak_to_peak.x).real(target.peak_to_peak.y).real(target.rms.x).real(target.rms.y);
  row.real(target.u.x).real(target.u.y);
  return row.real(peak != nullptr ? peak->frequency_hz : std::nan(""))
      .real(peak != nullptr ? peak->u_frequency_hz : std::nan(""))
      .insert();
}

bool insert_peak(sqlite3_stmt* statement, const std::string& run, const std::string& marker, const PeakOfRun& peak) {
  Row row(statement);
  row.text(run).text(one_line(marker)).text(std::string("d") + peak.axis).text(peak.kind);
  row.real(peak.frequency_hz).real(peak.u_frequency_hz).real(peak.amplitude_mm);
  return row.real(peak.damping).real(peak.u_damping).insert();
}

// Allows what a SELECT needs. ATTACH, PRAGMA and every change are refused. The parameters are those of SQLite.
// NOLINTNEXTLINE(readability-function-size)
int authorize(void*, int action, const char*, const char*, const char*, const char*) {
  const bool is_reading =
      action == SQLITE_SELECT || action == SQLITE_READ || action == SQLITE_FUNCTION || action == SQLITE_RECURSIVE;
  return is_reading ? SQLITE_OK : SQLITE_DENY;
}

std::string cell(sqlite3_stmt* statement, int column) {
  if (sqlite3_column_type(statement, column) == SQLITE_NULL) return "NaN";
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr ? "" : csv_field(text);
}

}  // namespace

struct CatalogueWriter::State {
  fs::path path, unfinished;
  Database database{nullptr, sqlite3_close_v2};
  std::vector<Statement> inserts;  // as kInserts
  bool is_published = false;

  [[nodiscard]] tl::unexpected<std::string> failed() const {
    return tl::unexpected(
        fmt::format("{} ({})", path.string(), database ? sqlite3_errmsg(database.get()) : std::strerror(errno)));
  }
  [[nodiscard]] bool prepare() {
    sqlite3* opened = nullptr;
    const int result =
        sqlite3_open_v2(unfinished.c_str(), &opened, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, "unix-none");
    database.reset(opened);
    if (result != SQLITE_OK || sqlite3_exec(opened, kTables, nullptr, nullptr, nullptr) != SQLITE_OK) return false;
    for (const char* insert : kInserts) {
      sqlite3_stmt* statement = nullptr;
      if (sqlite3_prepare_v2(opened, insert, -1, &statement, nullptr) != SQLITE_OK) return false;
      inserts.emplace_back(statement, sqlite3_finalize);
    }
    return true;
  }
};

CatalogueWriter::CatalogueWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
CatalogueWriter::CatalogueWriter(CatalogueWriter&&) noexcept = default;

CatalogueWriter::~CatalogueWriter() {
  if (!state_ || state_->is_published) return;
  state_->inserts.clear();
  state_->database.reset();
  std::error_code ignored;
  fs::remove(state_->unfinished, ignored);
}

tl::expected<CatalogueWriter, std::string> CatalogueWriter::create(const fs::path& path) {
  auto state = std::make_unique<State>();
  state->path = path;
  state->unfinished = fs::path(path.string() + fmt::format(".{}", ::getpid()));
  std::error_code ignored;
  fs::remove(state->unfinished, ignored);
  if (!state->prepare()) {
    const auto failure = state->failed();
    CatalogueWriter remover(std::move(state));
    return failure;
  }
  return CatalogueWriter(std::move(state));
}

tl::expected<void, std::string> CatalogueWriter::add(const CollectedClip& clip) {
  const auto& inserts = state_->inserts;
  bool is_good = insert_run(inserts[kRun].get(), clip);
  if (clip.run) {
    for (const TargetOfRun& target : clip.run->targets) {
      is_good = is_good && insert_target(inserts[kTarget].get(), clip.clip.name, target);
      for (const PeakOfRun& peak : target.peaks)
        is_good = is_good && insert_peak(inserts[kPeak].get(), clip.clip.name, target.marker, peak);
    }
    for (const std::string& warning : clip.run->warnings)
      is_good = is_good && Row(inserts[kWarning].get()).text(clip.clip.name).text(one_line(warning)).insert();
  }
  if (!is_good) return state_->failed();
  return {};
}

tl::expected<void, std::string> CatalogueWriter::publish() {
  if (sqlite3_exec(state_->database.get(), "COMMIT", nullptr, nullptr, nullptr) != SQLITE_OK) return state_->failed();
  state_->inserts.clear();
  state_->database.reset();
  if (!sync_file(state_->unfinished.string()) || std::rename(state_->unfinished.c_str(), state_->path.c_str()) != 0 ||
      !sync_folder(state_->path.parent_path().string()))
    return state_->failed();
  state_->is_published = true;
  return {};
}

tl::expected<void, std::string> query_catalogue(const fs::path& path, const std::string& sql,
                                                const std::function<void(std::string_view)>& put) {
  const auto failed = [](const std::string& what, const std::string& where, const std::string& remedy) {
    return tl::unexpected(fmt::format("{}: {}: {}", what, where, remedy));
  };
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored))
    return failed("there is no catalogue", path.string(), "give the folder of a batch with -o, or use --collect first");
  sqlite3* opened = nullptr;
  // A catalogue is replaced, never changed. So it needs no lock, and the folder may be read-only.
  const int result = sqlite3_open_v2(path.c_str(), &opened, SQLITE_OPEN_READONLY, "unix-none");
  const Database database(opened, sqlite3_close_v2);
  if (result != SQLITE_OK)
    return failed("the catalogue cannot be read", path.string(), "write it again with --collect");
  sqlite3_set_authorizer(opened, authorize, nullptr);
  sqlite3_stmt* prepared = nullptr;
  const char* rest = nullptr;
  const auto refused = [&] {
    return failed(fmt::format("the query failed ({})", sqlite3_errmsg(opened)), sql,
                  "give one SELECT on runs, targets, peaks and warnings (docs/file-formats.md)");
  };
  if (sqlite3_prepare_v2(opened, sql.c_str(), static_cast<int>(sql.size()), &prepared, &rest) != SQLITE_OK)
    return refused();
  const Statement statement(prepared, sqlite3_finalize);
  if (prepared == nullptr || std::string_view(rest).find_first_not_of("; \t\r\n") != std::string_view::npos)
    return failed("it is not one statement", sql, "give one SELECT with --query");
  const int columns = sqlite3_column_count(prepared);
  std::string line;
  for (int c = 0; c < columns; ++c) line += (c > 0 ? "," : "") + csv_field(sqlite3_column_name(prepared, c));
  put(line + "\n");
  int step = SQLITE_ROW;
  while ((step = sqlite3_step(prepared)) == SQLITE_ROW) {
    line.clear();
    for (int c = 0; c < columns; ++c) line += (c > 0 ? "," : "") + cell(prepared, c);
    put(line + "\n");
  }
  if (step != SQLITE_DONE) return refused();
  return {};
}

}  // namespace moiregauge::internal

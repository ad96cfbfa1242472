// SPDX-License-Identifier: Apache-2.0
// The catalogue of a batch: one SQLite file with the tables runs, targets, peaks and warnings.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "moiregauge/batch/collected_clip.h"

namespace moiregauge::internal {

// Writes a catalogue under another name, in one transaction, and publishes it in one step. It takes no locks, so it
// works on network file systems. There must be only one writer.
class CatalogueWriter {
 public:
  // Fails with path and reason.
  [[nodiscard]] static tl::expected<CatalogueWriter, std::string> create(const std::filesystem::path& path);
  CatalogueWriter(const CatalogueWriter&) = delete;
  CatalogueWriter& operator=(const CatalogueWriter&) = delete;
  CatalogueWriter(CatalogueWriter&&) noexcept;
  CatalogueWriter& operator=(CatalogueWriter&&) = delete;
  ~CatalogueWriter();  // without publish(): removes what was written
  // Fails with path and reason.
  [[nodiscard]] tl::expected<void, std::string> add(const CollectedClip& clip);
  [[nodiscard]] tl::expected<void, std::string> publish();

 private:
  struct State;
  explicit CatalogueWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Runs one SELECT on a catalogue and passes the lines of a CSV table to `put`: a header, then one line per row. An
// unknown number is NaN. The statement can neither change the catalogue nor open another file.
// Fails with "what happened: where: what to do".
[[nodiscard]] tl::expected<void, std::string> query_catalogue(const std::filesystem::path& path, const std::string& sql,
                                                              const std::function<void(std::string_view)>& put);

}  // namespace moiregauge::internal

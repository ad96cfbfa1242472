// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/stored_runs.h"

#include <sys/stat.h>

#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {

tl::expected<std::shared_ptr<const KeptRun>, std::string> StoredRuns::read(const std::string& path) {
  const std::lock_guard lock(mutex_);
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0)
    return tl::unexpected(fmt::format("the run has no observations: {}: measure the clip again", path));
  std::string key = fmt::format("{}\n{}\n{}\n{}", path, facts.st_size, facts.st_mtim.tv_sec, facts.st_mtim.tv_nsec);
  if (run_ && key == key_) return run_;
  auto run = recover_run(path);
  if (!run) return tl::unexpected(run.error());
  run_ = std::make_shared<const KeptRun>(*std::move(run));
  key_ = std::move(key);
  return run_;
}

}  // namespace moiregauge::internal

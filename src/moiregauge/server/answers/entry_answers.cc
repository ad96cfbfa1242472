// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/stat.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "moiregauge/image/upper_bits.h"
#include "moiregauge/io/pictures/luma_jpeg.h"
#include "moiregauge/server/answers/answers.h"
#include "moiregauge/server/api/json_body.h"

namespace moiregauge::internal {
namespace {

constexpr int kThumbnailWidth = 320;  // px

nlohmann::ordered_json entry_json(const Entry& entry) {
  nlohmann::ordered_json json{{"path", entry.path},
                              {"kind", word_for(entry.kind)},
                              {"name", std::filesystem::path(entry.path).filename().string()},
                              {"bytes", entry.bytes},
                              {"modified_s", entry.modified_s},
                              {"state", entry.state}};
  if (!entry.site.empty()) json["site"] = entry.site;
  if (!entry.run.empty()) json["run"] = entry.run;
  if (!entry.headline.empty()) json["headline"] = entry.headline;
  if (entry.exit_code) json["exit_code"] = *entry.exit_code;
  return json;
}

// A clip that waits or is measured has this state, whatever an earlier run says.
void put_job_state(const std::vector<Job>& jobs, Entry& entry) {
  for (const Job& job : jobs) {
    if (job.has_ended() || job.command.action != "measure") continue;
    if (job.command.input != entry.path && job.command.output != entry.path) continue;
    entry.state = job.state == JobState::kQueued ? "queued" : "measuring";
  }
}

}  // namespace

Answer answer_entries(ServerState& state, const Request&) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const std::vector<Job> jobs = state.queue.jobs();
  for (Entry& entry : state.entries.read()) {
    put_job_state(jobs, entry);
    list.push_back(entry_json(entry));
  }
  return {200, "application/json", {}, json_answer_text({{"entries", std::move(list)}}), nullptr, false};
}

Answer answer_thumbnail(ServerState& state, const Request& request) {
  const std::string path(request.head.parameter("path"));
  const auto full = state.folder.existing(path);
  if (!full) return no_such_path();
  const bool is_run = state.folder.existing(path + "/run.json") || state.folder.existing(path + "/run.mgj");
  const auto picture = is_run ? state.folder.existing(path + "/overlay.png") : full;
  if (!picture) return no_such_path();
  const auto frame = state.frames.frame(*picture, 0);
  if (!frame) return error_answer(422, without_root(state, frame.error()));
  const auto grey = upper_bits((*frame)->frame().luma, (*frame)->input.bits);
  Answer answer;
  answer.type = "image/jpeg";
  answer.body = luma_jpeg(shrunk_to_width(grey.view(), kThumbnailWidth).view());
  answer.headers.emplace_back("Cache-Control", "private, max-age=60");
  return answer;
}

}  // namespace moiregauge::internal

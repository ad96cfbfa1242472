// SPDX-License-Identifier: Apache-2.0
// Arguments of the commands that the page may start. Every path stays inside the folder.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Answers of the folder about paths.
struct PathRules {
  std::function<bool(std::string_view path)> exists;       // something inside the folder
  std::function<bool(std::string_view path)> can_be_made;  // its parent is inside the folder
};

struct JobCommand {
  std::string action;                  // "measure"
  std::vector<std::string> arguments;  // after the action, as the page shows them
  std::string input;                   // first path
  std::string output;                  // folder or file that it writes; relative to the folder
};

// Checks the arguments of an action against its list of options. Adds the output folder of a clip in a sub-folder, which
// would otherwise be written to the top.
// Fails with "what: where: what to do": an unknown action or option, a path outside, a text with control characters.
[[nodiscard]] tl::expected<JobCommand, std::string> job_command(std::string_view action,
                                                                const std::vector<std::string>& arguments,
                                                                const PathRules& paths);

// Returns the same command continued with --resume. Returns nothing for an action that cannot be resumed.
[[nodiscard]] std::optional<JobCommand> resumed(JobCommand command);

// Returns true for an address that `live` opens without a file: camera, rtsp, http.
[[nodiscard]] bool is_live_address(std::string_view source);

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <nlohmann/json.hpp>

#include "moiregauge/server/answers/answers.h"
#include "moiregauge/server/answers/page_files.h"
#include "moiregauge/server/api/json_body.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

// No part of the page comes from elsewhere, and no other page may show it in a frame.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
constexpr std::string_view kTokenMark = R"(<meta name="moiregauge-token" content=")";

Answer text_answer(std::string_view text, const char* type) {
  Answer answer;
  answer.type = type;
  answer.body = text;
  return answer;
}

}  // namespace

Answer answer_page(ServerState& state, const Request&) {
  Answer answer = text_answer(serve_page_html(), "text/html; charset=utf-8");
  const auto mark = answer.body.find(kTokenMark);
  // The token consists of letters and digits.
  if (state.is_token_in_page && mark != std::string::npos) answer.body.insert(mark + kTokenMark.size(), state.token);
  answer.headers.emplace_back("Content-Security-Policy", kPolicy);
  answer.headers.emplace_back("X-Frame-Options", "DENY");
  return answer;
}

Answer answer_script(ServerState&, const Request&) {
  return text_answer(serve_page_script(), "text/javascript; charset=utf-8");
}

Answer answer_style(ServerState&, const Request&) { return text_answer(serve_page_style(), "text/css; charset=utf-8"); }

Answer answer_session(ServerState& state, const Request&) {
  nlohmann::ordered_json json{{"version", kVersion},
                              {"folder", std::filesystem::path(state.folder.root()).filename().string()},
                              {"root", state.folder.root()},
                              {"commands", {"measure", "solve", "derive", "compare", "export", "inspect", "live"}},
                              {"limits", {{"upload_bytes", state.max_upload}}}};
  return {200, "application/json", {}, json_answer_text(json), nullptr, false};
}

}  // namespace moiregauge::internal

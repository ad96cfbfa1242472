// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/page_scripts.h"

#include <algorithm>

#include "moiregauge/base/control_characters.h"
#include "moiregauge/report/report_page.h"

namespace moiregauge::internal {
namespace {

// Marks in the template that are replaced by data and title.
constexpr std::string_view kDataMark = "<!--moiregauge:data-->", kTitleMark = "<!--moiregauge:title-->";
// Parts of a written page. A title and data contain no '<'.
constexpr std::string_view kTitle = "<title>", kTitleEnd = " · moiregauge</title>";
constexpr std::string_view kScript = "<script type=\"", kId = "\" id=\"", kScriptEnd = "</script>";

std::string for_html(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '&')
      safe += "&amp;";
    else
      safe += c;
  }
  return safe;
}

// `title` is escaped.
std::string page_of(std::string_view title, const std::vector<PageScript>& scripts) {
  const std::string_view page = report_template();
  const std::size_t title_at = page.find(kTitleMark), data_at = page.find(kDataMark);
  if (title_at == std::string_view::npos || data_at == std::string_view::npos || data_at < title_at) return {};
  std::string out(page.substr(0, title_at));
  out += title;
  out += page.substr(title_at + kTitleMark.size(), data_at - title_at - kTitleMark.size());
  for (const PageScript& script : scripts) {
    if (&script != &scripts.front()) out += '\n';
    out.append(kScript).append(script.type).append(kId).append(script.id).append("\">");
    out.append(script.content).append(kScriptEnd);
  }
  out += page.substr(data_at + kDataMark.size());
  return out;
}

// Returns the text between two marks, and moves `at` behind the second one.
std::optional<std::string_view> between(std::string_view page, std::string_view from, std::string_view to,
                                        std::size_t& at) {
  const std::size_t begin = page.find(from, at);
  if (begin == std::string_view::npos) return std::nullopt;
  const std::size_t first = begin + from.size(), end = page.find(to, first);
  if (end == std::string_view::npos) return std::nullopt;
  at = end + to.size();
  return page.substr(first, end - first);
}

std::vector<PageScript> scripts_in(std::string_view page, std::size_t at) {
  std::vector<PageScript> scripts;
  while (true) {
    const auto head = between(page, kScript, "\">", at);
    const std::size_t id = head ? head->find(kId) : std::string_view::npos;
    const std::size_t end = page.find(kScriptEnd, at);
    if (id == std::string_view::npos || end == std::string_view::npos) return scripts;
    scripts.push_back({std::string(head->substr(id + kId.size())), std::string(head->substr(0, id)),
                       std::string(page.substr(at, end - at))});
    at = end + kScriptEnd.size();
  }
}

}  // namespace

std::string for_script(std::string_view json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

std::string assembled_page(const std::string& title, const std::vector<PageScript>& scripts) {
  return page_of(for_html(with_controls_escaped(title)), scripts);
}

std::optional<std::string> page_with(std::string_view page, const PageScript& script) {
  std::size_t at = 0;
  const auto title = between(page, kTitle, kTitleEnd, at);
  if (!title) return std::nullopt;
  std::vector<PageScript> scripts = scripts_in(page, at);
  const auto with_id = [&](std::string_view id) {
    return std::find_if(scripts.begin(), scripts.end(), [&](const PageScript& one) { return one.id == id; });
  };
  for (const char* id : {"report", "run", "samples"}) {
    if (with_id(id) == scripts.end()) return std::nullopt;
  }
  const auto old = with_id(script.id);
  if (old != scripts.end())
    *old = script;
  else
    scripts.push_back(script);
  return page_of(*title, scripts);
}

const std::vector<Status>& page_statuses() {
  static const std::vector<Status> statuses{Status::kOk,          Status::kUntrusted,     Status::kCameraMoved,
                                            Status::kBlurred,     Status::kSaturated,     Status::kPartlyCovered,
                                            Status::kLost,        Status::kReferenceLost, Status::kOrderUnproven,
                                            Status::kDecodeError, Status::kTooCoarse};
  return statuses;
}

double status_code(Status status) {
  const auto& all = page_statuses();
  return static_cast<double>(std::find(all.begin(), all.end(), status) - all.begin());
}

}  // namespace moiregauge::internal

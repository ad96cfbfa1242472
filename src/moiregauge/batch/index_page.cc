// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/index_page.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/rounded_text.h"

namespace moiregauge::internal {
namespace {

using PageJson = nlohmann::ordered_json;

constexpr std::string_view kPlaceOfClips = "/*clips*/";
constexpr double kCoverage = 2.0;  // U = 2 u

PageJson page_number(double value) { return std::isfinite(value) ? PageJson(value) : PageJson(nullptr); }

PageJson target_entry(const TargetOfRun& target) {
  const bool is_x = target.axis() == 'x';
  const double expanded = kCoverage * (is_x ? target.u.x : target.u.y);
  PageJson json{{"marker", one_line(target.marker)},
                {"axis", is_x ? "dx" : "dy"},
                {"p2p", page_number(is_x ? target.peak_to_peak.x : target.peak_to_peak.y)},
                {"U", page_number(expanded)},
                {"digits", std::isfinite(expanded) ? decimals_for(expanded, 4) : 4},
                {"frames", target.frames},
                {"ok", target.ok},
                {"plot", target.plot}};
  if (const PeakOfRun* peak = target.strongest_peak()) {
    json["f1"] = page_number(peak->frequency_hz);
    json["u_f1"] = page_number(peak->u_frequency_hz);
  }
  return json;
}

}  // namespace

PageParts page_parts() {
  const std::string_view page = index_page_template();
  const auto place = page.find(kPlaceOfClips);
  return {page.substr(0, place), page.substr(place + kPlaceOfClips.size())};
}

std::string page_entry(const CollectedClip& clip) {
  PageJson json{{"run", clip.clip.name}, {"clip", one_line(clip.clip.input)}, {"lamp", word_for(lamp_of(clip))}};
  if (clip.is_finished()) {
    json["exit"] = clip.state->exit_code;
    json["seconds"] = std::round(10.0 * clip.state->wall_s) / 10.0;
    json["message"] = one_line(clip.state->message);
  }
  if (clip.run) {
    json["targets"] = PageJson::array();
    for (const TargetOfRun& target : clip.run->targets) json["targets"].push_back(target_entry(target));
  }
  // `<` would end the script element or begin a comment in it.
  std::string text;
  for (const char c : json.dump()) text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return text;
}

}  // namespace moiregauge::internal

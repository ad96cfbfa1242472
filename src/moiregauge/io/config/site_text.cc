// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "moiregauge/io/config/site_file.h"
#include "moiregauge/io/config/toml_text.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Returns the shortest number of degrees that reads back to the same radians: 0.3, not 0.30000000000000004.
std::string degrees(double radians) {
  for (int digits = 6; digits <= 17; ++digits) {
    std::string text = fmt::format("{:.{}g}", degrees_from_radians(radians), digits);
    if (radians_from_degrees(std::stod(text)) == radians) {
      return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
    }
  }
  return toml_real(degrees_from_radians(radians));
}

std::string pair(double x, double y) { return fmt::format("[{}, {}]", toml_real(x), toml_real(y)); }

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

std::string marker_text(const Marker& marker) {
  std::string text = fmt::format("\n[[{}]]\nname = {}\n", marker.role == Role::kReference ? "reference" : "target",
                                 quoted(marker.name));
  if (marker.circle) {
    text += fmt::format("circle_mm = {}\n", pair(marker.circle->centre.x, marker.circle->centre.y));
    if (marker.circle->diameter_mm > 0.0)
      text += fmt::format("circle_diameter_mm = {}\n", toml_real(marker.circle->diameter_mm));
  }
  if (marker.grating) {
    const Grating& grating = *marker.grating;
    text += fmt::format("grating_mm = {}\ngrating_size_mm = {}\npitch_mm = {}\npattern = \"{}\"\n",
                        pair(grating.centre.x, grating.centre.y), pair(grating.width_mm, grating.height_mm),
                        toml_real(grating.pitch_mm), word_for(grating.pattern));
    if (grating.angle_rad != 0.0) text += fmt::format("angle_deg = {}\n", degrees(grating.angle_rad));
  }
  if (marker.z_mm) text += fmt::format("z_mm = {}\n", toml_real(*marker.z_mm));
  return text;
}

std::string channel_text(const ChannelText& channel) {
  std::string text = fmt::format("\n[[channel]]\nname = {}\n", quoted(channel.name));
  if (!channel.unit.empty()) text += fmt::format("unit = {}\n", quoted(channel.unit));
  return text + fmt::format("expression = {}\n", quoted(channel.expression));
}

}  // namespace

std::string write_site(const Site& site, const std::vector<ChannelText>& channels) {
  std::string text = "# Lengths in millimetres; x right, y up, z towards the camera.\n";
  for (const Marker& marker : site.markers) text += marker_text(marker);
  for (const ChannelText& channel : channels) text += channel_text(channel);
  const KnownTo& known_to = site.known_to;
  text += fmt::format("\n[known_to]\nposition_mm = {}\nrotation_deg = {}\nheight_mm = {}\nprint_scale = {}\n",
                      toml_real(known_to.position_mm), degrees(known_to.rotation_rad), toml_real(known_to.height_mm),
                      toml_real(known_to.print_scale));
  return text;
}

}  // namespace moiregauge::internal

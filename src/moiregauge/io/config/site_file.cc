// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/site_file.h"

#include <cmath>
#include <exception>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/base/control_characters.h"
#include "moiregauge/io/config/toml_table.h"
#include "moiregauge/io/config/toml_version.h"
#include "moiregauge/results/derived/channel_parser.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Defaults of [grating] for all markers.
struct Print {
  std::optional<double> pitch_mm;
  bool pitch_is_wrong = false;  // stated, but reported as a mistake
  double angle_rad = 0.0;
  Pattern pattern = Pattern::kAuto;
};

// Reads the three keys that [grating] and markers share.
Print read_print(const TomlTable& table, Print print) {
  if (table.has("pitch_mm")) {
    print.pitch_mm = table.number_above_zero("pitch_mm");
    print.pitch_is_wrong = !print.pitch_mm;
  }
  if (const auto degrees = table.number("angle_deg")) print.angle_rad = radians_from_degrees(*degrees);
  if (const auto word = table.text("pattern")) {
    const auto pattern = pattern_named(*word);
    if (pattern) print.pattern = *pattern;
    if (!pattern) {
      table.mistake("pattern", fmt::format("the pattern \"{}\" is unknown, use auto, grid, squares, dots, lines-x, "
                                           "lines-y, checkerboard or cosine",
                                           *word));
    }
  }
  return print;
}

std::optional<Circle> read_circle(const TomlTable& table) {
  const auto diameter = table.number_above_zero("circle_diameter_mm");
  const auto centre = table.pair("circle_mm");
  if (!table.has("circle_mm") && table.has("circle_diameter_mm")) {
    table.mistake("circle_diameter_mm", "circle_mm is missing, give the circle's centre");
  }
  if (!centre) return std::nullopt;
  return Circle{{(*centre)[0], (*centre)[1]}, diameter.value_or(0.0)};
}

// Largest number of pitches along x times along y in one grating. Detection needs 3 kB per pitch, 300 MB at this limit.
// An image of 64 Mpx has no more at 25 px per pitch.
constexpr double kMaxPitches = 1e5;

// Checks that the grating holds at least one pitch, and at most kMaxPitches.
void check_size(const TomlTable& table, const Grating& grating, const char* key) {
  if (grating.width_mm <= 0.0 || grating.height_mm <= 0.0) {
    table.mistake(key, fmt::format("{} must be greater than 0 in both directions", key));
  } else if (grating.pitch_mm > 0.0 && std::fmax(grating.width_mm, grating.height_mm) < grating.pitch_mm) {
    table.mistake(key, fmt::format("a grating of {} x {} mm cannot hold one pitch of {} mm", grating.width_mm,
                                   grating.height_mm, grating.pitch_mm));
  } else if (grating.pitch_mm > 0.0) {
    const double pitches =
        std::ceil(grating.width_mm / grating.pitch_mm) * std::ceil(grating.height_mm / grating.pitch_mm);
    if (pitches > kMaxPitches)
      table.mistake(key,
                    fmt::format("a grating of {:g} x {:g} mm has {:.2g} pitches of {:g} mm, more than {:g}, give the "
                                "size of a part of it",
                                grating.width_mm, grating.height_mm, pitches, grating.pitch_mm, kMaxPitches));
  }
}

std::optional<Grating> read_grating(const TomlTable& table, const Print& general) {
  const Print print = read_print(table, general);
  const auto centre = table.pair("grating_mm");
  const auto size = table.pair("grating_size_mm");
  if (!table.has("grating_mm")) {
    for (const char* key : {"grating_size_mm", "pitch_mm", "pattern", "angle_deg"}) {
      if (table.has(key))
        table.mistake(key, fmt::format("{} is given without grating_mm, give the grating's centre", key));
    }
    return std::nullopt;
  }
  if (!table.has("grating_size_mm"))
    table.mistake("grating_mm", "grating_size_mm is missing, give the grating's width and height");
  if (!print.pitch_mm && !print.pitch_is_wrong) {
    table.mistake("grating_mm", "the pitch is missing, give pitch_mm in [grating] or in this marker");
  }
  if (!centre || !size) return std::nullopt;
  const Grating grating{{(*centre)[0], (*centre)[1]}, (*size)[0],      (*size)[1],
                        print.pitch_mm.value_or(0.0), print.angle_rad, print.pattern};
  check_size(table, grating, "grating_size_mm");
  return grating;
}

std::string read_name(const TomlTable& table, const std::string& fallback) {
  std::string name = table.text("name").value_or(fallback);
  if (const auto problem = name_problem(name)) table.mistake("name", *problem);
  return name;
}

Marker read_marker(const toml::value& entry, Role role, const Print& general, const std::string& fallback_name,
                   TomlMistakes& mistakes) {
  const TomlTable table(entry, mistakes);
  table.refuse_keys_outside({"name", "circle_mm", "circle_diameter_mm", "grating_mm", "grating_size_mm", "pitch_mm",
                             "pattern", "angle_deg", "z_mm"});
  Marker marker;
  marker.role = role;
  marker.name = read_name(table, fallback_name);
  marker.circle = read_circle(table);
  marker.grating = read_grating(table, general);
  marker.z_mm = table.number("z_mm");
  if (!table.has("circle_mm") && !table.has("grating_mm")) {
    table.mistake("name", fmt::format("marker \"{}\" has neither circle_mm nor grating_mm", marker.name));
  } else if (role == Role::kTarget && !table.has("grating_mm")) {
    table.mistake("circle_mm", fmt::format("target \"{}\" has no grating, add grating_mm, grating_size_mm and a pitch",
                                           marker.name));
  }
  return marker;
}

// Largest number of gratings at one position: lines along each axis, and two to spare. Detection searches each of them
// in the pixels of all, so hundreds would take minutes per frame.
constexpr int kMaxSharing = 4;

// Returns true if the two overlap by more than half of the smaller one.
bool share_a_place(const Grating& a, const Grating& b) {
  const auto common = [](double distance, double first, double second) {
    return std::fmax(0.0, std::fmin(std::fmin(first, second), 0.5 * (first + second) - std::fabs(distance)));
  };
  const double overlap = common(b.centre.x - a.centre.x, a.width_mm, b.width_mm) *
                         common(b.centre.y - a.centre.y, a.height_mm, b.height_mm);
  return overlap > 0.5 * std::fmin(a.width_mm * a.height_mm, b.width_mm * b.height_mm);
}

// Returns true if the last grating overlaps too many earlier ones.
bool is_one_too_many(const Site& site) {
  const auto& last = site.markers.back().grating;
  if (!last) return false;
  int sharing = 1;
  for (std::size_t i = 0; i + 1 < site.markers.size(); ++i) {
    if (site.markers[i].grating && share_a_place(*site.markers[i].grating, *last)) ++sharing;
  }
  return sharing > kMaxSharing;
}

// Reads [[reference]] or [[target]] in the order of the file.
void read_site_markers(const TomlTable& top, Role role, const Print& general, Site& site, TomlMistakes& mistakes) {
  const std::string key = role == Role::kReference ? "reference" : "target";
  const toml::value* list = top.find(key);
  if (list == nullptr) return;
  if (!list->is_array()) {
    top.mistake(key, fmt::format("write [[{}]] with two brackets", key));
    return;
  }
  int count = 0;
  bool is_crowded = false;  // report it once
  for (const toml::value& entry : list->as_array(std::nothrow)) {
    if (!entry.is_table()) {
      mistakes.add_at(entry, fmt::format("{} must be a table, write [[{}]]", key, key));
      continue;
    }
    const std::string fallback = fmt::format("{}{}", role == Role::kReference ? "R" : "T", ++count);
    site.markers.push_back(read_marker(entry, role, general, fallback, mistakes));
    for (std::size_t i = 0; i + 1 < site.markers.size(); ++i) {
      if (site.markers[i].name != site.markers.back().name) continue;
      TomlTable(entry, mistakes)
          .mistake("name", fmt::format("a marker named \"{}\" already exists", site.markers[i].name));
    }
    if (!is_crowded && is_one_too_many(site)) {
      is_crowded = true;
      TomlTable(entry, mistakes)
          .mistake("grating_mm",
                   fmt::format("more than {} gratings overlap here, a printed grating is one marker", kMaxSharing));
    }
  }
}

KnownTo read_known_to(const TomlTable& table) {
  table.refuse_keys_outside({"position_mm", "rotation_deg", "height_mm", "print_scale"});
  KnownTo known_to;
  known_to.position_mm = table.number_not_negative("position_mm").value_or(known_to.position_mm);
  const auto degrees = table.number_not_negative("rotation_deg");
  if (degrees) known_to.rotation_rad = radians_from_degrees(*degrees);
  known_to.height_mm = table.number_not_negative("height_mm").value_or(known_to.height_mm);
  known_to.print_scale = table.number_not_negative("print_scale").value_or(known_to.print_scale);
  return known_to;
}

// Returns [grating] or [known_to], or nothing if it is absent. Adds a mistake if it is no table.
std::optional<TomlTable> section(const TomlTable& top, const std::string& key, TomlMistakes& mistakes) {
  const toml::value* value = top.find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_table()) return TomlTable(*value, mistakes);
  top.mistake(key, fmt::format("{} must be a section, write [{}]", key, key));
  return std::nullopt;
}

// Adds a mistake at its position in the expression, if the file has the expression as it is read, without escapes.
void add_channel_mistake(const toml::value& value, const std::string& expression, const ChannelMistake& mistake,
                         TomlMistakes& mistakes) {
  const TomlPosition at = position_of(value);
  const std::string text = fmt::format("{}, {}", mistake.what, mistake.remedy);
  const bool is_plain = at.column <= at.text.size() && at.text.compare(at.column, expression.size(), expression) == 0;
  mistakes.add(at.line, is_plain ? at.column + mistake.column : at.column, text);
}

// Returns the name of a channel. A mistake gives an empty one.
std::string read_channel_name(const TomlTable& table, const std::vector<ChannelText>& earlier) {
  const auto name = table.text("name");
  if (!table.has("name")) table.mistake("name", "the channel has no name, add name = \"...\"");
  if (!name) return {};
  if (const std::string problem = channel_name_problem(*name); !problem.empty()) {
    table.mistake("name", problem + ", begin with a letter, then use letters, digits and _");
    return {};
  }
  for (const ChannelText& other : earlier) {
    if (other.name != *name) continue;
    table.mistake("name", fmt::format("a channel named \"{}\" already exists", *name));
    return {};
  }
  return *name;
}

// Reads one entry. A wrong channel stays known by its name, so that no later channel is reported because of it.
void read_channel(const TomlTable& table, const std::vector<std::string>& targets, std::vector<Channel>& earlier,
                  std::vector<ChannelText>& channels, TomlMistakes& mistakes) {
  table.refuse_keys_outside({"name", "unit", "expression"});
  ChannelText text{read_channel_name(table, channels), table.text("unit").value_or(""), {}};
  if (!text.unit.empty() && !channel_unit_problem(text.unit).empty()) {
    table.mistake("unit", channel_unit_problem(text.unit) + ", write up to 16 letters, digits, / and ^");
    text.unit.clear();
  }
  const auto expression = table.text("expression");
  if (!table.has("expression"))
    table.mistake("expression", "the channel has no expression, add expression = \"...\", e.g. \"mid.dy - left.dy\"");
  if (!expression) return;
  text.expression = *expression;
  const std::string name = text.name.empty() ? fmt::format("channel_{}", channels.size() + 1) : text.name;
  auto channel = parse_channel_value(name, text.unit, text.expression, targets, earlier);
  if (!channel) add_channel_mistake(*table.find("expression"), text.expression, channel.error(), mistakes);
  earlier.push_back(channel ? *std::move(channel) : Channel{name, "", {{TermKind::kDx, {0}, 1.0}}, 0.0, ""});
  channels.push_back(std::move(text));
}

// Reads [[channel]], after the targets that it names.
void read_channels(const TomlTable& top, SiteFile& file, TomlMistakes& mistakes) {
  const toml::value* list = top.find("channel");
  if (list == nullptr) return;
  if (!list->is_array()) return top.mistake("channel", "write [[channel]] with two brackets");
  std::vector<std::string> targets;  // also those with a mistake
  for (const Marker& marker : file.site.markers) {
    if (marker.role == Role::kTarget) targets.push_back(marker.name);
  }
  std::vector<Channel> earlier;
  for (const toml::value& entry : list->as_array(std::nothrow)) {
    if (!entry.is_table()) {
      mistakes.add_at(entry, "channel must be a table, write [[channel]]");
    } else if (file.channels.size() == kMaxChannels) {
      mistakes.add_at(entry, fmt::format("there are more than {} channels, remove some", kMaxChannels));
      return;
    } else {
      read_channel(TomlTable(entry, mistakes), targets, earlier, file.channels, mistakes);
    }
  }
}

SiteFile read_top(const toml::value& file, TomlMistakes& mistakes) {
  SiteFile out;
  Site& site = out.site;
  const TomlTable top(file, mistakes);
  top.refuse_keys_outside({"grating", "reference", "target", "channel", "known_to"});
  Print print;
  if (const auto grating = section(top, "grating", mistakes)) {
    grating->refuse_keys_outside({"pitch_mm", "pattern", "angle_deg"});
    print = read_print(*grating, print);
  }
  read_site_markers(top, Role::kReference, print, site, mistakes);
  read_site_markers(top, Role::kTarget, print, site, mistakes);
  if (!top.has("target")) mistakes.add(1, 1, "there is no [[target]], add the marker that moves");
  read_channels(top, out, mistakes);
  if (const auto known_to = section(top, "known_to", mistakes)) site.known_to = read_known_to(*known_to);
  return out;
}

}  // namespace

// Names are used in CSV cells and file names, so they must be plain. A spreadsheet evaluates a cell that begins with =,
// +, - or @ as a formula.
std::optional<std::string> name_problem(const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 64 && name.find_first_of(",;\"'/\\") == std::string::npos;
  if (!plain || name.front() == ' ' || has_control_character(name))
    return "name must be 1 to 64 characters without comma, semicolon, quote, slash or control character";
  if (std::string_view("=+-@").find(name.front()) == std::string_view::npos) return std::nullopt;
  return fmt::format("the name \"{}\" is a formula to spreadsheets, do not begin it with =, +, - or @", name);
}

tl::expected<SiteFile, SiteErrors> parse_site_file(const std::string& text, const std::string& path) {
  const auto file = parse_toml(text, path);
  if (!file) return tl::unexpected(SiteErrors{file.error()});
  try {
    TomlMistakes mistakes(path);
    SiteFile site = read_top(*file, mistakes);
    if (!mistakes.empty()) return tl::unexpected(mistakes.lines());
    return site;
  } catch (const std::exception& error) {  // toml11 throws on a type mismatch; the checks above should prevent it
    return tl::unexpected(SiteErrors{fmt::format("{}:1:1: {}", path, error.what())});
  }
}

tl::expected<SiteFile, SiteErrors> read_site_file(const std::string& path) {
  const auto text = read_small_file(path, kTextFileLimit);
  if (!text) return tl::unexpected(SiteErrors{text.error()});
  return parse_site_file(*text, path);
}

tl::expected<Site, SiteErrors> parse_site(const std::string& text, const std::string& path) {
  return parse_site_file(text, path).map([](SiteFile file) { return std::move(file.site); });
}

tl::expected<Site, SiteErrors> read_site(const std::string& path) {
  return read_site_file(path).map([](SiteFile file) { return std::move(file.site); });
}

}  // namespace moiregauge::internal

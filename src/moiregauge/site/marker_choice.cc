// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/site/marker_choice.h"

#include <algorithm>
#include <optional>

namespace moiregauge::internal {
namespace {

bool is_in(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string names_of(const Site& site) {
  std::string names;
  for (const Marker& marker : site.markers) names += (names.empty() ? "" : ", ") + marker.name;
  return names;
}

struct NamedOption {
  const char* option;
  std::vector<std::string> names;
};

std::vector<NamedOption> all_names(const MarkerChoice& choice) {
  std::vector<std::string> renamed;
  for (const NewName& name : choice.names) renamed.push_back(name.from);
  return {{"--references", choice.references},
          {"--targets", choice.targets},
          {"--ignore", choice.ignored},
          {"--name", renamed}};
}

std::optional<std::string> unknown_name(const Site& site, const MarkerChoice& choice) {
  for (const auto& [option, names] : all_names(choice)) {
    for (const std::string& name : names) {
      if (std::any_of(site.markers.begin(), site.markers.end(), [&](const Marker& m) { return m.name == name; }))
        continue;
      return "the marker does not exist: " + std::string(option) + " " + name + ": choose from " + names_of(site);
    }
  }
  return std::nullopt;
}

std::optional<std::string> chosen_twice(const MarkerChoice& choice) {
  const auto options = all_names(choice);
  for (std::size_t a = 0; a < options.size(); ++a) {
    const std::vector<std::string>& names = options[a].names;
    for (const std::string& name : names) {
      const bool is_repeated = std::count(names.begin(), names.end(), name) > 1;
      // A marker with a role may have a new name, one that is ignored may not.
      for (std::size_t b = a; b < options.size(); ++b) {
        if (b == a ? !is_repeated : !is_in(options[b].names, name) || (a < 2 && b == 3)) continue;
        return "the marker is chosen twice: " + std::string(options[a].option) + " and " + options[b].option + " " +
               name + ": name it once";
      }
    }
  }
  return std::nullopt;
}

// Role of a marker after the choice. Nothing: it is removed.
std::optional<Role> role_of(const Marker& marker, const MarkerChoice& choice) {
  if (is_in(choice.references, marker.name)) return Role::kReference;
  if (is_in(choice.targets, marker.name)) return Role::kTarget;
  const auto& own = marker.role == Role::kReference ? choice.references : choice.targets;
  if (!own.empty() || is_in(choice.ignored, marker.name)) return std::nullopt;
  return marker.role;
}

std::string new_name(const std::string& name, const MarkerChoice& choice) {
  for (const NewName& given : choice.names) {
    if (given.from == name) return given.to;
  }
  return name;
}

// Checks the site after the choice.
std::optional<std::string> problem_of(const Site& chosen) {
  for (std::size_t i = 0; i < chosen.markers.size(); ++i) {
    const Marker& marker = chosen.markers[i];
    if (marker.role == Role::kTarget && !marker.grating)
      return "the marker has no grating, which a target needs: --targets " + marker.name + ": choose another";
    for (std::size_t k = 0; k < i; ++k) {
      if (chosen.markers[k].name == marker.name)
        return "two markers have this name: --name " + marker.name + ": give each marker its own";
    }
  }
  return std::nullopt;
}

}  // namespace

bool SearchArea::holds(ImagePoint p) const {
  const auto in = [&](const PixelRegion& region) { return region.holds(p); };
  if (std::any_of(excluded.begin(), excluded.end(), in)) return false;
  return regions.empty() || std::any_of(regions.begin(), regions.end(), in);
}

std::vector<std::size_t> chosen_indices(const Site& site, const MarkerChoice& choice) {
  std::vector<std::size_t> indices;
  for (const Role role : {Role::kReference, Role::kTarget}) {
    for (std::size_t i = 0; i < site.markers.size(); ++i) {
      if (role_of(site.markers[i], choice) == role) indices.push_back(i);
    }
  }
  return indices;
}

tl::expected<Site, std::string> choose_markers(const Site& site, const MarkerChoice& choice) {
  if (auto problem = unknown_name(site, choice)) return tl::unexpected(*std::move(problem));
  if (auto problem = chosen_twice(choice)) return tl::unexpected(*std::move(problem));
  Site chosen{{}, site.known_to};
  for (const std::size_t i : chosen_indices(site, choice)) {
    Marker marker = site.markers[i];
    marker.role = *role_of(site.markers[i], choice);
    marker.name = new_name(marker.name, choice);
    chosen.markers.push_back(std::move(marker));
  }
  if (auto problem = problem_of(chosen)) return tl::unexpected(*std::move(problem));
  return chosen;
}

}  // namespace moiregauge::internal

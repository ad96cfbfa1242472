// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>

#include "moiregauge/simulator/scenario/gaussian.h"
#include "moiregauge/simulator/scenario/scenario.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

// Returns the FNV-1a hash of a name. Draws depend on the name, so that adding a marker does not move the others.
std::uint64_t hash_of(const std::string& name) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

constexpr long kDrawOfPlaces = -1;  // frame number of these draws; the noise of frames has numbers from 0

}  // namespace

std::uint64_t own_seed(const Scenario& scenario, const SceneMarker& marker) {
  return hash_of(marker.print.name) + 0x9e3779b97f4a7c15U * scenario.seed;
}

SceneMarker::Place true_place(const Scenario& scenario, const SceneMarker& marker) {
  SceneMarker::Place place = marker.place;
  const Draw& draw = scenario.draw;
  // False candidates and plain points of the board are not in the site, so they have no stated uncertainty.
  if (!marker.listed || marker.print.name.empty()) return place;
  if (!(draw.position || draw.rotation || draw.height || draw.print_scale)) return place;
  const KnownTo& known = scenario.known_to;
  const Noise normal(draw.seed != 0 ? draw.seed : scenario.seed, kDrawOfPlaces);
  const std::uint64_t address = hash_of(marker.print.name);
  if (draw.position) {
    place.x_mm += known.position_mm * normal.at(address);
    place.y_mm += known.position_mm * normal.at(address + 1);
  }
  if (draw.rotation) place.rotation_deg += degrees_from_radians(known.rotation_rad) * normal.at(address + 2);
  // A target without a stated height has the scenario's place.z_mm and no drawn error.
  const bool states_height = marker.print.role == Role::kReference || marker.print.z_mm.has_value();
  if (draw.height && states_height) place.z_mm += known.height_mm * normal.at(address + 3);
  if (draw.print_scale) place.print_scale += known.print_scale * normal.at(address + 4);
  return place;
}

}  // namespace moiregauge::internal::simulator

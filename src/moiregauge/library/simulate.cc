// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulate.h"

#include <filesystem>
#include <system_error>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "moiregauge/app/load_scenario.h"
#include "moiregauge/app/simulation/write_recording.h"
#include "moiregauge/library/convert.h"
#include "moiregauge/simulator/recorder.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge {

struct Simulation::State {
  State(internal::simulator::Scenario loaded, const SimulateOptions& wanted)
      : scenario(std::move(loaded)),
        options{wanted.threads,
                wanted.markers_only ? internal::simulator::Area::kMarkersOnly : internal::simulator::Area::kWholeFrame},
        recorder(scenario, options) {}
  internal::simulator::Scenario scenario;
  internal::simulator::RenderOptions options;
  internal::simulator::Recorder recorder;
  internal::simulator::Picture latest;
};

Expected<Simulation> Simulation::load(const std::string& scenario, const SimulateOptions& options) {
  auto loaded = internal::load_scenario({scenario, options.settings, options.seed, options.frames});
  if (!loaded) return internal::public_error(internal::Exit::kUsage, loaded.error());
  return Simulation(std::make_unique<State>(*std::move(loaded), options));
}

long Simulation::frames() const { return state_->scenario.frames; }
double Simulation::fps() const { return state_->scenario.sensor.fps; }

ImageView Simulation::render(long frame) {
  state_->latest = state_->recorder.frame(frame);
  if (const auto* image = std::get_if<internal::Image<std::uint8_t>>(&state_->latest)) {
    const auto view = image->view();
    return {view.data, view.width, view.height, view.stride};
  }
  const auto view = std::get<internal::Image<std::uint16_t>>(state_->latest).view();
  return {view.data, view.width, view.height, state_->scenario.sensor.bits, view.stride};
}

std::optional<Truth> Simulation::truth(long frame, const std::string& marker) const {
  const auto* found = internal::simulator::find_marker(state_->scenario, marker);
  if (found == nullptr) return std::nullopt;
  const auto truth = internal::simulator::truth(state_->scenario, frame, *found);
  return Truth{truth.dx_mm, truth.dy_mm};
}

Expected<void> Simulation::write(const std::string& folder, const std::function<bool(long, long)>& on_progress) const {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const bool is_free = !fs::exists(folder, ignored) || fs::is_empty(folder, ignored) ||
                       fs::exists(fs::path(folder) / "truth-camera.toml", ignored);
  if (!is_free)
    return internal::public_error(internal::Exit::kUsage,
                                  fmt::format("the output folder holds other files: {}: choose another", folder));
  const internal::RecordingPlan plan{std::nullopt, state_->options.area, state_->options.threads, on_progress};
  if (const auto written = internal::write_recording(state_->scenario, plan, folder); !written)
    return internal::public_error(internal::Exit::kOutputUnwritable,
                                  fmt::format("the recording could not be written: {}: free space or choose another "
                                              "folder",
                                              written.error()));
  return {};
}

Site Simulation::site() const { return internal::to_public(internal::simulator::site_of(state_->scenario)); }

Simulation::Simulation(std::unique_ptr<State> state) : state_(std::move(state)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

}  // namespace moiregauge

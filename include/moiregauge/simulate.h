// SPDX-License-Identifier: Apache-2.0
// Rendering of recordings with known truth. It shares no formulas with the measurement.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/image.h"
#include "moiregauge/site.h"

namespace moiregauge {

struct SimulateOptions {
  std::vector<std::string> settings;  // "lens.k1=-0.02", as --set
  std::optional<std::uint64_t> seed;
  std::optional<long> frames;
  bool markers_only = false;  // only windows around the markers are rendered, the rest is flat grey
  int threads = 0;            // 0: one per core; the number does not change the result
};

struct Truth {
  double dx_mm = 0.0, dy_mm = 0.0;  // since frame 0, mean over the exposure
};

// A scenario that renders its frames on request.
class Simulation {
 public:
  // Loads a built-in scenario ("small-1xyz", ...) or a TOML file.
  // Fails (kUsage): an unknown name, or mistakes in file or settings.
  [[nodiscard]] static MOIREGAUGE_API Expected<Simulation> load(const std::string& scenario,
                                                                const SimulateOptions& options = {});
  [[nodiscard]] MOIREGAUGE_API long frames() const;
  [[nodiscard]] MOIREGAUGE_API double fps() const;
  // Renders one frame. The view is valid until the next call. Ascending numbers are fastest.
  [[nodiscard]] MOIREGAUGE_API ImageView render(long frame);
  // Returns the true displacement of a marker; nothing if there is no marker of this name.
  [[nodiscard]] MOIREGAUGE_API std::optional<Truth> truth(long frame, const std::string& marker) const;
  // Writes the recording as `moiregauge simulate` does: frames/%06d.png, site.toml, truth.csv and truth-camera.toml.
  // `on_progress` receives frames written and expected, from any thread but one at a time; false stops. It may be empty.
  // Fails: the folder holds other files (kUsage), it cannot be written, or it was stopped (kOutput).
  [[nodiscard]] MOIREGAUGE_API Expected<void> write(const std::string& folder,
                                                    const std::function<bool(long, long)>& on_progress = {}) const;
  // Returns the site as a user would state it.
  [[nodiscard]] MOIREGAUGE_API Site site() const;

  MOIREGAUGE_API Simulation(Simulation&&) noexcept;
  MOIREGAUGE_API Simulation& operator=(Simulation&&) noexcept;
  MOIREGAUGE_API ~Simulation();

 private:
  struct State;
  explicit Simulation(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace moiregauge

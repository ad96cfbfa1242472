// SPDX-License-Identifier: Apache-2.0
// Options of the outlets of a live run.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <tl/expected.hpp>

#include "moiregauge/app/usage_error.h"
#include "moiregauge/live/publish/open_publishers.h"

namespace moiregauge::internal::cli {

// Options as typed.
struct OutletTexts {
  std::vector<std::string> publish;
  std::vector<std::string> alarms;
  std::string listen;
  std::string record;
  std::string record_full;
  std::string mqtt_ca;
};

// Adds --publish, --listen, --alarm, --record, --record-full and --mqtt-ca.
void add_outlet_options(CLI::App& command, OutletTexts& texts);

// Opens the outlets. alarms.csv and recordings appear in `folder`-alarms, next to the run's folder.
// `display` receives alarms too. Fails with the first mistake.
[[nodiscard]] tl::expected<Publishers, UsageError> open_outlets(const OutletTexts& texts, const std::string& folder,
                                                                AlarmListener& display);

}  // namespace moiregauge::internal::cli

// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace moiregauge::internal::cli {

// Adds `moiregauge calibrate PHOTOS... --pitch LENGTH [-o camera.toml]`.
void add_calibrate(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli

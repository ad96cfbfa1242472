// SPDX-License-Identifier: Apache-2.0
// Conversion between the public types and those of the internals.
#pragma once

#include "moiregauge/app/measurement_run.h"
#include "moiregauge/image.h"
#include "moiregauge/measure.h"

namespace moiregauge::internal {

[[nodiscard]] moiregauge::Camera to_public(const Camera& camera);
[[nodiscard]] Camera to_internal(const moiregauge::Camera& camera);

[[nodiscard]] LumaView to_luma(const moiregauge::ImageView& image);

[[nodiscard]] moiregauge::Site to_public(const Site& site);
// Fails (kUsage): the site has mistakes, as a site file would.
[[nodiscard]] moiregauge::Expected<Site> to_internal(const moiregauge::Site& site);

[[nodiscard]] moiregauge::Status public_status(Status status);
[[nodiscard]] moiregauge::Sample to_public(const Sample& sample);
[[nodiscard]] moiregauge::Result to_result(const Measurement& measured, const MeasureOptions& options);

// Fails (kUsage): options that exclude each other, or files with mistakes.
[[nodiscard]] moiregauge::Expected<MeasureOptions> to_internal(const moiregauge::MeasureOptions& options);

[[nodiscard]] tl::unexpected<moiregauge::Error> public_error(Exit exit, std::string message);

}  // namespace moiregauge::internal

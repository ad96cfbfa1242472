// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/site.h"

#include "moiregauge/app/measure_options.h"
#include "moiregauge/camera.h"
#include "moiregauge/io/config/site_file.h"
#include "moiregauge/library/convert.h"

namespace moiregauge {

Expected<Site> read_site(const std::string& path) {
  const auto site = internal::site_of_file(path);
  if (!site) return internal::public_error(internal::Exit::kUsage, site.error().message);
  return internal::to_public(*site);
}

std::string site_text(const Site& site) {
  const auto converted = internal::to_internal(site);
  return converted ? internal::write_site(*converted) : std::string{};
}

Expected<Camera> read_camera(const std::string& path) {
  internal::MeasureOptions options;
  if (const auto taken = internal::take_camera(path, options); !taken)
    return internal::public_error(internal::Exit::kUsage, taken.error().message);
  return internal::to_public(*options.camera);
}

}  // namespace moiregauge

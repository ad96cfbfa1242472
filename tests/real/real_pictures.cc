// SPDX-License-Identifier: Apache-2.0
#include "real/real_pictures.h"

#include <cmath>
#include <stdexcept>

#include "moiregauge/io/picture_file.h"
#include "moiregauge/io/picture_source.h"
#include "moiregauge/io/site_file.h"

namespace moiregauge::test {
namespace {

std::string place(const std::string& set) { return std::string(MOIREGAUGE_SOURCE_DIR) + "/tests/real/data/" + set; }

}  // namespace

Site real_site(const std::string& set) {
  auto site = read_site(place(set) + "/site.toml");
  if (!site) throw std::runtime_error(site.error().front());
  return std::move(*site);
}

Picture real_picture(const std::string& set, const std::string& file) {
  auto picture = read_picture(place(set) + "/" + file);
  if (!picture) throw std::runtime_error(picture.error().message);
  return std::move(*picture);
}

Measurement real_run(const std::string& set, const std::string& method) {
  MeasureOptions options;
  options.site = real_site(set);
  options.method = method_named(method);
  auto measured = measure([&] { return open_pictures(place(set), {}); }, options, {});
  if (!measured) throw std::runtime_error(measured.error().message);
  return std::move(*measured);
}

const Sample& second_view(const Measurement& measurement) {
  for (const Sample& sample : measurement.samples) {
    if (sample.frame == 1) return sample;
  }
  throw std::runtime_error("no second view: " + measurement.refusal);
}

double null_px(const Measurement& measurement) {
  const Sample& sample = second_view(measurement);
  const BoardPoint where = measurement.reference->site.markers[sample.marker].grating->centre;
  return std::hypot(sample.displacement.x, sample.displacement.y) / measurement.reference->view.mm_per_px(where);
}

}  // namespace moiregauge::test

// SPDX-License-Identifier: Apache-2.0
#include "real/real_pictures.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "moiregauge/io/config/site_file.h"
#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/io/pictures/picture_source.h"

namespace moiregauge::internal::test {
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
  return real_run(set, method, real_site(set));
}

Measurement real_run(const std::string& set, const std::string& method, Site site) {
  MeasureOptions options;
  options.site = std::move(site);
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

double rms_null_px(const Measurement& measurement) {
  double squares = 0.0, count = 0.0;
  for (const Sample& sample : measurement.samples) {
    if (sample.frame != 1) continue;
    const BoardPoint where = measurement.reference->site.markers[sample.marker].grating->centre;
    squares += std::pow(length(sample.displacement) / measurement.reference->view.mm_per_px(where), 2);
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

Site nine_patches(const std::string& set) {
  Site site = real_site(set);
  const auto is_target = [](const Marker& m) { return m.role == Role::kTarget; };
  const Marker middle = *std::find_if(site.markers.begin(), site.markers.end(), is_target);
  std::erase_if(site.markers, is_target);
  for (const double y : {1.0, 0.0, -1.0}) {
    for (const double x : {-1.0, 0.0, 1.0}) {
      Marker patch = middle;
      const double step = 2.0 * middle.grating->pitch_mm;
      patch.name = "patch" + std::to_string(site.markers.size());
      patch.grating->centre = middle.grating->centre + Extent<frame::Board>{x * step, y * step};
      site.markers.push_back(patch);
    }
  }
  return site;
}

}  // namespace moiregauge::internal::test

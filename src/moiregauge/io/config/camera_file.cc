// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/camera_file.h"

#include <exception>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/io/config/camera_yaml.h"
#include "moiregauge/io/config/toml_table.h"
#include "moiregauge/io/config/toml_text.h"

namespace moiregauge::internal {
namespace {

// The simulator appends the truth of every frame to its camera file, so large files are valid.
constexpr std::size_t kCameraFileLimit = 16 * 1024 * 1024;  // bytes (chosen)

int whole_number(const TomlTable& table, const std::string& key) {
  const double read = table.number_not_negative(key).value_or(0.0);
  if (read <= 1e6 && read == static_cast<double>(static_cast<int>(read))) return static_cast<int>(read);
  table.mistake(key, fmt::format("{} must be a whole number of pixels", key));
  return 0;
}

double required(const TomlTable& table, const std::string& key) {
  if (!table.has(key)) table.mistake(key, fmt::format("[camera] requires {}, in pixels", key));
  return key.front() == 'f' ? table.number_above_zero(key).value_or(1.0) : table.number(key).value_or(0.0);
}

Camera read_table(const TomlTable& table) {
  table.refuse_keys_outside({"model", "width", "height", "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "u"});
  const std::string model = table.text("model").value_or("brown");
  if (model != "brown" && model != "opencv" && model != "pinhole") {
    table.mistake("model", fmt::format("the model \"{}\" is unknown, use \"brown\" with k1 k2 p1 p2 k3", model));
  }
  Camera camera;
  camera.width = whole_number(table, "width");
  camera.height = whole_number(table, "height");
  if (table.has("width") != table.has("height"))
    table.mistake(table.has("width") ? "width" : "height", "give width and height together, or neither");
  camera.fx = required(table, "fx");
  camera.fy = required(table, "fy");
  camera.cx = required(table, "cx");
  camera.cy = required(table, "cy");
  camera.k1 = table.number("k1").value_or(0.0);
  camera.k2 = table.number("k2").value_or(0.0);
  camera.p1 = table.number("p1").value_or(0.0);
  camera.p2 = table.number("p2").value_or(0.0);
  camera.k3 = table.number("k3").value_or(0.0);
  return camera;
}

constexpr std::array<const char*, kCameraParameters> kWidthKeys{"fx", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};

std::optional<CameraWidths> read_widths(const TomlTable& camera, TomlMistakes& mistakes) {
  const toml::value* value = camera.find("u");
  if (value == nullptr) return std::nullopt;
  if (!value->is_table()) {
    camera.mistake("u", "u must be a section, write [camera.u]");
    return std::nullopt;
  }
  const TomlTable table(*value, mistakes);
  table.refuse_keys_outside({kWidthKeys.begin(), kWidthKeys.end()});
  CameraWidths u;
  for (std::size_t k = 0; k < u.size(); ++k)
    u[k] = table.number_not_negative(kWidthKeys[k]).value_or(std::numeric_limits<double>::quiet_NaN());
  return u;
}

tl::expected<KnownCamera, std::string> parse_camera_toml(const std::string& text, const std::string& path) {
  const auto file = parse_toml(text, path, kCameraFileLimit);
  if (!file) return tl::unexpected(file.error());
  TomlMistakes mistakes(path);
  const TomlTable top(*file, mistakes);
  top.refuse_keys_outside({"camera", "truth"});  // the simulator writes [truth] (truth-camera.toml)
  const toml::value* table = top.find("camera");
  KnownCamera camera;
  if (table == nullptr || !table->is_table()) {
    mistakes.add(1, 1,
                 "there is no [camera] and no camera_matrix, give our TOML or a calibration YAML of OpenCV or ROS");
  } else {
    camera.camera = read_table(TomlTable(*table, mistakes));
    camera.u = read_widths(TomlTable(*table, mistakes), mistakes);
  }
  if (mistakes.empty()) return camera;
  std::string lines;
  for (const std::string& line : mistakes.lines()) lines += (lines.empty() ? "" : "\n") + line;
  return tl::unexpected(lines);
}

bool is_yaml(const std::string& text) {
  return text.rfind("%YAML", 0) == 0 || text.find("amera_matrix:") != std::string::npos ||
         text.find("amera_Matrix:") != std::string::npos;
}

}  // namespace

std::string write_camera(const Camera& camera, const CameraWidths& u) {
  std::string text = "# Pixels. OpenCV's lens model and signs. u: standard uncertainties (k = 1).\n[camera]\n";
  if (camera.width > 0) text += fmt::format("width = {}\nheight = {}\n", camera.width, camera.height);
  const std::pair<const char*, double> keys[] = {{"fx", camera.fx}, {"fy", camera.fy}, {"cx", camera.cx},
                                                 {"cy", camera.cy}, {"k1", camera.k1}, {"k2", camera.k2},
                                                 {"p1", camera.p1}, {"p2", camera.p2}, {"k3", camera.k3}};
  for (const auto& [key, value] : keys) text += fmt::format("{} = {}\n", key, toml_real(value));
  text += "\n[camera.u]\n";
  for (std::size_t k = 0; k < u.size(); ++k) {
    if (u[k] > 0.0) text += fmt::format("{} = {}\n", kWidthKeys[k], toml_real(u[k]));
  }
  return text;
}

tl::expected<KnownCamera, std::string> parse_known_camera(const std::string& text, const std::string& path) {
  try {
    if (!is_yaml(text)) return parse_camera_toml(text, path);
    return parse_camera_yaml(text, path).map([](const Camera& camera) { return KnownCamera{camera, {}}; });
  } catch (const std::exception& error) {  // toml11 can throw; the checks above should prevent it
    return tl::unexpected(fmt::format("{}:1:1: {}", path, error.what()));
  }
}

tl::expected<KnownCamera, std::string> read_known_camera(const std::string& path) {
  const auto text = read_small_file(path, kCameraFileLimit);
  if (!text) return tl::unexpected(text.error());
  return parse_known_camera(*text, path);
}

tl::expected<Camera, std::string> parse_camera(const std::string& text, const std::string& path) {
  return parse_known_camera(text, path).map([](const KnownCamera& known) { return known.camera; });
}

tl::expected<Camera, std::string> read_camera(const std::string& path) {
  return read_known_camera(path).map([](const KnownCamera& known) { return known.camera; });
}

}  // namespace moiregauge::internal

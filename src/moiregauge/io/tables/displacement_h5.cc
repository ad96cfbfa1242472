// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/displacement_h5.h"

#include <hdf5.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

// Owns an object of the library and closes it.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

// Creates the file in memory, growing by kGrowBy bytes, because the library crashes at exit if the disk is full.
constexpr std::size_t kGrowBy = std::size_t{1} << 20;
hid_t in_memory() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, kGrowBy, /*backing_store=*/0);
  return access;
}

// Omits creation times, which differ from run to run.
hid_t without_times() {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(creation, 0);
  return creation;
}

hid_t text_type(std::size_t size, H5T_cset_t letters) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, std::max<std::size_t>(size, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, letters);
  return type;
}

void say(hid_t object, const char* name, const std::string& text) {
  const Handle type(text_type(text.size(), H5T_CSET_UTF8), H5Tclose), scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  H5Awrite(attribute, type, text.empty() ? "" : text.c_str());
}

void say(hid_t object, const char* name, long number) {
  const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, H5T_STD_I64LE, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  H5Awrite(attribute, H5T_NATIVE_LONG, &number);
}

struct Column {
  const char* name;
  const char* unit;
  hid_t stored, given;  // types: in the file, in memory
  const void* data;
  hsize_t rows;
};

void put_column(hid_t group, const Column& column) {
  const Handle space(H5Screate_simple(1, &column.rows, nullptr), H5Sclose), creation(without_times(), H5Pclose);
  const Handle set(H5Dcreate2(group, column.name, column.stored, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
  if (column.rows > 0) H5Dwrite(set, column.given, H5S_ALL, H5S_ALL, H5P_DEFAULT, column.data);
  say(set, "unit", column.unit);
}

void put_target(hid_t file, const std::string& group_name, const std::string& marker,
                const std::vector<const Sample*>& rows) {
  const Handle group(H5Gcreate2(file, group_name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  say(group, "marker", marker);
  const auto reals = [&](const char* name, const char* unit, auto value) {
    std::vector<double> numbers;
    numbers.reserve(rows.size());
    for (const Sample* row : rows) numbers.push_back(value(*row));
    put_column(group, {name, unit, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, numbers.data(), numbers.size()});
  };
  std::vector<long> frames;
  frames.reserve(rows.size());
  for (const Sample* row : rows) frames.push_back(row->frame);
  put_column(group, {"frame", "1", H5T_STD_I64LE, H5T_NATIVE_LONG, frames.data(), frames.size()});
  reals("time_s", "s", [](const Sample& s) { return s.time_s; });
  reals("dx_mm", "mm", [](const Sample& s) { return s.displacement.x; });
  reals("dy_mm", "mm", [](const Sample& s) { return s.displacement.y; });
  reals("u_dx_mm", "mm", [](const Sample& s) { return s.u.x; });
  reals("u_dy_mm", "mm", [](const Sample& s) { return s.u.y; });
  constexpr std::size_t kWord = 16;  // bytes: the longest status word, padded with zeros
  std::string words;
  for (const Sample* row : rows) {
    std::string word = word_for(row->status);
    word.resize(kWord);
    words += word;
  }
  // Octave cannot read UTF-8 strings.
  const Handle type(text_type(kWord, H5T_CSET_ASCII), H5Tclose);
  put_column(group, {"status", "", type, type, words.data(), rows.size()});
}

// Writes the group `camera`. Unlike a target's group it has no attribute `marker`.
void put_camera(hid_t file, const std::vector<CameraRow>& rows) {
  const Handle group(H5Gcreate2(file, "camera", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  std::vector<long> frames;
  std::vector<double> numbers;
  frames.reserve(rows.size());
  for (const CameraRow& row : rows) frames.push_back(row.frame);
  numbers.reserve(rows.size());
  for (const CameraRow& row : rows) numbers.push_back(row.time_s);
  put_column(group, {"frame", "1", H5T_STD_I64LE, H5T_NATIVE_LONG, frames.data(), frames.size()});
  put_column(group, {"time_s", "s", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, numbers.data(), numbers.size()});
  for (const CameraColumn& column : kCameraColumns) {
    numbers.clear();
    for (const CameraRow& row : rows) numbers.push_back(column.value(row.pose));
    put_column(group, {column.name, column.unit, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, numbers.data(), numbers.size()});
  }
}

// Returns a unique group name. A slash would separate groups, and "." is the current group.
std::string group_name(const std::string& marker, const std::vector<std::string>& taken) {
  std::string name = marker;
  std::replace(name.begin(), name.end(), '/', '_');
  std::replace(name.begin(), name.end(), '\0', '_');
  if (name.empty() || name == "." || name == "..") name += "_";
  while (std::find(taken.begin(), taken.end(), name) != taken.end()) name += "_";
  return name;
}

std::string file_image(hid_t file) {
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  std::string bytes(static_cast<std::size_t>(std::max<ssize_t>(size, 0)), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size) bytes.clear();
  return bytes;
}

}  // namespace

std::string displacement_h5(const RunTable& table) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are reported by this program
  const Handle access(in_memory(), H5Pclose);
  const Handle file(H5Fcreate("displacement.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose);
  say(file, "moiregauge", table.version);
  say(file, "method", table.method);
  say(file, "input", table.input);
  say(file, "input_sha256", table.input_sha256);
  say(file, "reference_frame", table.reference_frame);
  say(file, "complete", static_cast<long>(table.complete));
  std::vector<std::string> taken;
  if (!table.camera.empty()) {
    put_camera(file, table.camera);
    taken.emplace_back("camera");
  }
  for (std::size_t i = 0; i < table.markers.size(); ++i) {
    std::vector<const Sample*> rows;
    for (const Sample& sample : table.samples) {
      if (sample.marker == i) rows.push_back(&sample);
    }
    taken.push_back(group_name(table.markers[i].name, taken));
    put_target(file, taken.back(), table.markers[i].name, rows);
  }
  return file_image(file);
}

std::string displacement_h5(const Measurement& measurement, const MeasureOptions& options) {
  RunTable table;
  table.version = kVersion;
  table.method = options.method->name;
  table.input = measurement.input.path;
  table.input_sha256 = measurement.input.sha256;
  table.reference_frame = measurement.reference->seen.frame;
  table.complete = !measurement.interrupted && !measurement.input_damaged;
  std::vector<std::size_t> place(site_of(measurement, options).markers.size());
  for (const TargetSummary& target : measurement.targets) {
    place[target.marker] = table.markers.size();
    table.markers.push_back({site_of(measurement, options).markers[target.marker].name, {}, 0.0});
  }
  table.camera = camera_rows(measurement);
  table.samples = measurement.samples;
  for (Sample& sample : table.samples) sample.marker = place[sample.marker];
  return displacement_h5(table);
}

}  // namespace moiregauge::internal

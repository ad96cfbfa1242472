// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/report_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "moiregauge/observation/reference/scale_check.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxWorded = 3;  // peaks of a target that are put into words
constexpr double kClock = 1e-5;        // of a frequency: no camera's clock is better
constexpr double kWorthAWord = 0.1;    // of the strongest's amplitude

int digits_for(double u) { return std::clamp(1 - static_cast<int>(std::floor(std::log10(std::max(u, 1e-9)))), 0, 6); }

// The row in which one axis is furthest from zero, among those the program stands by.
struct Furthest {
  double value = kNotMeasured, u = kNotMeasured, time_s = kNotMeasured;
  long frame = 0;
  double widest_u = 0.0;  // of all those rows: by so much it may have moved unseen
};

Furthest furthest(const Samples& samples, std::size_t marker, double Extent<frame::Board>::*axis) {
  Furthest far;
  double widest_u = 0.0;
  for (const Sample& s : samples) {
    if (s.marker != marker || s.status != Status::kOk || std::isnan(s.displacement.*axis)) continue;
    widest_u = std::max(widest_u, s.u.*axis);
    if (std::abs(s.displacement.*axis) <= std::abs(far.value)) continue;  // false of the first, which is NaN
    far = {s.displacement.*axis, s.u.*axis, s.time_s, s.frame};
  }
  far.widest_u = widest_u;
  return far;
}

std::string at(const Furthest& far) {
  return std::isnan(far.time_s) ? fmt::format("in frame {}", far.frame) : fmt::format("at {:.2f} s", far.time_s);
}

// "2.000 mm up (± 0.002 mm) at 3.10 s", or the interval within which it stayed where it was.
std::string movement(const Furthest& far, const char* above, const char* below, const char* along) {
  if (std::isnan(far.value)) return fmt::format("{} it could not be measured", along);
  if (std::abs(far.value) <= kCover95 * far.u || far.value == 0.0)
    return fmt::format("{} it did not move by more than its uncertainty of ± {:.{}f} mm", along,
                       kCover95 * far.widest_u, digits_for(kCover95 * far.widest_u));
  return fmt::format("{} {}", with_interval(far.value, far.u, above, below), at(far));
}

std::string sentence_of_target(const WordedRun& run, const TargetSummary& t) {
  const Measurement& m = run.measurement;
  const std::string& name = site_of(m, run.options).markers[t.marker].name;
  const Furthest x = furthest(m.samples, t.marker, &Extent<frame::Board>::x);
  const Furthest y = furthest(m.samples, t.marker, &Extent<frame::Board>::y);
  long beside_reference = t.ok;
  for (const Sample& s : m.samples) beside_reference -= s.marker == t.marker && s.frame == m.reference->seen.frame;
  if (beside_reference <= 0) return fmt::format("{}: no row beside the reference frame can be relied on.", name);
  const auto is_shown = [](const Furthest& f) { return !std::isnan(f.value) && std::abs(f.value) > kCover95 * f.u; };
  const std::string up = movement(y, "up", "down", "up and down");
  const std::string side = movement(x, "to the right", "to the left", "sideways");
  if (!is_shown(x) && !is_shown(y)) return fmt::format("{} did not move: {}; {}.", name, up, side);
  const bool y_first = !(std::abs(x.value) > std::abs(y.value));
  const std::string& first = y_first ? up : side;
  const std::string& second = y_first ? side : up;
  const bool moved_second = is_shown(y_first ? x : y);
  return fmt::format("{} moved {}{} {}.", name, first, moved_second ? ", and" : ";", second);
}

std::string peak_text(const Peak& peak) {
  const double expanded = std::max(kCover95 * peak.u_frequency_hz, kClock * peak.frequency_hz);
  std::string text =
      fmt::format("{:.{}f} Hz (± {:.{}f} Hz", peak.frequency_hz, digits_for(expanded), expanded, digits_for(expanded));
  if (!std::isnan(peak.damping)) {
    const double u = 100.0 * kCover95 * peak.u_damping;
    text += fmt::format("; damping {:.{}f} % ± {:.{}f} %", 100.0 * peak.damping, digits_for(u), u, digits_for(u));
  }
  return text + ")";
}

// The strongest peaks along one axis: "up and down at 1.70 Hz (...), ..."; empty without one.
std::string vibration(const AxisSpectrum& s, const char* along) {
  std::vector<Peak> peaks = s.peaks;
  std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.amplitude_mm > b.amplitude_mm; });
  if (peaks.empty()) return "";
  if (peaks.size() > kMaxWorded) peaks.resize(kMaxWorded);
  while (peaks.back().amplitude_mm < kWorthAWord * peaks.front().amplitude_mm) peaks.pop_back();
  std::string list;
  for (const Peak& peak : peaks) list += fmt::format("{}{}", list.empty() ? "" : ", ", peak_text(peak));
  return fmt::format("{} at {}", along, list);
}

void add_vibration(const std::string& name, const TargetSpectra& spectra, std::vector<std::string>& to) {
  const std::string up = vibration(spectra.y, "up and down"), side = vibration(spectra.x, "sideways");
  if (up.empty() && side.empty()) return;
  to.push_back(fmt::format("{} swings {}{}{}.", name, up, up.empty() || side.empty() ? "" : "; ", side));
}

std::string sentence_of_camera(const WordedRun& run) {
  if (run.options.method->name == "conventional")
    return "The camera was taken to stand still: this method does not take its movement out.";
  double shift = kNotMeasured, turn = kNotMeasured;
  for (std::size_t n = 0; n < run.camera.shift_x_px.size(); ++n)
    shift = std::fmax(shift, std::hypot(run.camera.shift_x_px[n], run.camera.shift_y_px[n]));
  if (std::isnan(shift)) return "What the camera did could not be told: its references were not seen.";
  for (std::size_t n = 0; n < run.camera.turn_x_deg.size(); ++n)
    turn = std::fmax(turn, std::hypot(run.camera.turn_x_deg[n], run.camera.turn_y_deg[n], run.camera.turn_z_deg[n]));
  if (std::isnan(turn)) return fmt::format("The camera's picture moved by up to {:.1f} px; that is taken out.", shift);
  return fmt::format(
      "The camera turned by up to {:.2f}°, and its picture moved by up to {:.1f} px; both are taken out.", turn, shift);
}

// How far a lens moves the corner of the picture, as a part of its distance from the principal point.
double at_corner(const Camera& camera, int width, int height) {
  double most = 0.0, share = 0.0;
  for (const double x : {0.0, width - 1.0}) {
    for (const double y : {0.0, height - 1.0}) {
      const double r = std::hypot((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy), r2 = r * r;
      if (r <= most) continue;
      most = r;
      share = r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3));
    }
  }
  return share;
}

std::string sentence_of_lens(const WordedRun& run) {
  const Measurement& m = run.measurement;
  const auto camera_text = [&](const char* how, const Camera& camera) {
    const double percent = 100.0 * at_corner(camera, m.input.width, m.input.height);
    if (std::abs(percent) < 0.005)
      return fmt::format("The lens was {}: it distorts the picture's corner by less than 0.01 %.", how);
    return fmt::format("The lens was {}: it distorts the picture's corner by {}{:.2f} %.", how,
                       percent < 0.0 ? "−" : "+", std::abs(percent));
  };
  const std::optional<Scene>& scene = stated_scene(m);
  if (scene && determines_camera(*scene)) return camera_text("solved from the footage", scene->camera);
  if (scene && scene->model.radial && !run.options.camera)
    return "The lens is corrected as far as the footage shows it; its focal length is not determined.";
  if (run.options.camera) return camera_text("given", *run.options.camera);
  if (scene) return "The footage asks for no lens distortion; what it leaves open is part of the uncertainty.";
  return "No lens is known: it is taken to be free of distortion.";
}

std::string sentence_of_scale(const Reference& reference) {
  const ScaleCheck check = scale_check(reference);
  const auto& markers = reference.site.markers;
  const std::string size = short_length(check.distance_mm, "mm");
  const std::string length = check.from == check.to
                                 ? fmt::format("the print of {} is {} wide", markers[check.from].name, size)
                                 : fmt::format("{} and {} are {} apart, centre to centre", markers[check.from].name,
                                               markers[check.to].name, size);
  return fmt::format(
      "By this run one pixel shows {:.3g} mm, and {}. Check that with a tape: every result scales with it.",
      check.mm_per_px, length);
}

std::string sentence_of_rows(const WordedRun& run) {
  const Measurement& m = run.measurement;
  long rows = 0, ok = 0;
  std::map<std::string, long> counts;
  for (const Sample& s : m.samples) {
    ++rows;
    ok += s.status == Status::kOk;
    if (s.status != Status::kOk) ++counts[word_for(s.status)];
  }
  const auto frames = m.observations.size();
  const std::string all = fmt::format("{} frame{} and {} target{}", frames, frames == 1 ? "" : "s", m.targets.size(),
                                      m.targets.size() == 1 ? "" : "s");
  if (rows == ok) return fmt::format("{}: every row is ok.", all);
  std::string list;
  for (const auto& [word, count] : counts) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, word);
  return fmt::format("{}: {} of {} rows are ok; {}.", all, ok, rows, list);
}

std::string sentence_of_references(const Measurement& m) {
  if (m.references_verified) return "The references were checked against each other: none of them moved.";
  return m.reference->circles.size() <= 4 ? "That none of the references moved is not proved: it takes six to prove it."
                                          : "The references could not be checked against each other.";
}

std::string begun_large(std::string sentence) {
  if (sentence.front() >= 'a' && sentence.front() <= 'z')
    sentence.front() = static_cast<char>(sentence.front() - 'a' + 'A');
  return sentence;
}

std::string outcome_of(const Measurement& m) {
  if (m.interrupted) return "Stopped before its end";
  if (m.exit == Exit::kMeasured) return "Measured";
  return m.exit == Exit::kRefused ? "Not measured" : "Measured with gaps";
}

std::vector<std::string> advice_of(const Measurement& m) {
  std::vector<std::string> advice;
  if (!m.reference) {
    advice.emplace_back(
        "Look at the picture below: it shows everything that was recognised in the first frame. Compare it with what "
        "hangs there: every reference needs its circle whole, sharp and unshaded in the picture.");
    advice.emplace_back(
        "If it starts on a bad moment, choose another frame with --reference-frame; if the site file does not fit, "
        "correct it, or leave it away and give --pitch alone.");
    return advice;
  }
  std::map<Status, long> counts;
  for (const Sample& s : m.samples) ++counts[s.status];
  std::vector<std::pair<Status, long>> by_count(counts.begin(), counts.end());
  std::stable_sort(by_count.begin(), by_count.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [status, count] : by_count) {
    if (status == Status::kOk) continue;
    const bool is_remedied = status == Status::kUntrusted && !m.remedy.empty();
    advice.push_back(fmt::format("{} ({} row{}): {}. {}.", word_for(status), count, count == 1 ? "" : "s",
                                 words_of(status).meaning,
                                 is_remedied ? begun_large(m.remedy) : std::string(words_of(status).help)));
  }
  return advice;
}

}  // namespace

std::string with_interval(double value_mm, double u_mm, const char* above, const char* below) {
  const double expanded = kCover95 * u_mm;
  const int digits = digits_for(expanded);
  return fmt::format("{:.{}f} mm {} (± {:.{}f} mm)", std::abs(value_mm), digits, value_mm < 0.0 ? below : above,
                     expanded, digits);
}

StatusWords words_of(Status status) {
  switch (status) {
    case Status::kOk:
      return {"a number the program stands by", ""};
    case Status::kUntrusted:
      return {"what the frame shows contradicts the model by far more than its noise",
              "Give the lens with --camera, or two more references"};
    case Status::kCameraMoved:
      return {"the camera moved, which this method cannot take out", "Measure with --method precise or two-stage"};
    case Status::kBlurred:
      return {"too blurred for its uncertainty to be believed", "Expose for a shorter time, or focus better"};
    case Status::kSaturated:
      return {"grey levels at the end of the range", "Expose less: white paper should stay below the brightest grey"};
    case Status::kPartlyCovered:
      return {"something stands before part of the marker", "Clear the line of sight"};
    case Status::kLost:
      return {"the target was not found", "It left the picture, or something hides it"};
    case Status::kReferenceLost:
      return {"too few references were found, or the frame comes before the reference frame",
              "Keep at least four in every picture, or choose --reference-frame"};
    case Status::kOrderUnproven:
      return {"by how many whole pitches it moved cannot be told", "Take more frames per second, or a coarser print"};
    case Status::kDecodeError:
      return {"the frame is damaged", "Copy the recording once more from the camera"};
    case Status::kTooCoarse:
      return {"the pitch is too few pixels wide in the picture", "Move closer, or print a larger pitch"};
  }
  return {"", ""};
}

Words words_of(const WordedRun& run) {
  const Measurement& m = run.measurement;
  Words words;
  words.outcome = outcome_of(m);
  words.advice = advice_of(m);
  if (!m.refusal.empty()) words.summary.push_back(begun_large(m.refusal) + ".");
  if (!m.reference) return words;
  const Site& site = site_of(m, run.options);
  for (std::size_t k = 0; k < m.targets.size(); ++k) {
    const std::string& name = site.markers[m.targets[k].marker].name;
    words.summary.push_back(sentence_of_target(run, m.targets[k]));
    add_vibration(name, m.spectra[k], words.summary);
  }
  // A refused run determines nothing.
  if (m.exit != Exit::kRefused) {
    words.summary.push_back(sentence_of_camera(run));
    words.summary.push_back(sentence_of_lens(run));
  }
  words.summary.push_back(sentence_of_rows(run));
  words.summary.push_back(sentence_of_scale(*m.reference));
  words.summary.push_back(sentence_of_references(m));
  return words;
}

}  // namespace moiregauge::internal

// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/report_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "moiregauge/base/rounded_text.h"
#include "moiregauge/observation/reference/scale_check.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxWorded = 3;  // largest number of peaks per target in the text (chosen)
constexpr double kClock = 1e-5;        // smallest relative U of a frequency: camera clocks are no better
// Motion of the image's middle and rotation below which a camera counts as fixed in the text. A camera that circles the
// targets keeps the middle where it is. Chosen.
constexpr double kStill_px = 0.05, kStill_deg = 0.5;
constexpr double kWorthAWord = 0.1;  // smallest amplitude of a listed peak, relative to the strongest (chosen)

// Movement of one target along one axis, of its `ok` rows.
struct AxisMovement {
  const char* along;                                                       // "up and down"
  double lowest = kNotMeasured, highest = kNotMeasured, u = kNotMeasured;  // mm
  long rows = 0;

  [[nodiscard]] double peak_to_peak() const { return highest - lowest; }
  [[nodiscard]] bool is_measured() const { return rows > 0 && !std::isnan(u); }
  // The expected range of n independent normal values is below 2 sqrt(2 ln n) of their standard deviation.
  [[nodiscard]] bool is_beyond_noise() const {
    return is_measured() && peak_to_peak() > 2.0 * std::sqrt(2.0 * std::log(std::max(2.0, double(rows)))) * u;
  }
};

AxisMovement movement_along(const WordedRun& run, const TargetSummary& t, double Extent<frame::Board>::*axis,
                            const char* along) {
  AxisMovement movement{along, t.lowest.*axis, t.highest.*axis, t.u.*axis, 0};
  for (const Sample& s : run.measurement.samples)
    movement.rows += s.marker == t.marker && s.status == Status::kOk && !std::isnan(s.displacement.*axis);
  return movement;
}

std::string signed_mm(double value, int digits) {
  const std::string size = fmt::format("{:.{}f}", std::abs(value), digits);
  const bool is_zero = size.find_first_not_of("0.") == std::string::npos;
  return (is_zero ? "" : value < 0.0 ? "−" : "+") + size;
}

// "U = 0.028 mm".
std::string u_text(const AxisMovement& m) {
  const double expanded = kCoverageFactor * m.u;
  return fmt::format("U = {:.{}f} mm", expanded, decimals_for(expanded));
}

// "by 1.023 mm peak to peak".
std::string size_text(const AxisMovement& m) {
  return fmt::format("by {:.{}f} mm peak to peak", m.peak_to_peak(), decimals_for(kCoverageFactor * m.u));
}

std::string still_text(const std::string& name, const AxisMovement& first, const AxisMovement& second) {
  std::string us;
  for (const AxisMovement& m : {first, second}) {
    if (m.is_measured()) us += fmt::format("{}{} {}", us.empty() ? "" : ", ", m.along, u_text(m));
  }
  return fmt::format("{} did not move measurably ({}, k = 2).", name, us);
}

// The first sentence states the larger movement, the second its range and the other axis.
std::vector<std::string> sentences_of_target(const WordedRun& run, const TargetSummary& t) {
  const Measurement& m = run.measurement;
  const std::string& name = site_of(m, run.options).markers[t.marker].name;
  long besides_reference = t.ok;
  for (const Sample& s : m.samples) besides_reference -= s.marker == t.marker && s.frame == m.reference->seen.frame;
  if (besides_reference <= 0) return {fmt::format("{} has no reliable row besides the reference frame.", name)};
  AxisMovement first = movement_along(run, t, &Extent<frame::Board>::y, "up and down");
  AxisMovement second = movement_along(run, t, &Extent<frame::Board>::x, "sideways");
  if (!first.is_measured() || second.peak_to_peak() > first.peak_to_peak()) std::swap(first, second);
  if (!first.is_beyond_noise()) return {still_text(name, first, second)};
  const int digits = decimals_for(kCoverageFactor * first.u);
  const std::string other = !second.is_measured() ? "was not measured " + std::string(second.along)
                            : second.is_beyond_noise()
                                ? fmt::format("moved {} {} ({})", second.along, size_text(second), u_text(second))
                                : fmt::format("did not move measurably {} ({})", second.along, u_text(second));
  return {fmt::format("{} moved {} {} ({}, k = 2).", name, first.along, size_text(first), u_text(first)),
          fmt::format("Its range was {} to {} mm. It {}.", signed_mm(first.lowest, digits),
                      signed_mm(first.highest, digits), other)};
}

std::string peak_text(const Peak& peak) {
  const double expanded = std::max(kCoverageFactor * peak.u_frequency_hz, kClock * peak.frequency_hz);
  std::string text = fmt::format("{:.{}f} Hz (U = {:.{}f} Hz", peak.frequency_hz, decimals_for(expanded), expanded,
                                 decimals_for(expanded));
  if (!std::isnan(peak.damping)) {
    const double u = 100.0 * kCoverageFactor * peak.u_damping;
    text +=
        fmt::format("; damping {:.{}f} %, U = {:.{}f} %", 100.0 * peak.damping, decimals_for(u), u, decimals_for(u));
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
  to.push_back(fmt::format("{} vibrates {}{}{}.", name, up, up.empty() || side.empty() ? "" : ", and ", side));
}

std::string sentence_of_camera(const WordedRun& run) {
  if (run.options.method->name == "conventional")
    return "The camera was assumed to be fixed: this method does not correct its motion.";
  double shift = kNotMeasured, turn = kNotMeasured;
  for (std::size_t n = 0; n < run.camera.shift_x_px.size(); ++n)
    shift = std::fmax(shift, std::hypot(run.camera.shift_x_px[n], run.camera.shift_y_px[n]));
  if (std::isnan(shift)) return "The camera's motion is unknown, because the references were not found.";
  for (std::size_t n = 0; n < run.camera.turn_x_deg.size(); ++n)
    turn = std::fmax(turn, std::hypot(run.camera.turn_x_deg[n], run.camera.turn_y_deg[n], run.camera.turn_z_deg[n]));
  if (shift < kStill_px && turn > kStill_deg)
    return fmt::format(
        "The camera rotated by up to {:.2f}°, while the middle of the image moved by less than {} px. Both are removed "
        "from all values.",
        turn, kStill_px);
  if (shift < kStill_px) return fmt::format("The camera moved the image by less than {} px.", kStill_px);
  if (std::isnan(turn))
    return fmt::format("The camera moved the image by up to {:.1f} px, which is removed from all values.", shift);
  return fmt::format(
      "The camera rotated by up to {:.2f}° and moved the image by up to {:.1f} px, which is removed from all values.",
      turn, shift);
}

// Returns the distortion of a lens at the farthest image corner, relative to its distance from the principal point.
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
      return fmt::format("The lens was {}. It distorts the image corners by less than 0.01 %.", how);
    return fmt::format("The lens was {}. It distorts the image corners by {}{:.2f} %.", how, percent < 0.0 ? "−" : "+",
                       std::abs(percent));
  };
  const std::optional<Scene>& scene = stated_scene(m);
  if (scene && determines_camera(*scene)) return camera_text("solved from the footage", scene->camera);
  if (scene && scene->model.radial && !run.options.camera)
    return "The lens distortion is corrected as far as the footage shows it. The focal length is unknown.";
  if (run.options.camera) return camera_text("given with --camera", *run.options.camera);
  if (scene) return "No lens distortion was found. The remaining doubt is part of the uncertainty.";
  return "The lens is unknown and assumed to be free of distortion.";
}

std::string sentence_of_scale(const Reference& reference) {
  const ScaleCheck check = scale_check(reference);
  const auto& markers = reference.site.markers;
  const std::string size = short_length(check.distance_mm, "mm");
  const std::string length = check.from == check.to
                                 ? fmt::format("the grating of {} is {} wide", markers[check.from].name, size)
                                 : fmt::format("{} and {} are {} apart, centre to centre", markers[check.from].name,
                                               markers[check.to].name, size);
  return fmt::format("One pixel shows {:.3g} mm, and {}. Check this with a tape, because every result scales with it.",
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
  if (rows == ok) return fmt::format("{}, all rows are ok.", all);
  std::string list;
  for (const auto& [word, count] : counts) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, word);
  return fmt::format("{}, {} of {} rows are ok (others: {}).", all, ok, rows, list);
}

std::string sentence_of_references(const Measurement& m) {
  if (m.references_verified) return "The references were checked against each other. None of those in use moved.";
  return m.reference->circles.size() <= 4
             ? "The references cannot check each other, which needs 6 references (5 with --camera)."
             : "The references could not be checked against each other.";
}

std::string begun_large(std::string sentence) {
  if (sentence.front() >= 'a' && sentence.front() <= 'z')
    sentence.front() = static_cast<char>(sentence.front() - 'a' + 'A');
  return sentence;
}

std::string outcome_of(const Measurement& m) {
  if (m.interrupted) return "Stopped early";
  if (m.exit == Exit::kMeasured) return "Measured";
  return m.exit == Exit::kRefused ? "Not measured" : "Measured with gaps";
}

std::vector<std::string> advice_of(const Measurement& m) {
  std::vector<std::string> advice;
  if (!m.reference) {
    advice.emplace_back(
        "Look at the image below, which shows everything that was found in the first frame. Every reference circle "
        "must be complete, sharp and evenly lit.");
    advice.emplace_back(
        "If the first frame is not suitable, choose another with --reference-frame. If the site file does not fit, "
        "correct it, or give --pitch instead.");
    return advice;
  }
  std::map<Status, long> counts;
  for (const Sample& s : m.samples) ++counts[s.status];
  std::vector<std::pair<Status, long>> by_count(counts.begin(), counts.end());
  std::stable_sort(by_count.begin(), by_count.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [status, count] : by_count) {
    if (status == Status::kOk) continue;
    const bool is_remedied = status == Status::kUntrusted && !m.remedy.empty();
    advice.push_back(fmt::format("{} row{} {}: {}. {}.", count, count == 1 ? "" : "s", word_for(status),
                                 words_of(status).meaning,
                                 is_remedied ? begun_large(m.remedy) : std::string(words_of(status).help)));
  }
  return advice;
}

}  // namespace

StatusWords words_of(Status status) {
  switch (status) {
    case Status::kOk:
      return {"the value is reliable", ""};
    case Status::kUntrusted:
      return {
          "the images contradict the measurement model, for example because a reference moved or the camera averages "
          "frames",
          "See the warnings, give the lens with --camera, or use six references"};
    case Status::kCameraMoved:
      return {"the camera moved, which this method cannot correct", "Measure with --method precise or two-stage"};
    case Status::kBlurred:
      return {"the marker is too blurred for a reliable uncertainty", "Use a shorter exposure, or focus better"};
    case Status::kSaturated:
      return {"grey levels reach the end of the range",
              "Expose less, so that white paper stays below the brightest grey level"};
    case Status::kPartlyCovered:
      return {"part of the marker looks covered",
              "Clear the line of sight, or record at a higher bit rate if nothing covers it"};
    case Status::kLost:
      return {"the target was not found", "Check whether it left the image or was covered"};
    case Status::kReferenceLost:
      return {"too few references were found, or there was no reference frame yet",
              "Keep four references in every frame, or choose another --reference-frame"};
    case Status::kOrderUnproven:
      return {"the number of whole pitches (fringe order) is unknown",
              "Record more frames per second, or use a larger pitch"};
    case Status::kDecodeError:
      return {"the frame is damaged", "Copy the recording again from the camera"};
    case Status::kTooCoarse:
      return {"the pitch is too few pixels wide", "Move closer, or use a larger pitch"};
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
  for (const std::size_t k : by_movement(m.targets)) {
    const std::string& name = site.markers[m.targets[k].marker].name;
    std::vector<std::string> sentences = sentences_of_target(run, m.targets[k]);
    // The first sentence of the page is its headline.
    if (words.summary.empty() || sentences.size() == 1) {
      words.summary.insert(words.summary.end(), sentences.begin(), sentences.end());
    } else {
      words.summary.push_back(fmt::format("{}", fmt::join(sentences, " ")));
    }
    add_vibration(name, m.spectra[k], words.summary);
  }
  // A refused run has no trustworthy camera or lens.
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

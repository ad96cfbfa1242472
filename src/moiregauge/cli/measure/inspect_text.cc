// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/inspect_text.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/drawing/overlays/inspection_text.h"
#include "moiregauge/observation/reference/scale_check.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::size_t kMaxLines = 12;  // for each kind; --json has them all

std::string counted(std::size_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string and_more(std::size_t all) {
  return all > kMaxLines ? fmt::format("  and {} more (--json lists them)\n", all - kMaxLines) : "";
}

std::string circle_text(const Inspection& seen) {
  std::vector<const InspectedCircle*> listed;
  for (const InspectedCircle& c : seen.circles) {
    if (c.lattice == kUnidentified || c.marker != kUnidentified) listed.push_back(&c);
  }
  std::stable_sort(listed.begin(), listed.end(), [](const auto* a, const auto* b) {
    const auto place = [](int marker) { return marker == kUnidentified ? 1 << 30 : marker; };
    return place(a->marker) < place(b->marker);
  });
  const std::size_t dots = seen.circles.size() - listed.size();
  std::string text = fmt::format("circles: {}{}\n", seen.circles.size(),
                                 dots > 0 ? fmt::format(", {} of them in a lattice", dots) : "");
  for (std::size_t i = 0; i < std::min(listed.size(), kMaxLines); ++i) {
    const InspectedCircle& c = *listed[i];
    text += fmt::format(
        "  {:<6} at ({:.1f}, {:.1f}) px, diameter {:.1f} px, W = {:.3f}, {}, {:+.0f} grey levels, u = {:.3f} px\n",
        name_of(seen, c.marker), c.seen.centre.x, c.seen.centre.y, c.seen.diameter_px, c.seen.circularity,
        c.seen.axis_ratio > 0.995 ? std::string("round") : fmt::format("axes 1 : {:.2f}", c.seen.axis_ratio),
        c.seen.contrast, c.seen.u_centre_px);
  }
  return text + and_more(listed.size());
}

std::string rejected_text(const Inspection& seen) {
  if (seen.rejected.empty()) return "";
  const auto elsewhere = rejected_elsewhere(seen);
  const std::size_t parts = seen.rejected.size() - elsewhere.size();
  std::string text = fmt::format("rejected as circles: {}{}\n", counted(seen.rejected.size(), "outline", "outlines"),
                                 parts > 0 ? fmt::format(", {} of them inside other markers", parts) : "");
  for (std::size_t i = 0; i < std::min(elsewhere.size(), kMaxLines); ++i) {
    const RejectedOutline& r = *elsewhere[i];
    text += fmt::format("  {:<6} at ({:.1f}, {:.1f}) px, diameter {:.1f} px, W = {:.3f}: {}\n", "-", r.centre.x,
                        r.centre.y, r.diameter_px, r.circularity, r.why);
  }
  return text + and_more(elsewhere.size());
}

std::string patch_text(const Inspection& seen) {
  std::string text = fmt::format("gratings: {}\n", seen.patches.size());
  for (std::size_t i = 0; i < std::min(seen.patches.size(), kMaxLines); ++i) {
    const InspectedPatch& p = seen.patches[i];
    const PatchBound u = displacement_bound(p);
    text += fmt::format(
        "  {:<6} at ({:.1f}, {:.1f}) px: {}, {}; {:.1f} x {:.1f} pitches, modulation {:.1f}, noise {:.2f} grey "
        "levels; alone u = {}\n",
        name_of(seen, p.marker), p.seen.centre.x, p.seen.centre.y, pattern_text(p.seen), pitch_text(p.seen),
        p.seen.periods_x, p.seen.periods_y, p.seen.modulation, p.noise.sigma,
        both_axes(u.along_x_px, u.along_y_px, "px"));
  }
  return text + and_more(seen.patches.size());
}

std::string lattice_list_text(const Inspection& seen) {
  if (seen.lattices.empty()) return "lattices: none\n";
  std::string text = fmt::format("lattices: {}\n", seen.lattices.size());
  for (const IndexedLattice& lattice : seen.lattices)
    text += fmt::format("  {}, pitch {:.1f} px\n", lattice_text(lattice), lattice.pitch_px);
  return text;
}

std::string identification_text(const InspectReport& report) {
  const Inspection& seen = report.seen;
  std::string notes;
  for (const std::string& note : seen.notes) notes += note + "\n";
  if (!seen.reference) return fmt::format("identified: none, {}\n", seen.missing) + notes;
  std::string references, targets;
  for (const Marker& m : seen.reference->site.markers) {
    std::string& names = m.role == Role::kReference ? references : targets;
    names += (names.empty() ? "" : " ") + m.name;
  }
  std::string text =
      fmt::format("identified: references {} (must not move), targets {}\n", references, targets) + notes;
  for (const ExpectedUncertainty& e : report.expected)
    text += fmt::format("expected: {}: {}\n", seen.reference->site.markers[e.marker].name, expected_text(seen, e));
  return text;
}

std::string scale_line(const Inspection& seen) {
  if (!seen.reference) return "";
  const ScaleCheck check = scale_check(*seen.reference);
  const char* unit = word_for(seen.unit);
  return fmt::format("scale: {:.3g} {}/px, {} (check with a tape)\n", check.mm_per_px / seen.pitch_of_unit, unit,
                     tape_text(check, seen.reference->site, seen.pitch_of_unit, unit));
}

std::string next_after_inspect(const InspectReport& report) {
  if (!report.seen.reference) {
    return report.seen.patches.empty() ? ""
                                       : "next: with a fixed camera, measure the gratings with --method conventional\n";
  }
  if (report.seen.unit == BoardUnit::kPitch) return "next: give --pitch (e.g. --pitch 10mm) for millimetres\n";
  const bool is_lossy = std::any_of(report.expected.begin(), report.expected.end(),
                                    [](const ExpectedUncertainty& e) { return e.codec.x > 0.0 || e.codec.y > 0.0; });
  return fmt::format(
      "next: check overlay.png, then measure. Expected u (k = 1): {} only, lens and depth are added by measure\n",
      is_lossy ? "noise and codec" : "noise");
}

}  // namespace

std::string found_in_short(const Inspection& seen) {
  std::string text =
      counted(seen.circles.size(), "circle", "circles") + ", " + counted(seen.patches.size(), "grating", "gratings");
  for (const IndexedLattice& lattice : seen.lattices) text += ", " + lattice_text(lattice);
  return text;
}

std::string inspect_text(const InspectReport& report) {
  return fmt::format("image: {}, frame {}: {} x {} px, {} bits\n", report.input.path, report.frame, report.seen.width,
                     report.seen.height, report.input.bits) +
         circle_text(report.seen) + rejected_text(report.seen) + patch_text(report.seen) +
         lattice_list_text(report.seen) + identification_text(report) + scale_line(report.seen) +
         next_after_inspect(report);
}

}  // namespace moiregauge::internal::cli

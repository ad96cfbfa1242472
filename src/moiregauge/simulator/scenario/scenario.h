// SPDX-License-Identifier: Apache-2.0
// Everything a simulated recording is made of. Values only; the built-in ones are in built_in.h.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/simulator/scenario/tone.h"
#include "moiregauge/simulator/scenario/track.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal::simulator {

// Pinhole and OpenCV's lens model, in pixels; camera x right, y down, z forward.
struct Camera {
  int width = 1024;  // px
  int height = 512;
  double fx = 3478.26, fy = 3478.26, cx = 511.5, cy = 255.5;
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;
};

// What a lens does over time. The picture is scaled about the principal point and shifted; the distortion stays where
// it is on the sensor.
struct Optics {
  Track zoom{};                // relative: 0.01 is a focal length a hundredth longer
  Track shift_x{}, shift_y{};  // px, right and down: an optical stabiliser's travel
  // A thin lens of this aperture, focused at this distance (0: at all), makes a disc of a point at depth z: its radius is
  // fx aperture / 2 |1 / z - 1 / focus| px. It is drawn as the Gaussian of the same variance.
  double focus_mm = 0.0;
  double aperture_mm = 0.0;
};

// Board point (x, y, z) at rest in the camera: B (x, -y, -z) + (0, 0, distance), B = Rx Ry Rz of the board's own
// angles. The camera's movement takes that to X_cam = Rx Ry Rz (X - pivot) + pivot + shift, right-handed about camera
// axes.
struct Mount {
  double distance_mm = 1200.0;
  double board_x_deg = 0.0, board_y_deg = 0.0, board_z_deg = 0.0;
  double pivot_x_mm = 0.0, pivot_y_mm = 0.0, pivot_z_mm = -100.0;  // 100 mm behind the lens
  // Degrees, then mm; random ones differ from axis to axis.
  Track rotation_x{.random_seed = 1}, rotation_y{.random_seed = 2}, rotation_z{.random_seed = 3};
  Track shift_x{.random_seed = 4}, shift_y{.random_seed = 5}, shift_z{.random_seed = 6};
};

// Grey levels are those of an 8-bit picture; 10 and 12 bits multiply them by 4 and 16.
struct Light {
  double white = 210.0;
  double black = 40.0;
  double background = 110.0;
  double texture = 0.0;     // rms of a rough background, grey levels
  double vignetting = 0.0;  // relative loss at the corner of the picture, growing with r^2
  Track slope_x;            // relative change of light from the centre to the right edge
  Track slope_y;            // and to the lower edge
  Track flicker;            // relative change of all light: lamps, an automatic exposure or gain
};

// EMVA 1288 in grey levels: variance = sigma^2 + gain * level. Quantisation comes on top.
struct Sensor {
  double psf_sigma_px = 0.7;
  Track defocus_px;       // sigma of a further Gaussian
  Track defocus_disc_px;  // radius of a disc (soft at its rim): what a lens out of focus makes of a point
  double noise_sigma = 1.5;
  double noise_gain = 0.0;
  double row_noise = 0.0;  // rms of what all pixels of a row share
  double gamma = 1.0;      // stored = 255 (light / 255)^(1 / gamma)
  int bits = 8;
  double fps = 10.0;
  double exposure_s = 1.0 / 80.0;  // centred on frame / fps
  double readout_s = 0.0;          // rolling shutter: from the first row's exposure to the last one's; 0: all at once
  bool interlaced = false;         // odd rows half a frame later
  [[nodiscard]] bool exposes_row_by_row() const { return readout_s > 0.0 || interlaced; }
};

// Histogram equalisation in tiles, its slope limited.
struct LocalTone {
  double strength = 0.0;  // 0: none; 1: all of it
  int tile_px = 128;
  double most_slope = 2.0;  // of a tile's curve; below 1 nothing is left of the equalisation
};

// A camera's processing, in this order, after noise and before grey levels are stored; the last three see those of
// frames before.
struct Processing {
  ToneCurve tone{};
  int median_px = 0;           // side of its window: 3, 5 or 7
  double bilateral_px = 0.0;   // edge-preserving smoothing: sigma in space
  double bilateral_grey = 20;  // and in grey levels
  LocalTone local_tone{};
  double sharpen_amount = 0.0;  // unsharp mask: grey + amount (grey - Gaussian of it)
  double sharpen_radius_px = 1.0;
  double low_pass = 0.0;     // cycles per px beyond which nothing passes: edges ring
  double pixel_size = 1.0;   // px: blocks of this side show their mean; 2 is a picture doubled in size
  int average_frames = 1;    // the mean of this number of frames, this one the last
  double recursion = 0.0;    // share of what the frame before was made of in this one
  double motion_grey = 0.0;  // both only where less than this has changed, grey levels; 0: everywhere
};

// Frames from..to, the last left out.
struct FrameSpan {
  long from = 0;
  long to = 0;
};

// How the recording's frames and time stamps come about. The camera takes shot n at n / fps, more or less.
struct Timing {
  double jitter_s = 0.0;            // shots are taken up to so much too early or too late
  double stamp_jitter_s = 0.0;      // stamps are wrong by up to so much
  bool nominal_stamps = false;      // the stamps are frame / fps, whatever happened
  std::vector<FrameSpan> dropped;   // shots that are not in the recording
  std::vector<FrameSpan> repeated;  // frames of the recording that show the one before once more
};

// Something held before a marker's sheet.
struct Cover {
  std::vector<FrameSpan> frames;
  double share = 1.0;         // of the sheet's width, from its left edge
  double height_share = 1.0;  // of its height, from its lower edge
  double grey = 90.0;
  double texture = 0.0;  // rms of its roughness, grey levels
  double opacity = 1.0;  // less: it lets light through; with grey 0 a shadow
  Track x_mm{}, y_mm{};  // its way across the sheet
};

// A lamp mirrored in glossy paper: a round spot of light that adds to what is there, normal in shape.
struct Glare {
  Track grey{};          // grey levels at its middle
  Track x_mm{}, y_mm{};  // of its middle, from the marker's centre
  double sigma_mm = 3.0;
};

// A printer's deviations from the ideal print: part of the print, they move with it.
struct Ink {
  double line_share = 0.5;       // of the pitch that is ink in dark lines, squares and dots
  double gain_mm = 0.0;          // dot gain: every edge of the grating's ink is further out by this
  double rough_mm = 0.0;         // edges are ragged: rms along each axis
  double rough_length_mm = 0.3;  // over which raggedness changes
  double mottle = 0.0;           // uneven ink: rms, relative to white less black
  double mottle_length_mm = 2.0;
  double grain = 0.0;  // paper: rms, grey levels
  double grain_length_mm = 0.4;
  [[nodiscard]] bool is_uneven() const { return mottle != 0.0 || grain != 0.0; }
};

// The true marker. `print` is as site.toml states it; `place` is by how much the truth differs from that.
struct SceneMarker {
  Marker print;
  bool inverted = false;  // white lines on black
  Ink ink;
  double paper_margin_mm = 10.0;  // white paper around circle and grating
  bool listed = true;             // false: a look-alike that site.toml does not know
  struct Place {
    double x_mm = 0.0, y_mm = 0.0, z_mm = 0.0;
    double rotation_deg = 0.0;  // counter-clockwise about the marker's own centre
    double print_scale = 0.0;   // relative: 0.001 is a print a thousandth too large, about that centre
    double stretch_x = 0.0;     // relative, along x only: a printer's feed
  } place;
  Cover cover;
  Glare glare;
  Track fold_mm;             // what hangs right of the marker's centre has been pushed to the right by so much
  Track dx, dy, dz;          // mm
  Track wander_x, wander_y;  // mm; how its picture moves while it stands: not part of the truth
};

// Which of the site's errors are drawn: each from a normal distribution as wide as [known_to] says.
struct Draw {
  bool position = false, rotation = false, height = false, print_scale = false;
  std::uint64_t seed = 0;  // 0: one that follows from the scenario's
};

// Hot air: every marker's picture wanders by itself.
struct Haze {
  double rms_mm = 0.0;
  double step_s = 0.1;  // drawn anew for each, as a track's random part
};

// What is wrong about site.toml itself.
struct SiteErrors {
  bool mirrored = false;                                       // left for right
  std::vector<std::pair<std::string, std::string>> exchanged;  // each is said to be where, and what, the other is
};

struct Scenario {
  std::string name;
  Camera camera;
  Optics optics;
  Mount mount;
  Light light;
  Sensor sensor;
  Processing processing;
  std::vector<SceneMarker> markers;
  KnownTo known_to;  // as site.toml states it
  Draw draw;
  SiteErrors site_errors;
  Timing timing;
  Haze haze;
  int decoys = 0;  // look-alike circles strewn over the background
  long frames = 161;
  std::uint64_t seed = 1;
};

// Which of the camera's shots a frame of the recording shows.
[[nodiscard]] long shot_of(const Scenario& scenario, long frame);
// The middle of that shot's exposure.
[[nodiscard]] double time_of(const Scenario& scenario, long frame);
// What the recording says of it. It rises from frame to frame.
[[nodiscard]] double stamp_of(const Scenario& scenario, long frame);

// True when the grey levels of the recording are proportional to light.
[[nodiscard]] bool stores_light(const Scenario& scenario);

// By how much row y of the picture is exposed later than the picture's middle.
[[nodiscard]] double delay_of_row(const Scenario& scenario, int y);

// By how much a marker truly stands elsewhere than site.toml says: its `place`, and what was drawn.
[[nodiscard]] SceneMarker::Place true_place(const Scenario& scenario, const SceneMarker& marker);

// For draws that belong to one marker of one scenario.
[[nodiscard]] std::uint64_t own_seed(const Scenario& scenario, const SceneMarker& marker);

}  // namespace moiregauge::internal::simulator

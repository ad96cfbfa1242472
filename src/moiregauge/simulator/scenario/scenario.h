// SPDX-License-Identifier: Apache-2.0
// All values of a simulated recording. Built-in scenarios are in built_in.h.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/simulator/scenario/tone.h"
#include "moiregauge/simulator/scenario/track.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal::simulator {

// Pinhole camera with OpenCV's lens model; camera x right, y down, z forward.
struct Camera {
  int width = 1024;                                           // px
  int height = 512;                                           // px
  double fx = 3478.26, fy = 3478.26, cx = 511.5, cy = 255.5;  // px
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;    // 1
};

// Changes of the lens over time. Zoom and shift move the image, but not the distortion, which is fixed on the sensor.
struct Optics {
  Track zoom{};                // relative change of the focal length
  Track shift_x{}, shift_y{};  // px, right and down: movement of an optical stabiliser
  // A thin lens focused at focus_mm (0: everything is sharp) images a point at depth z as a disc. Its radius is
  // fx aperture / 2 |1 / z - 1 / focus| px. It is drawn as a Gaussian of the same variance.
  double focus_mm = 0.0;
  double aperture_mm = 0.0;
};

// Pose of the board and movement of the camera. Without movement a board point (x, y, z) is at
//     X = B (x, -y, -z) + (0, 0, distance), with B = Rx Ry Rz of the board's angles.
// The movement gives X_cam = Rx Ry Rz (X - pivot) + pivot + shift, right-handed about camera axes.
struct Mount {
  double distance_mm = 1200.0;
  double board_x_deg = 0.0, board_y_deg = 0.0, board_z_deg = 0.0;
  double pivot_x_mm = 0.0, pivot_y_mm = 0.0, pivot_z_mm = -100.0;  // default: 100 mm behind the lens
  // Rotations in degrees, shifts in mm. Different seeds make random movements independent.
  Track rotation_x{.random_seed = 1}, rotation_y{.random_seed = 2}, rotation_z{.random_seed = 3};
  Track shift_x{.random_seed = 4}, shift_y{.random_seed = 5}, shift_z{.random_seed = 6};
};

// Light of the scene. Grey levels are those of 8 bits; 10 and 12 bits multiply them by 4 and 16.
struct Light {
  double white = 210.0;       // grey levels
  double black = 40.0;        // grey levels
  double background = 110.0;  // grey levels
  double texture = 0.0;       // grey levels, rms of a rough background
  double vignetting = 0.0;    // relative loss at the corner of the image, proportional to r^2
  Track slope_x;              // relative change of light from the centre to the right edge
  Track slope_y;              // relative change of light from the centre to the lower edge
  Track flicker;              // relative change of all light: lamps, automatic exposure or gain
};

// Noise model of EMVA 1288 in grey levels: variance = sigma^2 + gain * level, plus quantisation.
struct Sensor {
  double psf_sigma_px = 0.7;       // px, sigma of the point spread
  Track defocus_px;                // px, sigma of an additional Gaussian
  Track defocus_disc_px;           // px, radius of the defocus disc, which has a soft rim
  double noise_sigma = 1.5;        // grey levels
  double noise_gain = 0.0;         // grey levels
  double row_noise = 0.0;          // grey levels, rms, common to all pixels of a row
  double gamma = 1.0;              // stored = 255 (light / 255)^(1 / gamma)
  int bits = 8;                    // 8, 10 or 12
  double fps = 10.0;               // 1/s
  double exposure_s = 1.0 / 80.0;  // s, centred on the time of the frame
  double readout_s = 0.0;          // s, rolling shutter: time to read all rows; 0: global shutter
  bool interlaced = false;         // odd rows are exposed half a frame interval later
  [[nodiscard]] bool exposes_row_by_row() const { return readout_s > 0.0 || interlaced; }
};

// Histogram equalisation in tiles with a limited slope.
struct LocalTone {
  double strength = 0.0;    // 0 (off) to 1
  int tile_px = 128;        // px
  double most_slope = 2.0;  // clip limit: largest slope of a tile's curve, before the rest is spread over all levels
};

// Processing in the camera, in this order. The first steps work on one image, after noise and before storage. The last
// three work on stored grey levels and depend on earlier frames.
struct Processing {
  ToneCurve tone{};
  int median_px = 0;           // px, side of the window: 3, 5 or 7; 0: off
  double bilateral_px = 0.0;   // px, spatial sigma of edge-preserving smoothing; 0: off
  double bilateral_grey = 20;  // grey levels, sigma of edge-preserving smoothing
  LocalTone local_tone{};
  double sharpen_amount = 0.0;     // unsharp mask: grey + amount * (grey - blurred grey)
  double sharpen_radius_px = 1.0;  // px, sigma
  double low_pass = 0.0;           // cycles per px, cut-off of a filter that rings at edges; 0: off
  double pixel_size = 1.0;         // px, side of blocks that show their mean; 2 is an image enlarged to double size
  int average_frames = 1;          // frames per mean, the current one included
  double recursion = 0.0;          // weight of the previous output in the current one
  double motion_grey = 0.0;        // grey levels; larger changes are not averaged; 0: no limit
};

// Frames from..to - 1.
struct FrameSpan {
  long from = 0;
  long to = 0;
};

// Frames and time stamps of the recording. The camera takes shot n at n / fps, plus jitter.
struct Timing {
  double jitter_s = 0.0;            // s, half range of the uniform error of a shot's time
  double stamp_jitter_s = 0.0;      // s, half range of the uniform error of a time stamp
  bool nominal_stamps = false;      // time stamps are frame / fps, without regard to lost shots and jitter
  std::vector<FrameSpan> dropped;   // shots that are not in the recording
  std::vector<FrameSpan> repeated;  // frames of the recording that repeat the one before
};

// Object in front of a marker's sheet.
struct Cover {
  std::vector<FrameSpan> frames;
  double share = 1.0;         // relative to the sheet's width, from its left edge
  double height_share = 1.0;  // relative to the sheet's height, from its lower edge
  double grey = 90.0;         // grey levels
  double texture = 0.0;       // grey levels, rms of its roughness
  double opacity = 1.0;       // below 1 it is translucent; with grey 0 it is a shadow
  Track x_mm{}, y_mm{};       // mm, movement across the sheet
};

// Reflection of a lamp in glossy paper: a round Gaussian spot that adds to the light.
struct Glare {
  Track grey{};           // grey levels at its middle
  Track x_mm{}, y_mm{};   // mm, position of its middle from the marker's centre
  double sigma_mm = 3.0;  // mm
};

// Deviations of a printer from the ideal grating. They are part of the sheet and move with it.
struct Ink {
  double line_share = 0.5;        // relative to the pitch: width of the ink in dark lines, squares and dots
  double gain_mm = 0.0;           // mm, dot gain: outward shift of the edges of the grating's ink
  double rough_mm = 0.0;          // mm, rms of ragged edges along each axis
  double rough_length_mm = 0.3;   // mm, correlation length of ragged edges
  double mottle = 0.0;            // uneven ink: rms, relative to white minus black
  double mottle_length_mm = 2.0;  // mm
  double grain = 0.0;             // grey levels, rms of uneven paper
  double grain_length_mm = 0.4;   // mm
  [[nodiscard]] bool is_uneven() const { return mottle != 0.0 || grain != 0.0; }
};

// True marker: `print` is as stated in site.toml, `place` is the deviation of the truth from it.
struct SceneMarker {
  Marker print;
  bool inverted = false;  // white lines on black
  Ink ink;
  double paper_margin_mm = 10.0;  // mm, white paper around circle and grating
  bool listed = true;             // false: a false candidate that is not in site.toml
  struct Place {
    double x_mm = 0.0, y_mm = 0.0, z_mm = 0.0;
    double rotation_deg = 0.0;  // counter-clockwise about the marker's centre
    double print_scale = 0.0;   // relative change of size about that centre: 0.001 is 0.1 % too large
    double stretch_x = 0.0;     // relative change of size along x only, by the feed of a printer
  } place;
  Cover cover;
  Glare glare;
  Track fold_mm;             // mm, shift to the right of the part right of the marker's centre
  Track dx, dy, dz;          // mm, displacement
  Track wander_x, wander_y;  // mm, marker jitter: not part of the truth
};

// Site errors that are drawn from normal distributions with the standard uncertainties of [known_to].
struct Draw {
  bool position = false, rotation = false, height = false, print_scale = false;
  std::uint64_t seed = 0;  // 0: the scenario's seed
};

// Hot air: independent jitter of all markers.
struct Haze {
  double rms_mm = 0.0;  // mm, along each axis
  double step_s = 0.1;  // s, interval between random draws
};

// Errors of site.toml itself.
struct SiteErrors {
  bool mirrored = false;                                       // x has the wrong sign
  std::vector<std::pair<std::string, std::string>> exchanged;  // pairs of markers with exchanged entries
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
  KnownTo known_to;  // as stated in site.toml
  Draw draw;
  SiteErrors site_errors;
  Timing timing;
  Haze haze;
  int decoys = 0;  // number of false candidates on the background
  long frames = 161;
  std::uint64_t seed = 1;
};

// Returns the number of the camera's shot in a frame of the recording.
[[nodiscard]] long shot_of(const Scenario& scenario, long frame);
// Returns the middle of that shot's exposure in s.
[[nodiscard]] double time_of(const Scenario& scenario, long frame);
// Returns the time stamp of a frame in s. Time stamps ascend.
[[nodiscard]] double stamp_of(const Scenario& scenario, long frame);

// Returns true if the stored grey levels are proportional to light.
[[nodiscard]] bool stores_light(const Scenario& scenario);

// Returns the delay in s of row y's exposure, relative to the time of the frame.
[[nodiscard]] double delay_of_row(const Scenario& scenario, int y);

// Returns the deviation of a marker from site.toml: its `place` plus the drawn errors.
[[nodiscard]] SceneMarker::Place true_place(const Scenario& scenario, const SceneMarker& marker);

// Returns the seed for draws of one marker in one scenario.
[[nodiscard]] std::uint64_t own_seed(const Scenario& scenario, const SceneMarker& marker);

}  // namespace moiregauge::internal::simulator

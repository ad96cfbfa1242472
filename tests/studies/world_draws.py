# SPDX-License-Identifier: Apache-2.0
"""Draws recordings for world_study.py: the factors of a group, the site file, and the draw file of the renderer."""
import math
import random

GROUPS = ["clean", "rolling, stated", "rolling, not stated", "tone curve", "shadow and flicker", "fast vibration", "out of plane", "covered target",
          "low light", "strong lens", "far small prints", "telephoto", "drone", "rotating targets", "tilted prints", "rolling, vibrating", "mixture"]
STATEMENTS = {  # [known_to]: position mm, rotation deg, height mm, print scale
    "default": (1.0, 0.3, 3.0, 0.0005),
    "taped": (0.5, 0.2, 1.0, 0.0005),
    "surveyed": (0.02, 0.01, 0.02, 0.0002),
}
PATTERNS = ["grid", "squares", "dots", "checkerboard"]


def base_factors(rng):
    """Returns the factors of a clean recording. Every draw takes the same numbers of the generator."""
    f = {
        "width": 1280, "height": 720, "frames": 24, "fps": 10.0, "exposure_ms": rng.choice([1.0, 4.0, 10.0]), "readout_ms": 0.0, "time_samples": 1,
        "focal_px": rng.uniform(950, 1700), "centre_shift_px": rng.uniform(0, 12), "pitch_px": rng.uniform(12, 22), "pitch_mm": rng.choice([5.0, 10.0, 20.0, 40.0]),
        "lens": rng.choice(["brown", "brown", "division", "fisheye"]), "distortion": rng.uniform(-0.02, 0.015), "tangential": rng.uniform(0, 4e-4),
        "wedge": 0.0, "psf_px": rng.uniform(0.65, 0.9), "tail": rng.uniform(0, 0.06), "coma": rng.uniform(-0.08, 0.08), "defocus_px": rng.uniform(0, 0.3),
        "vignetting": rng.uniform(0, 1), "gradient": rng.uniform(0, 0.15), "flicker": 0.0, "shadow": 0.0, "tone": "linear 0",
        "white": rng.uniform(0.7, 0.88), "full_well": rng.choice([8000.0, 15000.0, 30000.0]), "read_noise": rng.uniform(3, 12), "prnu": rng.uniform(0, 0.004),
        "dark": rng.uniform(0, 5), "pedestal": rng.choice([0.0, 0.0, 0.015]), "bits": rng.choice([8, 8, 8, 10, 12]),
        "wall_grey": rng.uniform(0.25, 0.6), "wall_contrast": rng.uniform(0.02, 0.1), "bricks": rng.random() < 0.3,
        "tilt_deg": rng.uniform(0, 12), "roll_deg": rng.uniform(-3, 3), "sway_deg": 10 ** rng.uniform(-1.3, -0.2), "sway_share": 10 ** rng.uniform(-3.5, -2.2),
        "sway_hz": rng.uniform(0.2, 1.2), "drift_deg_s": rng.uniform(-0.1, 0.1), "jolt_deg": rng.choice([0.0, 0.0, 0.2]),
        "references": rng.choice([4, 6, 6]), "targets": rng.choice([1, 2, 2]), "reference_pattern": rng.choice(["grid", "grid", "squares", "dots", "checkerboard"]),
        "target_pattern": rng.choice(PATTERNS), "share": rng.uniform(0.35, 0.55), "statement": rng.choice(list(STATEMENTS)), "soft_px": rng.uniform(0.18, 0.3),
        "paper": rng.uniform(0.85, 1.0), "black": rng.uniform(0.06, 0.2), "ink_rms": rng.uniform(0, 0.05), "paper_rms": rng.uniform(0, 0.01),
        "gloss": rng.uniform(0, 0.05), "move_pitch": 10 ** rng.uniform(-2.5, -0.45), "move_hz": 10 ** rng.uniform(-1, 0.5),
        "move": rng.choice(["sine", "step", "ramp", "mixed", "still"]), "turn_mrad": rng.choice([0.0, 0.0, rng.uniform(0, 2)]),
        "mount_mrad": 0.0, "dz_mm": 0.0, "target_z_share": rng.choice([0.0, 0.0, rng.uniform(-0.02, 0.01)]), "leaf": 0.0, "state_readout": 0,
        "shake_deg": 0.0, "shake_hz": 0.0,
    }
    return f


def of_group(group, f, rng):
    """Changes the factors of a clean recording to those of a group."""
    if group == "mixture":
        # A later group overwrites what an earlier one set, so their order is drawn, too.
        f["mixture"] = "+".join(rng.sample(GROUPS[1:-1], rng.randint(2, 4)))
        group = f["mixture"]
    if "+" in group:
        for name in group.split("+"):
            f = of_group(name, f, rng)
    elif group.startswith("rolling"):
        if group == "rolling, vibrating":
            group = rng.choice(["rolling, stated", "rolling, not stated"])
            f.update(shake_deg=10 ** rng.uniform(-2.7, -1.5), shake_hz=rng.uniform(20, 160))
        f.update(readout_ms=rng.uniform(8, 30), fps=30.0, frames=40, sway_hz=rng.uniform(0.8, 3.0), sway_deg=rng.uniform(0.1, 0.5), exposure_ms=rng.choice([1.0, 4.0]),
                 state_readout=int(group == "rolling, stated"), time_samples=2)
    elif group == "tone curve":
        f.update(tone=rng.choice(["srgb 0", "gamma 1.8", "gamma 2.2", "s-curve 4", "s-curve 6"]), bits=8, pedestal=0.0)
    elif group == "shadow and flicker":
        f.update(shadow=rng.uniform(0.15, 0.5), flicker=rng.uniform(0.02, 0.15))
    elif group == "fast vibration":
        f.update(exposure_ms=rng.choice([50.0, 100.0]), move="sine", move_hz=rng.uniform(2, 9), move_pitch=rng.uniform(0.02, 0.25), time_samples=6, sway_hz=0.4)
    elif group == "rotating targets":
        f.update(turn_mrad=10 ** rng.uniform(-0.5, 1.7))
    elif group == "tilted prints":
        f.update(mount_mrad=10 ** rng.uniform(0.5, 1.6))
    elif group == "out of plane":
        f.update(dz_mm=10 ** rng.uniform(0, 1.5))
    elif group == "covered target":
        f.update(leaf=rng.uniform(0.1, 0.6))
    elif group == "low light":
        f.update(white=rng.uniform(0.12, 0.3), full_well=rng.choice([1500.0, 3000.0]), read_noise=rng.uniform(8, 20), black=rng.uniform(0.25, 0.45))
    elif group == "strong lens":
        f.update(lens=rng.choice(["brown", "division", "fisheye"]), distortion=rng.choice([-0.08, -0.05, 0.04]), wedge=rng.uniform(0, 3e-3),
                 tangential=rng.uniform(0, 1e-3), focal_px=rng.uniform(800, 1100))
    elif group == "far small prints":
        f.update(pitch_px=rng.uniform(8.2, 9.2))
    elif group == "telephoto":
        f.update(focal_px=rng.uniform(5000, 12000), distortion=rng.uniform(-0.003, 0.003), sway_deg=10 ** rng.uniform(-2.3, -1.0), drift_deg_s=rng.uniform(-0.01, 0.01),
                 jolt_deg=0.0, sway_share=10 ** rng.uniform(-4.5, -3.5))
    elif group == "drone":
        f.update(sway_deg=rng.uniform(0.5, 1.5), sway_share=rng.uniform(0.01, 0.04), sway_hz=rng.uniform(0.1, 0.4), exposure_ms=1.0, jolt_deg=0.0)
    return f


def factors_of(group, seed, forced):
    rng = random.Random(f"world {seed}")
    f = base_factors(rng)
    f["mount_mrad"] = random.Random(f"mount {seed}").uniform(0, 6)
    f = of_group(group, f, random.Random(f"{group} {seed}"))
    for key, value in forced.items():
        if key not in f:
            raise SystemExit(f"no such factor: {key}: use one of {', '.join(f)}")
        f[key] = type(f[key])(value) if not isinstance(f[key], bool) else value in ("1", "True")
    return f


def word(*values):
    return " ".join(f"{v:.9g}" if isinstance(v, float) else str(v) for v in values)


def print_size(pattern, pitches):
    """Returns the side of a grating in pitches. Squares and dots are whole at an odd number."""
    return pitches + (pattern in ("squares", "dots"))


def layout(f):
    """Returns the markers by name: role, centre in mm, size in pitches, pattern, and the circle's offset in pitches."""
    scale = f["pitch_mm"] / f["pitch_px"]  # mm per px in the middle
    half_w, half_h = 0.33 * f["width"] * scale, 0.31 * f["height"] * scale
    p = f["pitch_mm"]
    size = print_size(f["reference_pattern"], 6 if f["pitch_px"] < 10 else 4)
    markers = {}
    columns = [-1, 1] if f["references"] == 4 else [-1, 0, 1]
    for row, letter in ((1, "N"), (-1, "S")):
        for c in columns:
            name = letter + {-1: "W", 0: "C", 1: "E"}[c]
            # The circle is outside, one pitch from the grating; a middle circle is to its right.
            side = c if c else 1
            diameter = 2.5 if name == "NW" else 2.0
            gap = 0.5 * size + 1 + 0.5 * diameter
            markers[name] = {"role": "reference", "x": half_w * c * 0.92, "y": half_h * row, "size": size, "pattern": f["reference_pattern"],
                             "circle": (side * gap, 0.0, diameter)}
    size = print_size(f["target_pattern"], 8 if f["pitch_px"] < 10 else 6)
    for i in range(f["targets"]):
        x = (i - 0.5 * (f["targets"] - 1)) * 0.9 * half_w
        markers[f"T{i + 1}"] = {"role": "target", "x": x, "y": 0.05 * half_h, "size": size, "pattern": f["target_pattern"], "circle": None}
    for m in markers.values():
        m["x"], m["y"] = round(m["x"], 2), round(m["y"], 2)
        m["pitch"] = p
    return markers


def site_text(f, markers):
    position, angle, height, scale = STATEMENTS[f["statement"]]
    lines = ["[grating]", f"pitch_mm = {f['pitch_mm']}"]
    for name, m in markers.items():
        p = m["pitch"]
        lines += [f"[[{m['role']}]]", f'name = "{name}"', f'pattern = "{m["pattern"]}"', f"grating_mm = [{m['x']}, {m['y']}]",
                  f"grating_size_mm = [{m['size'] * p}, {m['size'] * p}]"]
        if m["circle"]:
            cx, cy, d = m["circle"]
            lines += [f"circle_mm = [{m['x'] + cx * p}, {m['y'] + cy * p}]", f"circle_diameter_mm = {d * p}"]
    lines += ["[known_to]", f"position_mm = {position}", f"rotation_deg = {angle}", f"height_mm = {height}", f"print_scale = {scale}"]
    return "\n".join(lines) + "\n"


def sway(rng, offset, rate, amplitude, hz):
    """Returns a track of three sines around `hz` whose amplitudes add up to about `amplitude`."""
    parts = [word(float(offset), float(rate))]
    for share, times in ((0.6, 1.0), (0.3, 1.7), (0.15, 2.9)):
        parts.append("sin " + word(amplitude * share * rng.uniform(0.5, 1.2), hz * times * rng.uniform(0.8, 1.2), rng.uniform(0, 2 * math.pi)))
    return " ".join(parts)


def turned(turn, v):
    """Returns a vector rotated about the axis of `turn` by its length."""
    angle = math.sqrt(sum(t * t for t in turn))
    if angle == 0:
        return v
    a = [t / angle for t in turn]
    c, s = math.cos(angle), math.sin(angle)
    d = sum(p * q for p, q in zip(a, v))
    x = (a[1] * v[2] - a[2] * v[1], a[2] * v[0] - a[0] * v[2], a[0] * v[1] - a[1] * v[0])
    return tuple(c * v[i] + s * x[i] + (1 - c) * d * a[i] for i in range(3))


def camera_lines(f, rng, distance):
    tilt, direction = math.radians(f["tilt_deg"]), rng.uniform(0, 2 * math.pi)
    turn = (tilt * math.cos(direction), tilt * math.sin(direction), math.radians(f["roll_deg"]))
    # The line of sight in camera axes is (0, 0, 1). On the board it is this, and the camera is behind it.
    ahead = turned(tuple(-t for t in turn), (0.0, 0.0, 1.0))
    ahead = (ahead[0], -ahead[1], -ahead[2])
    lines, share = [], f["sway_share"] * distance
    for axis, at in zip("xyz", ahead):
        lines.append(f"camera.{axis}_mm {sway(rng, -distance * at, 0.0, share, f['sway_hz'] * rng.uniform(0.6, 1.4))}")
    for axis, at in zip("xyz", turn):
        track = sway(rng, at, math.radians(f["drift_deg_s"]) * rng.uniform(-1, 1), math.radians(f["sway_deg"]), f["sway_hz"] * rng.uniform(0.6, 1.4))
        if f["shake_deg"]:
            track += " sin " + word(math.radians(f["shake_deg"]) * rng.uniform(0.3, 1), f["shake_hz"] * rng.uniform(0.9, 1.1), rng.uniform(0, 6.28))
        if f["jolt_deg"]:
            track += " jolt " + word(math.radians(f["jolt_deg"]) * rng.uniform(0.3, 1), 1.0 + rng.random(), rng.uniform(2, 4), 0.3)
        lines.append(f"camera.turn_{axis}_rad {track}")
    return lines


def lens_lines(f, rng, distance):
    corner = math.hypot(f["width"], f["height"]) / 2 / f["focal_px"]
    d, r2 = f["distortion"], corner * corner
    if f["lens"] == "brown":
        radial = (d / r2 * 1.15, -0.15 * d / r2 ** 2, 0.0)
    elif f["lens"] == "division":  # r_u = r_d / (1 + k r_d^2); at the corner r_d / r_u - 1 is near d
        radial = (d / r2 / (1 + d) ** 2, 0.0, 0.0)
    else:
        theta = math.atan(corner)  # the factor theta (1 + k theta^2) / tan(theta) is 1 + d at the corner
        radial = (((1 + d) * corner / theta - 1) / theta ** 2, 0.0, 0.0)
    aim = rng.uniform(0, 2 * math.pi)
    focus = distance * 1.15
    aperture = f["defocus_px"] / abs(1 / distance - 1 / focus)
    centre = ((f["width"] - 1) / 2 + f["centre_shift_px"] * math.cos(aim), (f["height"] - 1) / 2 + f["centre_shift_px"] * math.sin(aim))
    return [f"lens.kind {f['lens']}", f"lens.radial {word(*map(float, radial))}",
            f"lens.decentring {word(f['tangential'] * math.cos(2 * aim), f['tangential'] * math.sin(2 * aim))}",
            f"lens.wedge {word(f['wedge'] * math.cos(3 * aim), f['wedge'] * math.sin(3 * aim))}",
            f"lens.psf {word(f['psf_px'], f['tail'], 2.5, f['coma'], 0.7 * f['coma'])}", f"lens.focus {word(focus, aperture)}",
            f"lens.vignetting {word(f['vignetting'])}", f"camera.focal_px {word(f['focal_px'])}", f"camera.centre_px {word(*centre)}"]


def movement(f, rng, kind, amplitude):
    """Returns a track of a target along one axis, in mm."""
    duration = f["frames"] / f["fps"]
    if kind == "still":
        return "0 0"
    if kind == "ramp":
        return word(0.0, 2 * amplitude / duration * rng.choice([-1, 1]))
    step = f"step {word(amplitude * rng.choice([-1.0, 1.0]), duration * rng.uniform(0.2, 0.8), 0.15)}"
    sine = f"sin {word(amplitude * rng.uniform(0.5, 1), f['move_hz'] * rng.uniform(0.8, 1.2), rng.uniform(0, 6.28))}"
    return "0 0 " + {"sine": sine, "step": step, "mixed": sine + " " + step}[kind]


def sheet_lines(f, rng, name, m, truth):
    """Returns the lines of one printed sheet. Its true place differs from the site's by a draw from known_to."""
    position, angle, height, scale = truth
    p = m["pitch"] * (1 + rng.gauss(0, scale))
    place = [m["x"] + rng.gauss(0, position), m["y"] + rng.gauss(0, position), rng.gauss(0, height), math.radians(rng.gauss(0, angle))]
    half = 0.5 * m["size"] * p
    left, right = -half - 0.9 * p, half + 0.9 * p
    key = f"sheet.{name}."
    lines = []
    # Tilts by which the print is mounted do not change any other draw.
    mounting = random.Random(f"mount {name} {m['x']:.3f}")
    mount = {axis: mounting.gauss(0, f["mount_mrad"] / 1e3) for axis in "xy"} | {"z": 0.0}
    if m["role"] != "target" and f["mount_mrad"]:
        lines += [f"{key}turn_{axis}_rad {word(tilt)} 0" for axis, tilt in mount.items()]
    if m["circle"]:
        cx, cy, d = (v * p for v in m["circle"])
        left, right = min(left, cx - d / 2 - 0.8 * p), max(right, cx + d / 2 + 0.8 * p)
        lines.append(f"{key}circle_mm {word(cx, cy, d)}")
    if m["role"] == "target":
        place[2] = f["target_z_share"] * f["focal_px"] * m["pitch"] / f["pitch_px"]
        amplitude = f["move_pitch"] * m["pitch"]
        for axis in "xy":
            lines.append(f"{key}d{axis}_mm {movement(f, rng, f['move'], amplitude * rng.uniform(0.3, 1))}")
        turns = {axis: f"{word(mount[axis])} 0 sin {word(f['turn_mrad'] / 1e3 * rng.uniform(0.3, 1), rng.uniform(0.2, 1), rng.uniform(0, 6.28))}" for axis in "xyz"}
        lines += [f"{key}turn_{axis}_rad {track}" for axis, track in turns.items()]
        depth = movement(f, rng, rng.choice(["sine", "step", "ramp"]), f["dz_mm"])
        lines.append(f"{key}dz_mm {depth}")
    white, black = f["paper"] * rng.uniform(0.95, 1), f["black"] * rng.uniform(0.9, 1.1)
    gloss = f["gloss"] / (right - left)
    lines += [f"{key}target {int(m['role'] == 'target')}", f"{key}pattern {m['pattern']}", f"{key}place {word(*place)}", f"{key}seed {rng.randrange(1, 10 ** 6)}",
              f"{key}paper_mm {word((left + right) / 2, 0.0, right - left, 2 * half + 1.8 * p)}", f"{key}grating_mm {word(0.0, 0.0, 2 * half, 2 * half)}",
              f"{key}print {word(p, f['share'], f['soft_px'] * m['pitch'] / f['pitch_px'])}",
              f"{key}ink {word(white, black, f['ink_rms'], f['paper_rms'], gloss * rng.uniform(-1, 1), gloss * rng.uniform(-1, 1))}"]
    return lines


def leaf_lines(f, rng, target):
    """Returns the lines of a leaf that swings in front of the target and covers a part of it for some frames."""
    side = target["size"] * target["pitch"]
    duration = f["frames"] / f["fps"]
    width = side * 0.7
    start = target["x"] - side / 2 - width / 2 - 2 * target["pitch"]
    step = word(f["leaf"] * side + 2 * target["pitch"], duration * rng.uniform(0.35, 0.6), 0.1)
    return ["sheet.leaf.target 0", "sheet.leaf.pattern leaf", f"sheet.leaf.place {word(start, target['y'] + side * rng.uniform(-0.3, 0.3), 15.0, 0.3)}",
            f"sheet.leaf.seed {rng.randrange(1, 10 ** 6)}", f"sheet.leaf.paper_mm {word(0.0, 0.0, width, side * 0.6)}",
            f"sheet.leaf.print {word(1.0, 0.5, f['soft_px'] * target['pitch'] / f['pitch_px'])}", f"sheet.leaf.ink {word(rng.uniform(0.1, 0.5), 0.1, 0.0, 0.15, 0.0, 0.0)}",
            f"sheet.leaf.dx_mm 0 0 step {step} sin {word(0.03 * side, 1.3, 0.0)}", f"sheet.leaf.turn_z_rad 0 0 sin {word(0.1, 0.9, 1.0)}"]


def speed_px_s(f):
    """Returns the speed of the fastest print in the image, roughly."""
    camera = 2 * math.pi * f["sway_hz"] * (math.radians(f["sway_deg"] + f["jolt_deg"]) + f["sway_share"]) * f["focal_px"]
    return camera + 2 * math.pi * f["move_hz"] * f["move_pitch"] * f["pitch_px"]


def draw_text(f, markers, seed):
    """Returns the draw file of the renderer."""
    rng = random.Random(f"scene {seed}")
    samples = max(f["time_samples"], min(24, math.ceil(speed_px_s(f) * f["exposure_ms"] / 1e3 / 0.8)))
    distance = f["pitch_mm"] * f["focal_px"] / f["pitch_px"]
    duration, span = f["frames"] / f["fps"], f["width"] * f["pitch_mm"] / f["pitch_px"]
    slope, shadow_angle = rng.uniform(0, 6.28), rng.uniform(0, 6.28)
    lines = [f"image {f['width']} {f['height']}", f"frames {f['frames']}", f"fps {f['fps']}", f"seed {seed}", f"exposure_s {f['exposure_ms'] / 1e3:.6f}",
             f"readout_s {f['readout_ms'] / 1e3:.6f}", f"time_samples {samples}",
             f"wall.seed {rng.randrange(1, 10 ** 6)}", f"wall.surface {word(-6.0, f['wall_grey'], f['wall_contrast'], 0.7 * span, (0.2 * span if f['bricks'] else 0.0))}",
             f"light.gradient_per_mm {word(2 * f['gradient'] / span * math.cos(slope), 2 * f['gradient'] / span * math.sin(slope))}",
             f"light.flicker {word(f['flicker'], rng.uniform(0.3, 4.0))}", f"light.shadow {word(f['shadow'], shadow_angle, rng.uniform(0.03, 0.2) * span)}",
             f"light.shadow_mm {word(-0.4 * span, 0.8 * span / duration)}",
             f"sensor.tone {f['tone']}", f"sensor.bits {f['bits']}",
             f"sensor.noise {word(f['white'], f['full_well'], f['read_noise'], f['prnu'], f['dark'], f['pedestal'])}"]
    lines += lens_lines(f, rng, distance) + camera_lines(f, rng, distance)
    truth = STATEMENTS[f["statement"]]
    names = list(markers)
    for name in names:
        lines += sheet_lines(f, random.Random(f"sheet {name} {seed}"), name, markers[name], truth)
    if f["leaf"]:
        lines += leaf_lines(f, rng, markers["T1"])
        names.append("leaf")
    return "\n".join([*lines, f"sheets {' '.join(names)}"]) + "\n"

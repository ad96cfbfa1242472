#!/usr/bin/python3
"""Writes docs/performance.md to stdout, from the results of chain_bench and the other scripts of this folder.

  bench/report.py CHAIN_JSON [MORE_CHAIN_JSON ...] --files FILES_JSON --instructions INSTRUCTIONS_JSON --page PAGE_JSON --cpu MODEL --compiler NAME --command "tools/bench ..."
    --commit COMMIT --kernels FINGERPRINT

Ends 1 if a limit is not met (bench/ratios.py), but writes the page.
"""
import argparse
import json
import sys

import ratios
import report_page

# Cases in the order of the table, with their names for the reader.
CASES = (("floor", "one pass over the frame's bytes"), ("textbook", "textbook chain (OpenCV)"),
         ("textbook detection", "its search for the circles"), ("detection", "first detection, full frame"),
         ("tracking", "tracking: circles and five phases"), ("two-stage", "`two-stage`, with u"),
         ("precise", "`precise`, with u"),
         ("patches precise", "`precise`, without u, error in the image"),
         ("patches lucas-kanade", "OpenCV's Lucas-Kanade tracker, 101x101 px, on the five gratings alone"))
STAGES = (("templates", "five patches against their templates"), ("fit and u", "camera's pose, target's place, u"),
          ("circles", "only where not as expected: four circles, in their windows"),
          ("rasters", "the same: five patches on rasters (`two-stage`'s reading)"),
          ("outline", "the same: the target's whole pitch, from its outline"))
MEMORIES = ("hot", "ring", "cold")


NEXT = """## What would be next

The aims are not reached where a pass over every pixel of the prints is what is left of a frame. `precise` makes 1.3 such passes, and
tracking one over a third of the rows. Sixteen pixels take about 160 cycles with AVX-512. By count of operations, a quarter loads and
transposes the nodes of the template, and a third is the sums of 27 columns. A template that is a product of two lines' (grids, cosines) needs no nodes, and
sums of the field by rows need a third of the products. Both change results by a fraction of u, so they need new tables of accuracy.

First detection is the tracing of outlines that end as no disc (most of them squares of gratings) and the fits of those that do. `measure`
of uncompressed files waits for the SHA-256 of the input and for what is done once: the reference frame, its templates, the scene, the
overlay. Of decoded files all but the scene at the end is hidden behind the decoder.

With many targets, set-up is the learning of the templates (two thirds, one target after the other) and the dense system of the bundle
adjustment. Frames are read target after target on one core."""


def errors(row):
    """Returns the errors along x and y as text: rms, and scatter in brackets."""
    for unit, scale, shown in (("mm", 1000, "um"), ("px", 1, "px")):
        if f"error_x_{unit}" in row:
            return ", ".join(f"{scale * row[f'error_{axis}_{unit}']:.2g} ({scale * row[f'scatter_{axis}_{unit}']:.2g})"
                             for axis in ("x", "y")) + " " + shown
    return ""


def chain_table(chain):
    lines = ["| work | size | frames | textbook's time over this | this over one pass | error along x, y | picture bytes |",
             "|---|---|---|---|---|---|---|"]
    for name, title in CASES:
        for size in (ratios.SMALL, ratios.LARGE):
            for memory in MEMORIES:
                row = chain.medians.get(f"{name}/{size}/{memory}")
                if row is None:
                    continue
                textbook = chain.share(("textbook", "ring"), (name, memory), size)
                floor = chain.share((name, memory), ("floor", "ring"), size)
                error = errors(row)
                lost = f", {100 * row['lost']:.2g} % lost" if row["lost"] > 0 else ""
                lines.append(f"| {title} | {size} | {memory} | {textbook:.3g}x | {floor:.3g} | {error}{lost} | "
                             f"{row['bytes'] / 1e6:.2f} MB |")
    return "\n".join(lines)


def stage_table(chain):
    lines = ["| stage | " + " | ".join((ratios.SMALL, ratios.LARGE)) + " |", "|---|---|---|"]
    sizes = (ratios.SMALL, ratios.LARGE)
    for name, title in STAGES:
        shares = (chain.share((f"stage {name}", "ring"), ("precise", "ring"), size) for size in sizes)
        lines.append(f"| {title} | " + " | ".join(f"{100 * share:.0f} %" for share in shares) + " |")
    frames = int(chain.case("precise", ratios.SMALL, "ring")["error_frames"])
    for name, title in (("reference", "the reference frame: circles, site check, templates"),
                        ("scene", f"the scene, solved from {frames} frames")):
        shares = (chain.share((f"stage {name}", "ring"), ("precise", "ring"), size) for size in sizes)
        lines.append(f"| once per run: {title} | " + " | ".join(f"{share:.1f} frames' time" for share in shares) + " |")
    return "\n".join(lines)


def instruction_table(path):
    with open(path, encoding="utf-8") as file:
        parts = json.load(file)
    lines = ["| part of a frame | instructions | bytes of the prints' windows | instructions a byte |", "|---|---|---|---|"]
    lines += [f"| {name} | {part['instructions'] / 1e6:.2f} million | {part['bytes'] / 1e3:.0f} kB | "
              f"{part['instructions'] / part['bytes']:.1f} |" for name, part in parts.items()]
    return "\n".join(lines)


def file_table(measured):
    lines = ["| file | frames | decoding alone, passes over its bytes | `measure` / decoding, wall | the same, CPU |",
             "|---|---|---|---|---|"]
    for name, file in measured["files"].items():
        measure, decode, once = (file[key] for key in ("measure", "decode", "bytes"))
        lines.append(f"| {name} | {file['frames']} | {decode['wall_s'] / once['wall_s']:.3g} | "
                     f"{measure['wall_s'] / decode['wall_s']:.3g} | {measure['cpu_s'] / decode['cpu_s']:.3g} |")
    return "\n".join(lines)


def chains_with(chain):
    return f"""## Chains, {chain.vectors}

{chain_table(chain)}

"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("chain", nargs="+")
    for word in ("--files", "--instructions", "--page", "--cpu", "--compiler", "--command", "--commit", "--kernels"):
        parser.add_argument(word)
    words = parser.parse_args()
    chains = [ratios.Chain(path) for path in words.chain]
    chain = chains[0]
    with open(words.files, encoding="utf-8") as file:
        measured = json.load(file)
    with open(words.page, encoding="utf-8") as file:
        page = json.load(file)
    rows = ratios.rows_of(chains, words.files)
    cores, cache = chain.context["num_cpus"], int(chain.context["last_level_cache_bytes"]) / ratios.MIB
    print(f"""# Performance

Made by `{words.command}`; do not edit. Made at commit `{words.commit}`, kernels `{words.kernels}` (`bench/kernels.py`). Every figure is a ratio within one run: medians of CPU time of cases that ran in turn, at
random, on one core. Milliseconds would be those of the machine: {words.cpu}, {cores} cores, {cache:.0f} MiB of last-level cache,
{words.compiler}. The yardstick is `bench/textbook_chain.cc`, the paper's chain as one writes it with OpenCV on one thread; the floor is
one plain pass over a frame's bytes. Frames are the simulator's (`rig-1xyz`, every 4th), so that every case states its error too: rms since
the reference frame, and in brackets the scatter about the frames' mean, in which the noise of the one reference frame drops out.

`hot`: the same frame again and again. `ring`: a few dozen frames to and fro; their markers' windows stay in the last-level cache, whole
frames do not. `cold`: more copies than fit into the cache, even windows.

## Gates

{ratios.table(rows)}
{"".join(chains_with(c) for c in chains)}## Where a frame's time goes

Shares of a frame of `precise` (ring, {chain.vectors}). A frame in which all is as expected has the first two; the rest is
discs, homographies and copying.

{stage_table(chain)}

Instructions, counted by callgrind with AVX2 at {ratios.SMALL}:

{instruction_table(words.instructions)}

## Files

4096x2168; `measure` is the default method, all of it from opening the file to the last row written.

{file_table(measured)}

{report_page.section(page)}
{NEXT}""")
    return 1 if any(row.verdict().startswith("**fails") for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())

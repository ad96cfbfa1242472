#!/usr/bin/python3
"""Tests that docs/schema/run.schema.json accepts valid files and refuses invalid ones."""
import copy
import json
import pathlib
import unittest

import jsonschema

SCHEMA = json.loads((pathlib.Path(__file__).resolve().parents[2] / "docs/schema/run.schema.json").read_text(encoding="utf-8"))
RUN = {
    "moiregauge": "0.1.0", "schema": 1,
    "input": {"path": "bridge.mp4", "sha256": "0" * 64, "frames": 2, "width": 1024, "height": 512, "bits": 8, "fps": None,
              "codec": "png", "rotation_deg": 0, "time_source": "none",
              "tone": "linear", "tone_source": "tag"},
    "config": {}, "method": "two-stage", "reference_frame": 0,
    "camera": {"model": "none", "width": None, "height": None, "fx": None, "fy": None, "cx": None, "cy": None, "k1": None,
               "k2": None, "p1": None, "p2": None, "k3": None, "u": {}},
    "markers": [{"name": "NW", "role": "reference", "x_mm": 1.0, "y_mm": 2.0, "z_mm": None, "angle_deg": 0.0,
                 "pitch_px": 29.0, "modulation": 50.0, "u": {}}],
    "scene": {"model": "none", "chi2_dof": None, "key_frames": []},
    "targets": [{"name": "mid", "frames": 2, "ok": 1, "status_counts": {"ok": 1, "lost": 1}, "u_dx_mm": 0.001,
                 "u_dy_mm": None, "budget": {}}],
    "references_verified": False, "warnings": [], "exit_code": 0, "complete": True,
}


def accepted(run):
    return jsonschema.Draft7Validator(SCHEMA).is_valid(run)


class RunSchema(unittest.TestCase):
    def test_a_whole_run_is_accepted(self):
        jsonschema.Draft7Validator.check_schema(SCHEMA)
        jsonschema.validate(RUN, SCHEMA)

    def test_every_key_is_required(self):
        for key in RUN:
            run = copy.deepcopy(RUN)
            del run[key]
            self.assertFalse(accepted(run), key)

    def test_the_status_list_is_closed(self):
        run = copy.deepcopy(RUN)
        run["targets"][0]["status_counts"]["probably"] = 1
        self.assertFalse(accepted(run))

    def test_a_method_without_a_row_in_the_table_is_refused(self):
        run = copy.deepcopy(RUN)
        run["method"] = "optical-flow"
        self.assertFalse(accepted(run))


if __name__ == "__main__":
    unittest.main()

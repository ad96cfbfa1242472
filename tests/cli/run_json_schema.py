"""Checks that run.json of several runs matches docs/schema/run.schema.json."""
from runs import run, simulate, start

program, work, source = start()
simulate(program, work / "run")
for method, code in [("two-stage", 0), ("conventional", 4), ("precise", 0)]:
    run([program, "measure", work / "run/frames", "--site", work / "run/site.toml", "--method", method, "-o", work / method],
        expected=code)
    run(["/usr/bin/python3", source / "tests/cli/check_run_json.py", source / "docs/schema/run.schema.json",
         work / method / "run.json"])

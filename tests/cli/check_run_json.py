#!/usr/bin/python3
"""Validates a run.json against its schema: check_run_json.py SCHEMA RUN_JSON."""
import json
import sys

import jsonschema


def not_json(word):
    raise ValueError(f"{word} is not JSON: write null")


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    with open(sys.argv[1], encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft7Validator.check_schema(schema)
    with open(sys.argv[2], encoding="utf-8") as file:
        run = json.load(file, parse_constant=not_json)
    wrong = sorted(jsonschema.Draft7Validator(schema).iter_errors(run), key=lambda error: list(map(str, error.absolute_path)))
    for error in wrong:
        print("/".join(map(str, error.absolute_path)) or "(top)", error.message, sep=": ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

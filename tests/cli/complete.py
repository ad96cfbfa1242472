#!/usr/bin/python3
"""Tests completion in bash, and the syntax of the completion for zsh (zsh -n).

    complete.py MOIREGAUGE WORK

Each row of the table has the words before the cursor, the words that must be offered, and those that must not.
"""
import pathlib
import shutil
import subprocess
import sys

TABLE = [
    (["moiregauge", "me"], {"measure"}, {"solve"}),
    (["moiregauge", ""], {"measure", "solve", "inspect", "calibrate", "simulate", "reproduce", "help"}, {"completion"}),
    (["moiregauge", "measure", "--res"], {"--rest", "--resume", "--restart"}, {"--site"}),
    (["moiregauge", "measure", "--axes", ""], {"print", "image"}, {"clip one.mp4"}),
    (["moiregauge", "measure", "--method", "t"], {"two-stage"}, {"precise"}),
    (["moiregauge", "measure", "--site", "s"], {"site.toml", "sites"}, {"--site"}),
    (["moiregauge", "measure", "-o", ""], {"sites"}, {"site.toml"}),
    (["moiregauge", "measure", "--pitch", ""], set(), {"site.toml", "--site"}),
    (["moiregauge", "measure", "cl"], {"clip one.mp4"}, {"site.toml"}),
    (["moiregauge", "solve", ""], {"sites"}, {"site.toml"}),
    (["moiregauge", "simulate", "small-1x"], {"small-1x", "small-1xyz"}, {"rig-1x"}),
    (["moiregauge", "simulate", "--codec", ""], {"ffv1", "x264", "mjpeg"}, set()),
    (["moiregauge", "help", "mea"], {"measure"}, {"solve"}),
]
ASK = 'source ./completion.bash; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); compopt() { :; }; _moiregauge; printf "%s\\n" "${COMPREPLY[@]}"'


def offered(work, words):
    done = subprocess.run(["bash", "-uc", ASK, "bash", *words], cwd=work, capture_output=True, text=True, check=True)
    assert not done.stderr, done.stderr
    return set(done.stdout.splitlines()) - {""}


def main():
    program, work = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(work, ignore_errors=True)
    (work / "sites").mkdir(parents=True)
    (work / "site.toml").write_text("")
    (work / "clip one.mp4").write_text("")
    for shell in ["bash", "zsh"]:
        text = subprocess.run([program, "completion", shell], capture_output=True, text=True, check=True).stdout
        (work / f"completion.{shell}").write_text(text)
    failed = 0
    for words, must, must_not in TABLE:
        got = offered(work, words)
        if must - got or must_not & got or (not must and got):
            failed += 1
            print(words, "offered", sorted(got), "missing", sorted(must - got), "too much", sorted(must_not & got))
    subprocess.run(["zsh", "-n", "completion.zsh"], cwd=work, check=True)
    print(f"{len(TABLE) - failed} of {len(TABLE)} rows as they should be")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

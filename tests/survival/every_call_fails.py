"""A part of what tools/survival-study injects: every third call; over old results, into a new folder, and with a
run that goes on."""
import errno
import pathlib
import sys

from survival import long_clip, start
from injections import Injections

program, work, _ = start()
clip, site = long_clip(program, work, 4)
injections = Injections(program, pathlib.Path(sys.argv[4]), clip, site, work / "out")
injections.all(["finished"], [(errno.ENOSPC, "on")], stride=3)
injections.all(["nothing"], [(errno.EIO, "once")], stride=3)
injections.all(["unfinished"], [(errno.ENOSPC, "short")], stride=3)
print(injections.count, "injections", injections.by_call)

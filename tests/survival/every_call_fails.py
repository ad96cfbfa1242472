"""Makes every third writing call fail: with old results, in a new folder, and in a resumed run.

tools/survival-study does so for every call.
"""
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

"""Kills runs (kill -9) at random times. Checks the remaining data, the loss by a power cut, and --resume."""
import random
import signal

from survival import (Records, with_suffix, clear, contents, done, error_lines, insist, insist_same, kill_after, measure,
                      with_failing_calls)


class Kills:
    def __init__(self, program, library, clip, site, out, frames, seconds):
        self.library, self.out, self.frames, self.seconds = library, out, frames, seconds
        self.plain = measure(program, clip, site, out)
        self.journal = with_suffix(out, ".unfinished") / "run.mgj"
        self.phase = {"before the first frame was kept": 0, "while frames were measured": 0, "while results were made and written": 0,
                      "after its end": 0}
        self.kept_late = self.synced_late = 0.0  # s, maxima

    def late(self, log, killed, records):
        """Returns the times in s from the last stored frame, and from the first frame without a sync, to the kill."""
        lines = [line.split() for line in log.read_text().splitlines()]
        lines = [(what, int(size), float(at)) for _, what, size, at, path in lines if path.endswith("/run.mgj")]
        synced = max((size for what, size, _ in lines if what == "synced"), default=0)
        writes = [(size, at) for what, size, at in lines if what == "write"]
        first_lost = [at for size, at in writes if size >= synced]
        in_frames = 0 < records.frames() < self.frames
        return (killed - writes[-1][1] if in_frames else 0.0), (killed - first_lost[0] if first_lost else 0.0)

    def one(self, wanted, seed):
        clear(self.out)
        rng = random.Random(seed)
        if seed % 2 == 0:  # with old results in the output folder
            self.out.mkdir()
            for name, data in wanted.items():
                (self.out / name).write_bytes(data)
        before = contents(self.out)
        log = self.out.parent / f"calls-of-{self.out.name}.log"
        log.unlink(missing_ok=True)
        killed, code, _ = kill_after(self.plain, rng.uniform(0.0, self.seconds),
                                     with_failing_calls(self.library, self.out, log=log))
        what = f"kill {seed}"
        if code != -signal.SIGKILL:
            insist(code == 0, f"{what}: exit {code}")
            self.phase["after its end"] += 1
            return
        insist(contents(self.out) in (before, wanted), f"{what}: old results were touched")
        records = Records(self.journal.read_bytes() if self.journal.exists() else b"")
        if records.frames():
            kept, synced = self.late(log, killed, records)
            self.kept_late, self.synced_late = max(self.kept_late, kept), max(self.synced_late, synced)
            again = done(self.plain)
            insist(again.returncode == 2 and len(error_lines(again.stderr)) == 1 and
                   f"({records.frames()} frames)" in again.stderr, f"{what}: {again.stderr}")
        self.phase[list(self.phase)[0 if not records.frames() else 1 if records.frames() < self.frames else 2]] += 1
        again = done([*self.plain, "--resume"])
        insist(again.returncode == 0, f"{what}: --resume: exit {again.returncode}: {again.stderr}")
        insist_same(self.out, wanted, what)

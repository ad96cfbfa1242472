"""Makes each writing call fail in turn.

Requires one error line, exit 6, unchanged old results, and the same bytes after --resume.
"""
import errno

from survival import (with_suffix, clear, contents, done, error_lines, insist, insist_same, measure, with_failing_calls)


class Injections:
    def __init__(self, program, library, clip, site, out):
        self.library, self.out = library, out
        self.plain = measure(program, clip, site, out)
        self.count, self.by_call = 0, {}
        clear(out)
        first = done(self.plain)
        insist(first.returncode == 0, first.stderr)
        self.wanted = contents(out)

    def before(self, state):
        """Prepares the output folder: nothing, finished (old results), or unfinished (journal of a stopped run)."""
        clear(self.out)
        if state == "finished":
            self.old = dict(self.wanted)
            self.out.mkdir()
            for name, data in self.wanted.items():
                (self.out / name).write_bytes(data)
            (self.out / "mark").write_bytes(b"old")  # distinguishes old results from new ones
            self.old["mark"] = b"old"
        elif state == "unfinished":
            data = self.wanted["run.mgj"]
            unfinished = with_suffix(self.out, ".unfinished")
            unfinished.mkdir()
            (unfinished / "run.mgj").write_bytes(data[:len(data) // 2])

    def one(self, state, at, why, how):
        """Injects one failure and checks the results. Returns False if the run made fewer calls than `at`."""
        self.before(state)
        log = self.out.parent / f"calls-of-{self.out.name}.log"
        log.unlink(missing_ok=True)
        command = self.plain + (["--resume"] if state == "unfinished" else [])
        run = done(command, with_failing_calls(self.library, self.out, at=at, **{"with": why}, how=how, log=log))
        calls = [line.split() for line in log.read_text().splitlines()]
        names = {int(line[0]): f"{line[1]} {line[4].split('/')[-1]}" for line in calls if line[0] != "0"}
        reached = at + (how == "short")
        if reached not in names:
            return False
        what = f"{state}, {errno.errorcode[why]} {how} at call {at} ({names[at]})"
        if how == "short" and not names[at].startswith("write"):
            return True  # only a write can be half done
        self.count += 1
        kind = names[at].split()[0]
        self.by_call[kind] = self.by_call.get(kind, 0) + 1
        insist(run.returncode == 6, f"{what}: exit {run.returncode}\n{run.stderr}")
        insist(len(error_lines(run.stderr)) == 1 and len(run.stderr.splitlines()) == 1, f"{what}: stderr\n{run.stderr}")
        self.insist_whole(what, state, "parent folder" if names[at].startswith("fsync " + self.out.parent.name) else "")
        again = done(self.plain + ["--resume"])
        insist(again.returncode == 0, f"{what}: --resume: exit {again.returncode}\n{again.stderr}")
        insist_same(self.out, self.wanted, what)
        return True

    def insist_whole(self, what, state, put_in_place):
        """Checks that DIR has all old or all new results, and that only a journal remains next to it."""
        found = contents(self.out)
        allowed = [self.old if state == "finished" else None]
        if put_in_place:
            allowed.append(self.wanted)  # only the sync of the folder failed
        insist(found in allowed, f"{what}: {self.out.name} holds {found and sorted(found)}")
        left = contents(with_suffix(self.out, ".unfinished"))
        insist(left is None or set(left) <= {"run.mgj"}, f"{what}: half written: {left and sorted(left)}")

    def all(self, states, ways, stride=1):
        for state in states:
            for why, how in ways:
                at = 1
                while self.one(state, at, why, how):
                    at += stride

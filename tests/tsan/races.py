"""Reports of the thread sanitizer, also those of processes whose stderr is not shown."""
import os
import sys


class Races:
    def __init__(self, work):
        self.work = work
        os.environ["TSAN_OPTIONS"] = os.environ.get("TSAN_OPTIONS", "") + f":log_path={work / 'race'}"

    def text(self):
        return "\n".join(path.read_text(errors="replace") for path in sorted(self.work.glob("race.*")))

    def insist(self, condition, message):
        """Fails with the message and all reports, also if there are reports only."""
        reports = self.text()
        if not condition or reports:
            sys.exit(f"{message if not condition else 'races'}\n{reports}")

"""Reports of the thread sanitizer, also those of processes whose stderr is not shown."""
import atexit
import os
import sys


class Races:
    def __init__(self, work):
        self.work = work
        os.environ["TSAN_OPTIONS"] = os.environ.get("TSAN_OPTIONS", "") + f":log_path={work / 'race'}"
        atexit.register(lambda: print(self.text(), file=sys.stderr))  # also if the script fails because a program ended

    def text(self):
        return "\n".join(path.read_text(errors="replace") for path in sorted(self.work.glob("race.*")))

    def insist(self, condition, message):
        """Fails with the message, also if there are reports only."""
        if not condition or self.text():
            sys.exit(str(message) if not condition else "races")

"""Does a document still tell what the program says? Words and whole numbers must be the same; numbers with a decimal point may differ by a
tenth, or by 0.002 (mm), so that not every change of a method's last digits makes a document wrong."""
import difflib
import itertools
import re

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")


def is_alike(old, new):
    if NUMBER.sub("#", old) != NUMBER.sub("#", new):
        return False
    for a, b in zip(NUMBER.findall(old), NUMBER.findall(new)):
        if "." not in a and "." not in b:
            if a != b:
                return False
        elif abs(float(a) - float(b)) > max(0.1 * abs(float(a)), 0.002):
            return False
    return True


def differences(old, new):
    """Pairs of lines that tell something else; of what is there in one of the two only, with nothing."""
    old, new, pairs = old.splitlines(), new.splitlines(), []
    masked = [[NUMBER.sub("#", line) for line in text] for text in (old, new)]
    for kind, a, b, c, d in difflib.SequenceMatcher(None, *masked, autojunk=False).get_opcodes():
        if kind == "equal":
            pairs += zip(old[a:b], new[c:d])
        else:
            pairs += itertools.zip_longest(old[a:b], new[c:d], fillvalue="")
    return [(one, other) for one, other in pairs if not is_alike(one, other)]

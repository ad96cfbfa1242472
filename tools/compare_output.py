"""Compares the output of the program with its copy in a page.

Words and integers must be equal. Numbers with a decimal point may differ by 10 %, or by 0.002 (mm). A change of the
last digits thus does not make a page wrong.
"""
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
    """Returns the pairs of lines that differ. A line of one text only is paired with an empty line."""
    old, new, pairs = old.splitlines(), new.splitlines(), []
    masked = [[NUMBER.sub("#", line) for line in text] for text in (old, new)]
    for kind, a, b, c, d in difflib.SequenceMatcher(None, *masked, autojunk=False).get_opcodes():
        if kind == "equal":
            pairs += zip(old[a:b], new[c:d])
        else:
            pairs += itertools.zip_longest(old[a:b], new[c:d], fillvalue="")
    return [(one, other) for one, other in pairs if not is_alike(one, other)]

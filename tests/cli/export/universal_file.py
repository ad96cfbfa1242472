"""Reads universal files (datasets 15, 58 and 164) strictly by the columns of their specification."""


def datasets(text):
    """Returns the (number, lines) of all datasets."""
    lines = text.split("\n")
    assert lines[-1] == "" and all(len(line) <= 80 for line in lines), "lines of at most 80 characters"
    found, i = [], 0
    while i < len(lines) - 1:
        assert lines[i] == "    -1", f"line {i + 1}: {lines[i]!r} is no mark"
        number, end = int(lines[i + 1][:6]), lines.index("    -1", i + 2)
        found.append((number, lines[i + 2:end]))
        i = end + 1
    return found


def fields(line, *widths):
    line, out = line.ljust(sum(widths)), []
    for width in widths:
        out.append(line[:width])
        line = line[width:]
    assert not line.strip(), f"left over: {line!r}"
    return out


def real(text):
    return float(text.replace("D", "E"))


def units(lines):
    code, words, temperature = fields(lines[0], 10, 20, 10)
    return {"code": int(code), "words": words.strip(), "mode": int(temperature),
            "factors": [real(v) for v in fields(lines[1], 25, 25, 25)], "offset": real(lines[2])}


def nodes(lines):
    out = {}
    for line in lines:
        f = fields(line, 10, 10, 10, 10, 13, 13, 13)
        out[int(f[0])] = tuple(float(v) for v in f[4:])
    return out


def axis(line):
    kind, length, force, temperature, _, label, _, unit = fields(line, 10, 5, 5, 5, 1, 20, 1, 20)
    return {"kind": int(kind), "exponents": (int(length), int(force), int(temperature)), "label": label.strip(), "unit": unit.strip()}


def function(lines):
    ids = [line.strip() for line in lines[:5]]
    six = fields(lines[5], 5, 10, 5, 10, 1, 10, 10, 4, 1, 10, 10, 4)
    seven = fields(lines[6], 10, 10, 10, 13, 13, 13)
    count, even = int(seven[1]), int(seven[2])
    out = {"ids": ids, "type": int(six[0]), "id": int(six[1]), "version": int(six[2]), "node": int(six[6]),
           "direction": int(six[7]), "precision": int(seven[0]), "even": even, "abscissa": axis(lines[7]),
           "ordinate": axis(lines[8]), "denominator": axis(lines[9]), "z": axis(lines[10])}
    numbers = []
    for line in lines[11:]:
        widths = [20] * 4 if even else [13, 20, 20] if int(seven[0]) == 6 else [13, 20, 13, 20]
        numbers += [float(v) for v in fields(line, *widths) if v.strip()]
    if int(seven[0]) == 6:  # complex, double precision
        assert not even, "complex values at even abscissas are not written"
        out["t"] = numbers[0::3]
        out["y"] = [complex(re, im) for re, im in zip(numbers[1::3], numbers[2::3])]
    elif even:
        start, step = float(seven[3]), float(seven[4])
        out["t"], out["y"] = [start + k * step for k in range(len(numbers))], numbers
    else:
        out["t"], out["y"] = numbers[0::2], numbers[1::2]
    assert len(out["y"]) == count and len(out["t"]) == count, f"{len(out['y'])} values, record 7 says {count}"
    return out

"""Renders pages as printed on paper and as imaged by a camera."""
import subprocess

import numpy


def page(pdf, dpi, number=1):
    """Returns the grey levels of a page at `dpi`, one per dot, rendered by poppler."""
    done = subprocess.run(["pdftoppm", "-r", str(dpi), "-gray", "-f", str(number), "-l", str(number), str(pdf)],
                          capture_output=True, check=True)
    kind, width, height, most = done.stdout[:100].split(maxsplit=4)[:4]
    assert kind == b"P5" and most.split()[0] == b"255"
    return numpy.frombuffer(done.stdout[-int(width) * int(height):], numpy.uint8).reshape(int(height), int(width))


def binned(picture, times):
    """Returns the image of a sensor with pixels of `times` x `times` dots: paper is 210, ink 40."""
    height, width = picture.shape[0] // times, picture.shape[1] // times
    cut = picture[:height * times, :width * times].astype(float)
    return (40 + 2 / 3 * cut.reshape(height, times, width, times).mean((1, 3))).round().astype(numpy.uint8)

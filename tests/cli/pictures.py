"""Minimal readers and writers of PNG and TIFF, so that the tests do not depend on an image library."""
import struct
import zlib

import numpy


def read_png(path):
    """Reads a PNG of 8- or 16-bit grey, not interlaced."""
    data = open(path, "rb").read()
    position, packed, header = 8, b"", None
    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position:position + 8])
        body = data[position + 8:position + 8 + length]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        position += 12 + length
    width, height, bits, colour = header[:4]
    assert colour == 0 and bits in (8, 16), header
    step = bits // 8
    raw = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + width * step)
    out = numpy.zeros((height, width * step), numpy.uint8)
    above = numpy.zeros(width * step, numpy.uint8)
    for y in range(height):
        out[y] = above = unfiltered(raw[y, 0], raw[y, 1:], above, step)
    return out if step == 1 else out.view(">u2").astype(numpy.uint16)


def unfiltered(kind, line, above, step):
    if kind == 0:
        return line.copy()
    if kind == 2:
        return line + above
    if kind == 1:
        return numpy.cumsum(line.reshape(-1, step).astype(numpy.uint32), axis=0).astype(numpy.uint8).reshape(-1)
    out = numpy.zeros_like(line)
    for x in range(len(line)):
        a = int(out[x - step]) if x >= step else 0
        b = int(above[x])
        c = int(above[x - step]) if x >= step else 0
        if kind == 3:
            guess = (a + b) // 2
        else:
            p = a + b - c
            guess = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
        out[x] = (int(line[x]) + guess) & 255
    return out


def write_png(path, picture):
    """Writes a PNG of 8-bit grey."""
    height, width = picture.shape
    lines = b"".join(b"\0" + picture[y].tobytes() for y in range(height))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(lines, 1)) + chunk(b"IEND", b""))


def write_tiff_pages(path, pages):
    """Writes a TIFF of 16-bit grey, uncompressed, little-endian, one strip per page."""
    with open(path, "wb") as file:
        file.write(b"II*\0\0\0\0\0")
        link = 4
        for page in pages:
            height, width = page.shape
            strip = file.tell()
            file.write(page.astype("<u2").tobytes())
            here = file.tell()
            entries = [(256, 4, width), (257, 4, height), (258, 3, 16), (259, 3, 1), (262, 3, 1), (273, 4, strip), (277, 3, 1),
                       (278, 4, height), (279, 4, 2 * width * height)]
            file.write(struct.pack("<H", len(entries)))
            for tag, kind, value in entries:
                file.write(struct.pack("<HHII", tag, kind, 1, value))
            next_link = file.tell()
            file.write(b"\0\0\0\0")
            end = file.tell()
            file.seek(link)
            file.write(struct.pack("<I", here))
            file.seek(end)
            link = next_link

"""Writes the few image files that the tests of the programs need, byte by byte, so that they can be broken at will."""
import math
import struct
import zlib


def exr(path, width, height, channels):
    """Uncompressed scanline OpenEXR; channels: {name: list of width * height floats}."""

    def attribute(name, kind, data):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data

    names = sorted(channels)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    table = b"".join(n.encode() + b"\0" + struct.pack("<iBxxxii", 2, 0, 1, 1) for n in names) + b"\0"
    header = struct.pack("<ii", 20000630, 2)
    header += attribute("channels", "chlist", table)
    header += attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", window)
    header += attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    line_bytes = 8 + 4 * width * len(names)
    first = len(header) + 8 * height
    offsets = b"".join(struct.pack("<Q", first + y * line_bytes) for y in range(height))
    lines = b""
    for y in range(height):
        lines += struct.pack("<ii", y, line_bytes - 8)
        for name in names:
            lines += struct.pack("<%df" % width, *channels[name][y * width:(y + 1) * width])
    with open(path, "wb") as file:
        file.write(header + offsets + lines)


def tiff(path, width, height, values):
    """One strip of little-endian 32-bit floats."""
    data = struct.pack("<%df" % len(values), *values)
    entries = [(256, 4, width), (257, 4, height), (258, 3, 32), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1),
               (278, 4, height), (279, 4, len(data)), (339, 3, 3)]
    directory = struct.pack("<H", len(entries))
    for tag, kind, value in entries:
        directory += struct.pack("<HHII", tag, kind, 1, value)
    with open(path, "wb") as file:
        file.write(b"II" + struct.pack("<HI", 42, 8 + len(data)) + data + directory + struct.pack("<I", 0))


def png(path, width, height, values, channels=1, bits=16):
    """values: width * height * channels integers."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    row = width * channels
    code = ">%d%s" % (row, "H" if bits == 16 else "B")
    lines = b"".join(b"\0" + struct.pack(code, *values[y * row:(y + 1) * row]) for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, bits, 0 if channels == 1 else 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


def cliff(side=48):
    """Elevations of a wall of some 65 degrees between two flats, a sample a metre."""

    def step(t):
        t = min(max(t, 0), 1)
        return t * t * (3 - 2 * t)

    return [14 * step((x + 3 * math.sin(0.13 * y) - 20) / 8) + 0.05 * y for y in range(side) for x in range(side)]

"""Writes the letters of a font as outlines: `python3 outlines.py FONT.ttf`, with fonttools 4, prints the table.

A line for each character: its code, its advance, its outline as the `d` of an SVG's path, and what is added to the advance
before which other characters (kerning). All counts in 2048ths of the size, y downward.
"""

import sys

from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.ttLib import TTFont


def path(glyphs, name):
    """The outline of a glyph; composites are taken apart."""
    pen = DecomposingRecordingPen(glyphs)
    glyphs[name].draw(pen)
    out = []
    at = lambda point: f"{round(point[0])} {round(-point[1])}"
    for command, points in pen.value:
        if command == "moveTo":
            out.append(f"M{at(points[0])}")
        elif command == "lineTo":
            out.append(f"L{at(points[0])}")
        elif command == "closePath":
            out.append("Z")
        elif command == "qCurveTo":
            # A point on the curve lies between two that follow one another off it.
            *off, last = points
            for i, control in enumerate(off):
                end = last if i + 1 == len(off) else tuple(0.5 * (a + b) for a, b in zip(control, off[i + 1]))
                out.append(f"Q{at(control)} {end[0]:g} {-end[1]:g}")
    return "".join(out)


def kerning(font, characters):
    """What is added to the advance of the first of two glyphs."""
    pairs = {}
    subtables = [s for lookup in font["GPOS"].table.LookupList.Lookup for s in lookup.SubTable]
    for table in subtables:
        assert (table.LookupType, table.Format, table.ValueFormat2) == (2, 2, 0)
        for first in table.Coverage.glyphs:
            row = table.Class1Record[table.ClassDef1.classDefs.get(first, 0)].Class2Record
            for second in characters:
                value = row[table.ClassDef2.classDefs.get(second, 0)].Value1
                if value and value.XAdvance:
                    pairs.setdefault(first, {}).setdefault(second, value.XAdvance)
    return pairs


def main():
    font = TTFont(sys.argv[1])
    assert font["head"].unitsPerEm == 2048
    codes = {name: code for code, name in font.getBestCmap().items()}
    assert len(codes) == len(font.getBestCmap()), "no two characters share a glyph"
    glyphs, pairs = font.getGlyphSet(), kerning(font, codes) if font["GPOS"].table.LookupList else {}
    # The first stands for all characters that the font has not.
    for name, code in [(".notdef", 0), *sorted(codes.items(), key=lambda item: item[1])]:
        kerned = sorted((codes[second], value) for second, value in pairs.get(name, {}).items())
        after = " ".join(f"{second:x}:{value}" for second, value in kerned)
        print(f"{code:x}\t{glyphs[name].width}\t{path(glyphs, name)}\t{after}")


main()

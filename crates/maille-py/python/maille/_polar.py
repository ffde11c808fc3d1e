"""How limits are drawn against the direction of pull: as the program's plots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.projections.polar import PolarAxes

#: Colours of curves below and above l2 = 0, from the one nearest to 0 outward.
_BELOW = ((0x56, 0xA0, 0xD3), (0x2A, 0x72, 0xB5), (0x15, 0x49, 0x8C), (0x0B, 0x27, 0x5C))
_ABOVE = ((0xF0, 0x9C, 0x42), (0xDB, 0x69, 0x17), (0xA8, 0x40, 0x10), (0x66, 0x22, 0x08))
_NEUTRAL = "#222222"
_SOFT = "#5a5a5a"
#: Markers by rank; an hourglass is none of matplotlib's.
_HOURGLASS = ((-1.0, -1.1), (1.0, -1.1), (-1.0, 1.1), (1.0, 1.1), (-1.0, -1.1))
_MARKERS: dict[int, tuple[Any, ...]] = {-1: ("s", "v", _HOURGLASS), 1: ("D", "^", "P")}
#: Without a limit, and this is proved.
_NO_STATE = ("l2-unreachable", "unbounded")


def _shade(count: int, i: int, ramp: tuple[tuple[int, int, int], ...]) -> str:
    """Few curves keep away from the ends, many fill the ramp."""
    margin = 0.3 * max(4 - count, 0)
    at = 1.3 if count == 1 else margin + (3 - 2 * margin) * i / (count - 1)
    low = min(int(at), 2)
    mixed = (round(a + (b - a) * (at - low)) for a, b in zip(ramp[low], ramp[low + 1]))
    return "#" + "".join(f"{part:02x}" for part in mixed)


def look(l2: float, all_l2: list[float]) -> dict[str, Any]:
    """Colour, width and marker of the curve of an l2: black at 0, blue below, orange above, stronger the further away."""
    if l2 == 0:
        return {"color": _NEUTRAL, "linewidth": 2.0, "marker": "o"}
    side = 1 if l2 > 0 else -1
    ranks = sorted({abs(x) for x in all_l2 if x * side > 0})
    rank = ranks.index(abs(l2))
    color = _shade(len(ranks), rank, _ABOVE if side > 0 else _BELOW)
    return {"color": color, "linewidth": 1.5, "marker": _MARKERS[side][rank % 3]}


def turn(direction: NDArray[Any], *columns: NDArray[Any]) -> list[NDArray[Any]]:
    """In order, and all round if the directions are those of half a turn."""
    order = np.argsort(direction, kind="stable")
    out = [direction[order], *(column[order] for column in columns)]
    if direction.size > 1 and out[0][0] == 0 and out[0][-1] == 180:
        opposite = [out[0][1:] + 180, *(column[1:] for column in out[1:])]
        out = [np.concatenate(pair) for pair in zip(out, opposite)]
    return out


def draw(ax: PolarAxes, table: dict[str, NDArray[Any]], shown: str, line: dict[str, Any]) -> None:
    """A curve for each l2 with its bound: filled markers are proved limits, crosses and dashes directions without one."""
    from matplotlib.ticker import MaxNLocator

    base = 1.0 if shown == "stretch" else 0.0
    values = table["lambda1"] - 1 if shown == "lambda1" else table["l1"] + base
    bounds = table["bound_l1"] + base
    if shown == "lambda1":
        bounds = np.maximum(1 + table["bound_l1"], 1 + table["l2"]) ** 2 - 1
    all_l2 = sorted(set(table["l2"].tolist()))
    found = values[np.isfinite(values)]
    least, high = min([base, *found.tolist()]), max([base, *found.tolist()])
    low = base - 1.2 * (base - least)
    high = max(high, low + 0.1)
    top = high + 0.06 * (high - low)
    kinds: set[str] = set()
    bounded = False
    for behind, l2 in enumerate(all_l2):
        chosen = table["l2"] == l2
        degrees, value, bound, status = turn(
            table["direction_deg"][chosen], values[chosen], bounds[chosen], table["status"][chosen]
        )
        angle = np.deg2rad(degrees)
        style = {**look(l2, all_l2), "markersize": 4.5, **line}
        free = bool(np.all(table["lateral"][chosen] == "free"))
        ax.plot(angle, value, **{"label": "width free" if free else f"l2 = {l2:g}", **style})
        open_ = (status != "global") & np.isfinite(value)
        if open_.any():
            ax.plot(angle[open_], value[open_], **{**style, "linestyle": "", "markerfacecolor": "white", "label": "_nolegend_"})
            kinds.add("not proved (local)")
        if np.any(np.isfinite(value) & ~open_):
            kinds.add("proved")
        if np.nanmax(np.where(np.isfinite(value), bound - value, 0.0), initial=0.0) > 1e-6:
            beside = np.where(np.isfinite(value), bound, np.nan)
            ax.plot(angle, beside, linestyle=(0, (5, 4)), linewidth=1.0, color=style["color"], label="_nolegend_")
            bounded = True
        missing = ~np.isfinite(value)
        impossible = np.isin(status, _NO_STATE)
        gaps = ((missing & ~impossible, "x", "no limit found"), (missing & impossible, "_", "no limit (proved)"))
        for part, mark, words in gaps:
            if part.any():
                rim = np.full(part.sum(), top - (0.03 + 0.035 * (behind % 6)) * (top - low))
                ax.plot(angle[part], rim, linestyle="", marker=mark, markersize=5, color=style["color"], label="_nolegend_")
                kinds.add(words)
    # The limits set the scale; a bound further out is cut off.
    ax.set_rlim(low, top)
    ax.set_thetagrids(range(0, 360, 30))
    ticks = MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(low, top)
    ax.set_rticks([tick for tick in ticks if low < tick < top - 0.04 * (top - low)])
    ax.grid(color="#dcdcdc")
    if bounded:
        ax.plot([], [], linestyle=(0, (5, 4)), linewidth=1.0, color=_SOFT, label="proven bound")
    marks = {
        "proved": ("o", _SOFT),
        "not proved (local)": ("o", "white"),
        "no limit found": ("x", _SOFT),
        "no limit (proved)": ("_", _SOFT),
    }
    # Filled markers speak for themselves where there are no others.
    for words, (mark, fill) in marks.items() if kinds != {"proved"} else ():
        if words in kinds:
            ax.plot([], [], linestyle="", marker=mark, color=_SOFT, markerfacecolor=fill, label=words)

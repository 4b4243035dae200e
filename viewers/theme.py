"""Colors and sizes of every picture: a light page, warm paper tiles on a cool target, one ink for lines.

The diverging map (blue, white, red) and the sequential one stay readable with the common color-vision
deficiencies, and their light end never equals the gray of the tiles beside them.
"""

from __future__ import annotations

PAPER = "#ffffff"
INK = "#1f2a37"
MUTED = "#5b6776"
HAIRLINE = "#d5dae1"

TARGET = "#c3d3e2"
TARGET_RIM = "#6f8498"
TILE = "#f6d9a6"
TILE_EDGE = "#3a3226"
GHOST_TILE = "#c6cbd3"
GHOST_EDGE = "#4e5763"
NO_VALUE = "#9aa1ab"

# matplotlib's maps, cut at the ends: the last tenth is nearly black.
DIVERGING = ("RdBu_r", 0.06, 0.94)
SEQUENTIAL = ("YlGnBu", 0.04, 0.92)

# Okabe and Ito's colors, without the yellow that vanishes on white.
SERIES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")

# What axes of every chart have in common, by matplotlib's names.
CHART_STYLE = {
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "legend.frameon": False,
    "text.color": INK,
}

EDGE_WIDTH = 1.6
RIM_WIDTH = 2.0

"""The limit of a sheet in a solver of one's own: strains are kept within what the sheet can do."""

import numpy as np

import maille

surface = maille.boundary("1.1", vertices=162)
wanted = np.array([[0.1, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
possible = surface.contains(wanted)
allowed = surface.project(wanted)
for strain, inside, margin, nearest in zip(wanted, possible, surface.margin(wanted), allowed):
    print(f"{strain}: {'possible' if inside else 'too far'}, margin {margin:+.4f}, nearest {nearest.round(4)}")

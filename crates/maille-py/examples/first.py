"""The limits of a built-in design, and how they change with the wire."""

import matplotlib

matplotlib.use("Agg")

import maille

record = maille.characterize("1.1", directions="0:180:15", l2=[0])
axes = record.plot()
for minor_radius in (0.05, 0.15):
    thinner_or_thicker = maille.Design.builtin("1.1").with_minor_radius(minor_radius)
    other = maille.characterize(thinner_or_thicker, directions="0:180:15", l2=[0])
    other.plot(ax=axes, label=f"r = {minor_radius}")
    print(f"r = {minor_radius}: largest l1 {other.to_numpy()['l1'].max():.4f}")
print(f"r = {record.design.minor_radius}: largest l1 {record.to_numpy()['l1'].max():.4f}")
print(f"{len(axes.lines)} curves")

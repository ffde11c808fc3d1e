// The atlas's page: one point for each design, on axes that the reader chooses; a click shows that design.

import { LineChart, ScatterChart } from "echarts/charts";
import { GridComponent, LegendComponent, PolarComponent, TooltipComponent, DataZoomComponent } from "echarts/components";
import { init, use } from "echarts/core";
import { CanvasRenderer } from "echarts/renderers";

use([ScatterChart, LineChart, GridComponent, PolarComponent, LegendComponent, TooltipComponent, DataZoomComponent]);
use([CanvasRenderer]);

/** What `site/atlas.py` writes: design, minor radius, spacing, l1 by direction, and `g`lobal, `l`ocal or `-` of each. */
type Row = [design: number, minorRadius: number, spacing: number, l1: (number | null)[], proved: string];
interface Atlas {
  directions: number[];
  designs: { name: string; title: string; minor_radius: number; reference_radius: number }[];
  rows: Row[];
}

const { directions, designs, rows } = (window as unknown as { atlas: Atlas }).atlas;
const designOf = (row: Row) => designs[row[0]]!;
const at = (row: Row, direction: number) => row[3][directions.indexOf(direction % 180)] ?? null;
const known = (row: Row) => row[3].filter((l1) => l1 !== null);
/** The direction in which a design stretches least, degrees. */
const stiffest = (row: Row) => directions[row[3].indexOf(Math.min(...known(row)))]!;

const measures: Record<string, (row: Row) => number | null> = {
  "l1 along 0°": (row) => at(row, 0),
  "l1 along 90°": (row) => at(row, 90),
  "l1 along 45°": (row) => at(row, 45),
  "least l1": (row) => Math.min(...known(row)),
  "largest l1": (row) => Math.max(...known(row)),
  "l1 across the stiffest direction": (row) => at(row, stiffest(row) + 90),
  "largest less least l1": (row) => Math.max(...known(row)) - Math.min(...known(row)),
  "stiffest direction, degrees": stiffest,
  "minor radius / R": (row) => row[1] / designOf(row).reference_radius,
  "minor radius / that of the file": (row) => row[1] / designOf(row).minor_radius,
  "spacing / that of the file": (row) => row[2],
};

const root = document.getElementById("atlas-designs")!;
root.replaceChildren();

function choice(label: string, values: string[], value: string): HTMLSelectElement {
  const select = document.createElement("select");
  for (const text of values) select.add(new Option(text, text, false, text === value));
  const named = document.createElement("label");
  named.append(`${label} `, select);
  bar.append(named);
  select.addEventListener("change", show);
  return select;
}

const bar = document.createElement("div");
bar.className = "atlas-bar";
const field = document.createElement("div");
field.className = "atlas-field";
field.setAttribute("role", "img");
const count = document.createElement("p");
const chosen = document.createElement("section");
chosen.setAttribute("aria-live", "polite");
root.append(bar, field, count, chosen);

const names = Object.keys(measures);
const across = choice("Across:", names, "least l1");
const up = choice("Up:", names, "l1 across the stiffest direction");
const weave = choice("Weave:", ["all", ...designs.map((d) => d.name)], "all");
const proof = choice("Limits:", ["all", "all proved"], "all");

const chart = init(field);
function show(): void {
  const x = measures[across.value]!;
  const y = measures[up.value]!;
  const ink = getComputedStyle(document.documentElement).getPropertyValue("--fg").trim();
  let shown = 0;
  const series = designs.map((design, index) => {
    const wanted = (row: Row) =>
      row[0] === index &&
      (weave.value === "all" || weave.value === design.name) &&
      (proof.value === "all" || !/[^g]/.test(row[4]));
    const data = rows.flatMap((row, place) => {
      if (!wanted(row)) return [];
      const [h, v] = [x(row), y(row)];
      return h === null || v === null ? [] : [[h, v, place]];
    });
    shown += data.length;
    return { type: "scatter" as const, name: design.name, data, symbolSize: 5, itemStyle: { opacity: 0.7 } };
  });
  const text = { color: ink || "#222" };
  const axis = (name: string) => ({
    type: "value" as const,
    name,
    scale: true,
    nameLocation: "middle" as const,
    nameGap: 32,
    nameTextStyle: text,
    axisLine: { onZero: false },
    axisLabel: { ...text, formatter: (value: number) => String(Number(value.toPrecision(6))) },
    splitLine: { lineStyle: { opacity: 0.25 } },
  });
  chart.setOption(
    {
      animation: false,
      color: designs.map((_, index) => `hsl(${Math.round(index * 137.5) % 360}, 60%, 45%)`),
      legend: { type: "plain", bottom: 0, itemWidth: 10, itemHeight: 8, textStyle: { ...text, fontSize: 11 } },
      grid: { left: 56, right: 16, top: 12, bottom: 48 + 22 * Math.ceil(designs.length / (field.clientWidth / 130)) },
      xAxis: axis(across.value),
      yAxis: { ...axis(up.value), nameGap: 42 },
      dataZoom: [
        { type: "inside", xAxisIndex: 0 },
        { type: "inside", yAxisIndex: 0 },
      ],
      tooltip: {
        formatter: (point: unknown) => {
          const { data } = point as { data: [number, number, number] };
          const row = rows[data[2]]!;
          return `${designOf(row).name}<br>minor radius ${row[1]}, spacing ${row[2]}<br>${data[0]}, ${data[1]}`;
        },
      },
      series,
    },
    { notMerge: true },
  );
  count.textContent = `${shown} of ${rows.length} designs.`;
  field.setAttribute("aria-label", `${shown} designs: ${up.value} over ${across.value}`);
}

/** One design: its limits in all directions, and how to compute them again. */
function choose(row: Row): void {
  const design = designOf(row);
  const proved = [...row[4]].filter((letter) => letter === "g").length;
  const title = document.createElement("h2");
  title.textContent = `${design.name}, minor radius ${row[1]}, spacing ${row[2]}`;
  const polar = document.createElement("div");
  polar.className = "atlas-polar";
  polar.setAttribute("role", "img");
  polar.setAttribute("aria-label", `Largest stretch of ${design.name} in each direction`);
  const words = document.createElement("p");
  words.textContent =
    `${design.title}. l1 from ${Math.min(...known(row))} along ${stiffest(row)}° to ${Math.max(...known(row))}; ` +
    `${proved} of ${directions.length} limits proved. As a study, for maille sweep:`;
  const study = document.createElement("pre");
  study.textContent =
    `directions = "0:180:15"\nl2 = [0]\ncell = "1x1"\neffort = "low"\n\n` +
    `[[designs]]\ndesign = "${design.name}"\nminor_radius = [${row[1]}]\nspacing = [${row[2]}]\n`;
  const link = document.createElement("a");
  link.href = `../viewer/${design.name}.html`;
  link.textContent = `${design.name} in the viewer`;
  const more = document.createElement("p");
  more.append(link, ", with the wire and spacing of its file.");
  chosen.replaceChildren(title, polar, words, study, more);
  const small = init(polar);
  const points = [...directions.slice(0, -1), ...directions.map((direction) => direction + 180)];
  const text = { color: getComputedStyle(document.documentElement).getPropertyValue("--fg").trim() || "#222" };
  small.setOption({
    animation: false,
    polar: { radius: "80%" },
    angleAxis: { type: "value", min: 0, max: 360, startAngle: 0, clockwise: false, interval: 30, axisLabel: text },
    radiusAxis: { min: (range: { min: number }) => Math.min(0, range.min), axisLabel: text },
    series: [{ type: "line", coordinateSystem: "polar", symbolSize: 5, data: points.map((d) => [at(row, d), d]) }],
  });
}

/** What the address of a design ends with, as `#1.1/0.1/1`. */
const address = (row: Row) => `#${designOf(row).name}/${row[1]}/${row[2]}`;
function follow(): void {
  const row = rows.find((row) => address(row) === decodeURIComponent(location.hash));
  if (row) choose(row);
}
chart.on("click", (point) => {
  const row = rows[(point.data as [number, number, number])[2]];
  if (row) location.hash = address(row);
});
addEventListener("hashchange", follow);
addEventListener("resize", () => chart.resize());
show();
follow();

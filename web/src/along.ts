import { axis, figure, text, tooltip } from './chart';
import type { Frames, Row } from './data';
import { colour } from './theme';

const least = 0.001;

// Errors along the way; `look` is told which frame the pointer is at.
export function along(frames: Frames, rows: Row[], look: (frame: number) => void) {
  const shown = new Set(['fused', 'system', 'pnp', 'retrieval', 'gps']);
  const made = figure(
    'along',
    380,
    (t) => ({
      legend: {
        top: 0,
        textStyle: text(t),
        selected: Object.fromEntries(rows.map((row) => [row.label, shown.has(row.name)])),
      },
      grid: { left: 64, right: 24, top: 64, bottom: 84 },
      tooltip: {
        ...tooltip(t),
        trigger: 'axis',
        valueFormatter: (value) => (value == null ? 'none' : `${Number(value).toFixed(3)} m`),
      },
      dataZoom: [
        { type: 'inside', filterMode: 'none' },
        { type: 'slider', height: 20, bottom: 8, filterMode: 'none', textStyle: text(t) },
      ],
      xAxis: axis(t, 'metres along the route', {
        type: 'value',
        max: Math.ceil(frames.distance_m[frames.distance_m.length - 1]),
        axisLabel: { ...text(t), showMaxLabel: false },
        axisPointer: { snap: true },
        splitLine: { show: false },
      }),
      yAxis: axis(t, 'position error, m', { type: 'log', logBase: 10, nameGap: 44 }),
      series: rows.map((row) => ({
        type: 'line' as const,
        name: row.label,
        color: colour(row.name),
        symbol: frames.frame.length > 600 ? 'none' : 'circle', // symbols take long to draw
        symbolSize: 3,
        lineStyle: { width: 1.2 },
        animation: false,
        data: frames.errors[row.name].map((error, i) => [
          frames.distance_m[i],
          error === null ? null : Math.max(least, error),
        ]) as [number, number][],
      })),
    }),
    'Position error along the route (logarithmic). Names switch rows on and off; the wheel zooms.',
  );
  return {
    element: made.element,
    start: () => {
      const chart = made.start();
      chart.on('updateAxisPointer', (event) => {
        const value = (event as { axesInfo?: { value: number }[] }).axesInfo?.[0]?.value;
        if (value !== undefined) look(nearest(frames.distance_m, value));
      });
      return chart;
    },
  };
}

function nearest(increasing: number[], value: number): number {
  let low = 0;
  let high = increasing.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (increasing[middle] <= value) low = middle;
    else high = middle;
  }
  return value - increasing[low] < increasing[high] - value ? low : high;
}

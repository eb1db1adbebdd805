import { axis, figure, text, tooltip, type Chart } from './chart';
import type { Run } from './data';
import { metres } from './dom';

type Point = [number, number];

// Green below 0.1 m, red from 10 m on.
function errorColour(error: number): string {
  const place = Math.min(1, Math.max(0, (Math.log10(error) + 1) / 2));
  return `hsl(${Math.round(150 * (1 - place))}, 65%, 45%)`;
}

// Axis limits that show all points with as many pixels a metre along both axes.
function limits(points: Point[], width: number, height: number) {
  const [xs, ys] = [0, 1].map((axis) => points.map((p) => p[axis]));
  const span = (values: number[]) => values.reduce((m, v) => [Math.min(m[0], v), Math.max(m[1], v)], [Infinity, -Infinity]);
  const [x, y] = [span(xs), span(ys)];
  const perPixel = 1.06 * Math.max((x[1] - x[0]) / width, (y[1] - y[0]) / height, 1e-3);
  const around = ([low, high]: number[], pixels: number) => ({
    min: (low + high - perPixel * pixels) / 2,
    max: (low + high + perPixel * pixels) / 2,
  });
  return [around(x, width), around(y, height)];
}

const side = { left: 64, right: 16, top: 40, bottom: 52 };

// The route from above; `look` is told the live frame, `lookKey` the key frame under the pointer.
export function plan(run: Run, look: (frame: number) => void, lookKey: (key: number) => void) {
  const { truth, estimate } = run.frames;
  const links = truth.flatMap((point, i) => [point, estimate[i], [NaN, NaN] as Point]);
  const error = (i: number) =>
    Math.hypot(truth[i][0] - estimate[i][0], truth[i][1] - estimate[i][1]);
  const round = (value: number) => String(Math.round(value));
  const made = figure(
    'plan',
    600,
    (t, chart: Chart) => {
      const [x, y] = limits(
        [...truth, ...run.keys.at],
        chart.getWidth() - side.left - side.right,
        chart.getHeight() - side.top - side.bottom,
      );
      const zoom = { type: 'inside' as const, filterMode: 'none' as const };
      const label = { ...text(t), formatter: round, showMinLabel: false, showMaxLabel: false };
      return {
        animation: false,
        legend: { top: 0, textStyle: text(t) },
        grid: side,
        tooltip: { ...tooltip(t), trigger: 'item' },
        dataZoom: [
          { ...zoom, xAxisIndex: 0 },
          { ...zoom, yAxisIndex: 0 },
        ],
        xAxis: axis(t, `${run.axes[0]}, m`, { type: 'value', ...x, axisLabel: label }),
        yAxis: axis(t, `${run.axes[1]}, m`, { type: 'value', ...y, axisLabel: label, nameGap: 48 }),
        series: [
          {
            type: 'line',
            name: 'from truth to estimate',
            data: links,
            symbol: 'none',
            silent: true,
            color: t.faint,
            lineStyle: { width: 0.8, opacity: 0.6 },
          },
          {
            type: 'scatter',
            name: 'live images',
            symbolSize: 8,
            large: true,
            largeThreshold: 1000,
            color: t.text,
            data: truth,
            tooltip: { formatter: (one) => said((one as { dataIndex: number }).dataIndex) },
          },
          {
            type: 'scatter',
            name: 'key frames',
            symbol: 'diamond',
            symbolSize: 8,
            large: true,
            largeThreshold: 1000,
            color: '#e09f3e',
            data: run.keys.at,
            tooltip: {
              formatter: (one) => {
                const key = (one as { dataIndex: number }).dataIndex;
                return `key frame ${key}: ${run.keys.lap[key]}, image ${run.keys.frame[key]}`;
              },
            },
          },
          {
            type: 'scatter',
            name: 'estimates',
            symbolSize: 5,
            color: 'hsl(150, 65%, 45%)',
            data: estimate.map((value, i) => ({
              value,
              itemStyle: { color: errorColour(error(i)) },
            })),
            tooltip: { formatter: (one) => said((one as { dataIndex: number }).dataIndex) },
          },
        ],
      };
    },
    'The route in plan: live images where they were taken, estimates (green: 0.1 m off or less, red: 10 m or more), key frames. The wheel zooms, dragging moves; both axes have one scale.',
  );

  const said = (i: number) =>
    `image ${run.frames.frame[i]}: ${run.frames.state[i]}, ${metres(error(i))} m off in plan`;

  return {
    element: made.element,
    start: () => {
      const chart = made.start();
      chart.on('mouseover', (event) => {
        if (event.seriesName === 'key frames') lookKey(event.dataIndex);
        else if (event.dataIndex !== undefined) look(event.dataIndex);
      });
      return chart;
    },
  };
}

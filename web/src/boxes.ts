import { axis, figure, tooltip } from './chart';
import type { Row } from './data';
import { metres } from './dom';
import { colour } from './theme';

const least = 0.001; // a logarithm needs something

// Best row at the top.
export const boxes = (rows: Row[]) =>
  figure(
    'boxes',
    90 + 44 * rows.length,
    (t) => {
      const upwards = [...rows].reverse();
      return {
        grid: { left: 190, right: 32, top: 8, bottom: 48 },
        tooltip: {
          ...tooltip(t),
          trigger: 'item',
          formatter: (one) => {
            const row = upwards[(one as { dataIndex: number }).dataIndex];
            const { low, q1, median, q3, high } = row.box;
            return [
              `<b>${row.label}</b>, ${row.frames} images`,
              `median ${metres(median)} m`,
              `quartiles ${metres(q1)} and ${metres(q3)} m`,
              `whiskers ${metres(low)} and ${metres(high)} m`,
              `mean ${metres(row.mean.value)} m`,
            ].join('<br>');
          },
        },
        xAxis: axis(t, 'position error, m (logarithmic)', { type: 'log', logBase: 10 }),
        yAxis: axis(t, '', {
          type: 'category',
          data: upwards.map((row) => row.label),
          splitLine: { show: false },
        }),
        series: [
          {
            type: 'boxplot',
            boxWidth: [12, 24],
            data: upwards.map((row) => ({
              value: [row.box.low, row.box.q1, row.box.median, row.box.q3, row.box.high].map((v) =>
                Math.max(least, v),
              ),
              itemStyle: { color: colour(row.name) + '55', borderColor: colour(row.name) },
            })),
          },
          {
            type: 'scatter',
            name: 'mean',
            symbol: 'diamond',
            symbolSize: 9,
            data: upwards.map((row, place) => ({
              value: [Math.max(least, row.mean.value), place],
              itemStyle: { color: colour(row.name) },
            })),
          },
        ],
      };
    },
    'Position error: median, quartiles, and whiskers to the last image within 1.5 interquartile ranges; diamonds are means.',
  );

import { axis, figure, text, tooltip } from './chart';
import type { CurvePoint } from './data';

// Loss on its own axis, position errors of training and validation pairs on the other.
export const training = (curve: CurvePoint[], noMotion: number) =>
  figure(
    'training',
    320,
    (t) => {
      const line = (name: string, colour: string, data: (number | null)[][], more: object = {}) => ({
        type: 'line' as const,
        name,
        color: colour,
        symbolSize: 6,
        data,
        ...more,
      });
      const first = curve[0]?.step ?? 0;
      const last = curve[curve.length - 1]?.step ?? 0;
      return {
        legend: { top: 0, textStyle: text(t) },
        grid: { left: 56, right: 64, top: 40, bottom: 48 },
        tooltip: {
          ...tooltip(t),
          trigger: 'axis',
          valueFormatter: (value) => Number(value).toFixed(3),
        },
        xAxis: axis(t, 'iterations', { type: 'value', min: first, max: last }),
        yAxis: [
          axis(t, 'position error, m', { type: 'value', min: 0, nameGap: 40 }),
          axis(t, 'loss', { type: 'value', min: 0, nameGap: 40, splitLine: { show: false } }),
        ],
        series: [
          line(
            'training pairs, m',
            '#2a9d6f',
            curve
              .filter((p) => p.train_position_m != null)
              .map((p) => [p.step, p.train_position_m as number]),
          ),
          line(
            'validation pairs, m',
            '#1f77b4',
            curve.map((p) => [p.step, p.valid_position_m]),
          ),
          line(
            '“no motion” on the validation pairs, m',
            '#8b8f98',
            [
              [first, noMotion],
              [last, noMotion],
            ],
            { symbol: 'none', lineStyle: { type: 'dotted' } },
          ),
          line(
            'loss',
            '#e09f3e',
            curve.map((p) => [p.step, p.loss]),
            { yAxisIndex: 1, lineStyle: { type: 'dashed' } },
          ),
        ].filter((series) => series.data.length > 0),
      };
    },
    'Training: loss, and mean position error of training and validation pairs, against iterations.',
  );

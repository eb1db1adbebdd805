import { axis, figure, text, tooltip } from './chart';
import type { Accuracy } from './data';

const looks: [keyof Pick<Accuracy, 'within_labels' | 'within_frames'>, string, string][] = [
  ['within_labels', 'mapped places', 'solid'],
  ['within_frames', 'live images', 'dashed'],
];
const colours = ['#e09f3e', '#1f77b4', '#2a9d6f'];

// Share of images whose place is right within a Maximum Allowed Error, in both readings.
export const accuracy = (systems: Accuracy[]) =>
  figure(
    'accuracy',
    340,
    (t) => ({
      legend: { top: 0, textStyle: text(t) },
      grid: { left: 56, right: 24, top: 56, bottom: 48 },
      tooltip: {
        ...tooltip(t),
        trigger: 'axis',
        valueFormatter: (value) => `${Number(value).toFixed(1)} %`,
      },
      xAxis: axis(t, 'Maximum Allowed Error', { type: 'value', minInterval: 1 }),
      yAxis: axis(t, 'images, %', { type: 'value', min: 0, max: 100, nameGap: 40 }),
      series: systems.flatMap((system, number) =>
        looks.map(([key, reading, type]) => ({
          type: 'line' as const,
          name: `${system.name}, ${reading}`,
          symbolSize: 7,
          symbol: type === 'solid' ? 'circle' : 'emptyCircle',
          lineStyle: { type: type as 'solid' | 'dashed', width: 2 },
          color: colours[number % colours.length],
          data: system[key].map((one) => [one.allowed, 100 * one.value]),
        })),
      ),
    }),
    'Place recognition against the Maximum Allowed Error, counted in mapped places (solid) and in live images (dashed).',
  );

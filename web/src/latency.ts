import { axis, figure, text, tooltip } from './chart';

export const latency = (steps: Record<string, { p50: number; p99: number }>) => {
  const names = Object.keys(steps).sort((a, b) => steps[a].p50 - steps[b].p50);
  return figure(
    'latency',
    80 + 34 * names.length,
    (t) => ({
      legend: { top: 0, textStyle: text(t) },
      grid: { left: 90, right: 32, top: 32, bottom: 48 },
      tooltip: {
        ...tooltip(t),
        trigger: 'axis',
        valueFormatter: (value) => `${Number(value).toFixed(1)} ms`,
      },
      xAxis: axis(t, 'milliseconds an image', { type: 'value' }),
      yAxis: axis(t, '', { type: 'category', data: names, splitLine: { show: false } }),
      series: (['p50', 'p99'] as const).map((which, number) => ({
        type: 'bar' as const,
        name: which === 'p50' ? 'median' : '99 % stay below',
        color: number === 0 ? '#1f77b4' : '#9fc5e8',
        data: names.map((name) => steps[name][which]),
      })),
    }),
    'Time spent on one image, on the machine and under the load of this run.',
  );
};

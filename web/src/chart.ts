import { BoxplotChart, CustomChart, LineChart, ScatterChart, BarChart } from 'echarts/charts';
import {
  DataZoomComponent,
  GridComponent,
  LegendComponent,
  TooltipComponent,
} from 'echarts/components';
import * as echarts from 'echarts/core';
import type { EChartsOption } from 'echarts';
import { CanvasRenderer } from 'echarts/renderers';
import { el } from './dom';
import { dark, print, theme, type Theme } from './theme';

echarts.use([
  BarChart,
  BoxplotChart,
  CanvasRenderer,
  CustomChart,
  DataZoomComponent,
  GridComponent,
  LegendComponent,
  LineChart,
  ScatterChart,
  TooltipComponent,
]);

export type Chart = echarts.ECharts;
export type Options = (theme: Theme, chart: Chart) => EChartsOption;

const drawn: { chart: Chart; options: Options }[] = [];

function draw() {
  for (const { chart, options } of drawn) {
    chart.resize();
    chart.setOption(options(theme(), chart));
  }
}

// A figure with its caption. `options` is asked again when light turns to dark, on paper (always
// light) and when the window's size changes.
export function figure(name: string, height: number, options: Options, caption: string) {
  const box = el('div', { class: 'chart', id: `chart-${name}`, style: `height:${height}px` });
  const element = el('figure', {}, box, el('figcaption', {}, caption));
  const start = (): Chart => {
    const chart = echarts.init(box);
    drawn.push({ chart, options });
    chart.setOption(options(theme(), chart));
    return chart;
  };
  return { element, start };
}

let width = window.innerWidth;
window.addEventListener('resize', () => {
  if (width !== window.innerWidth) draw();
  width = window.innerWidth;
});
for (const query of [dark, print]) query.addEventListener('change', draw);

export const text = (t: Theme) => ({ color: t.text, fontSize: 12 });

export const axis = (t: Theme, name: string, more: object = {}) => ({
  name,
  nameLocation: 'middle' as const,
  nameGap: 32,
  nameTextStyle: text(t),
  axisLabel: text(t),
  axisLine: { show: true, onZero: false, lineStyle: { color: t.faint } },
  splitLine: { lineStyle: { color: t.line } },
  ...more,
});

export const tooltip = (t: Theme) => ({
  backgroundColor: t.paper,
  borderColor: t.line,
  textStyle: text(t),
  confine: true,
});

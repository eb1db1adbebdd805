import type { Estimate, Row, Run } from './data';
import { count, el, metres, percent, table } from './dom';

const interval = (e: Estimate) => `${metres(e.value)} [${metres(e.low)}, ${metres(e.high)}]`;
const signed = (e: Estimate) =>
  `${e.value > 0 ? '+' : ''}${e.value.toFixed(3)} [${e.low.toFixed(3)}, ${e.high.toFixed(3)}]`;

export function dataset(run: Run) {
  const { laps, published } = run.dataset;
  const shown = [
    table(
      `Laps (${run.images} images)`,
      ['lap', 'part', 'images', 'at 1 m', 'at 5 m', 'length, m'],
      laps.map((lap) => [
        lap.name,
        lap.role,
        count(lap.frames),
        count(lap.at_1m),
        count(lap.at_5m),
        count(Math.round(lap.length_m)),
      ]),
      2,
    ),
  ];
  if (published) {
    const { gps, registration, pairs, baselines } = published;
    shown.push(
      table(
        'The paper’s data, from its published poses (real)',
        ['', 'figure'],
        [
          ['places', `${registration.classes}, ${count(registration.train)} training and ${count(registration.test)} test images`],
          ['pairs', `${count(pairs.train)} training, ${count(pairs.valid)} validation, ${count(pairs.test)} test`],
          ['RTK-GPS', `mean ${metres(gps.mean_m)} m, median ${metres(gps.median_m)} m, on ${(100 * gps.available).toFixed(2)} % of the images`],
          ['nearest key frame', `mean ${metres(baselines.nearest_all_mean_m)} m; of lap 01 alone ${metres(baselines.nearest_one_lap_mean_m)} m`],
          ['“no motion” over the test pairs', `mean ${metres(baselines.no_motion_mean_m)} m`],
        ],
      ),
    );
  }
  return el('div', {}, ...shown);
}

const head = ['', 'mean', 'median', 'p75', 'p95', 'max', 'heading, deg', 'images, %'];

const line = (row: Row) => [
  row.label,
  interval(row.mean),
  interval(row.median),
  metres(row.p75),
  interval(row.p95),
  metres(row.max),
  row.heading_deg ? `${row.heading_deg.median.toFixed(2)} (p95 ${row.heading_deg.p95.toFixed(2)})` : '',
  percent(row.availability),
];

export const errors = (run: Run) =>
  el(
    'div',
    {},
    table(`Position error in metres, ${run.images} images, with 95 % intervals`, head, run.rows.map(line)),
    table(
      `The same where the recollected key frame lies within ${run.good_retrieval.within_m} m of the truth: ${percent(run.good_retrieval.share)} % of the ${run.images} images`,
      head,
      run.good_retrieval.rows.map(line),
    ),
  );

export const paired = (run: Run) =>
  table(
    `Paired differences of the position error on the same ${run.images} images, metres; negative: the first is better`,
    ['first', 'second', 'images', 'mean difference'],
    run.paired.map((pair) => {
      const label = (name: string) => run.rows.find((row) => row.name === name)?.label ?? name;
      return [label(pair.a), label(pair.b), count(pair.frames), signed(pair.difference)];
    }),
    2,
  );

export function places(run: Run) {
  const { systems } = run.places;
  const allowed = [0, 1, 2, 3, 5, 10];
  const rows = systems.flatMap((system) =>
    (['within_labels', 'within_frames'] as const).map((key) => [
      `${system.name}: ${key === 'within_labels' ? 'places' : 'live images'}`,
      ...system[key].filter((one) => allowed.includes(one.allowed)).map((one) => `${percent(one.value)} [${percent(one.low)}, ${percent(one.high)}]`),
    ]),
  );
  return table(
    `Share of the ${run.images} images whose place is right, %, with 95 % intervals`,
    ['Maximum Allowed Error', ...allowed.map(String)],
    rows,
  );
}

export function trust(run: Run) {
  if (!run.states || !run.trust) return el('div');
  const said: [string, string][] = [
    ['all_within_half_m', 'all images within 0.5 m, %'],
    ['localised_within_half_m', 'localised answers within 0.5 m, %'],
    ['ellipsoid_pose', 'localised poses in their 95 % ellipsoid, %'],
    ['ellipsoid_position', 'localised positions in their 95 % ellipsoid, %'],
    ['place_before', 'key frame within 5 m, recollected, %'],
    ['place_after', 'key frame within 5 m, verified, %'],
  ];
  const { states, trust } = run;
  return table(
    `What the answers’ own word is worth (${run.images} images)`,
    ['', 'figure'],
    [
      ...Object.entries(states).map(([state, share]) => [`answers ${state}, %`, percent(share)]),
      ...said.map(([key, label]) => [label, percent(trust[key])]),
      ['worst localised answer, m', metres(trust.localised_max_m)],
    ],
  );
}

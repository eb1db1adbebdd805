import './style.css';
import { accuracy } from './accuracy';
import { along } from './along';
import { boxes } from './boxes';
import { loadRun, type Run } from './data';
import { count, el, metres, section } from './dom';
import { Inspector } from './inspector';
import { latency } from './latency';
import { plan } from './plan';
import * as tables from './tables';
import { training } from './training';

function header(run: Run) {
  const { stamp } = run;
  const facts: [string, string][] = [
    ['images', run.images],
    ['command', stamp.command],
    ['seed', String(stamp.seed)],
    ['versions', Object.entries(stamp.versions).map(([name, v]) => `${name} ${v}`).join(', ')],
    ['data', stamp.data_hash],
  ];
  return el(
    'header',
    {},
    el('h1', {}, run.title),
    el('p', { class: `kind ${run.images}` }, run.images === 'rendered' ? 'Rendered images, not photographs.' : 'Real images.'),
    el('dl', { class: 'facts' }, ...facts.flatMap(([name, value]) => [el('dt', {}, name), el('dd', {}, value)])),
    ...run.notes.map((note) => el('p', {}, note)),
  );
}

function show(run: Run) {
  const inspector = new Inspector(run);
  const charts = {
    accuracy: accuracy(run.places.systems),
    training: run.training?.curve.length ? training(run.training.curve, run.training.no_motion_mean_m) : null,
    boxes: boxes(run.rows),
    along: along(run.frames, run.rows, inspector.look),
    plan: plan(run, inspector.look, inspector.lookKey),
    latency: latency(run.latency_ms),
  };
  const { segments, dataset, places } = run;
  const main = document.getElementById('report') as HTMLElement;
  main.append(
    header(run),
    section(
      'errors',
      'Position error',
      `Every row is over the same ${count(run.frames.frame.length)} live images, or those of them that it has an answer for. Intervals: 95 %, bootstrap over ${segments.count} route segments of ${segments.metres} m, ${count(segments.resamples)} resamples; single images are never resampled.`,
      charts.boxes.element,
      tables.errors(run),
      tables.paired(run),
      tables.trust(run),
    ),
    section(
      'route',
      'Along the route',
      `Each point is one of the ${run.images} images: point at it to see it beside the key frame that the committee recollected.`,
      el('div', { class: 'beside' }, charts.plan.element, inspector.element),
      charts.along.element,
    ),
    section(
      'places',
      'Place recognition',
      `${count(places.count)} places, one every ${places.spacing_m} m of ${run.images} laps; weightless network “${dataset.recogniser}”.`,
      charts.accuracy.element,
      tables.places(run),
    ),
    section('training', 'Relative pose: training', trained(run), ...(charts.training ? [charts.training.element] : [])),
    section('data', 'Data', `The map holds ${count(dataset.key_frames)} key frames, one every ${dataset.spacing_m} m of each mapped lap.`, tables.dataset(run)),
    section('latency', 'Latency', `As measured in this run, on ${run.images} images.`, charts.latency.element),
  );
  const started = Object.entries(charts).flatMap(([name, chart]) => (chart ? [[name, chart.start()]] : []));
  // For tests: the charts by name, and how long the page took.
  Object.assign(window, { recollect: { charts: Object.fromEntries(started), ready: performance.now() } });
}

function trained(run: Run): string {
  const t = run.training;
  if (!t) return 'No network took part.';
  const where = t.trained_here ? 'trained by this run' : 'trained before this run';
  return `Network “${t.network}”, ${count(t.parameters)} parameters, ${where} on ${t.laps.join(', ')}: best after ${count(t.steps)} iterations, ${count(Math.round(t.seconds))} s. Validated on ${t.validated_on}: ${metres(t.validation_mean_m)} m, “no motion” ${metres(t.no_motion_mean_m)} m.${t.curve.length ? '' : ' Its training curve was not given.'}`;
}

const run = loadRun();
if (run) show(run);
else document.getElementById('report')?.append(el('p', {}, 'This is the empty report: recollect experiment paper fills it.'));

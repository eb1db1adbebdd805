// Opens a report from disk in Debian's chromium and looks at it as a reader would:
//   node browser.mjs REPORT [SCREENSHOTS]
// Exits 1 with what is wrong. Screenshots go into that folder as PNG files.
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const [report, screenshots] = process.argv.slice(2);
const problems = [];
const check = (right, what) => right || problems.push(what);

const browser = await chromium.launch({
  executablePath: '/usr/bin/chromium',
  args: ['--no-sandbox', '--disable-gpu'],
});
try {
  const context = await browser.newContext({
    viewport: { width: 1280, height: 900 },
    colorScheme: 'light',
    offline: true,
  });
  const page = await context.newPage();
  page.on('pageerror', (error) => problems.push(`error: ${error.message}`));
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') {
      problems.push(`console: ${message.text()}`);
    }
  });
  page.on('request', (request) => {
    if (!/^(file|data):/.test(request.url())) problems.push(`asks for ${request.url()}`);
  });

  const before = Date.now();
  await page.goto(pathToFileURL(report).href);
  await page.waitForFunction(() => window.recollect?.ready);
  const ready = await page.evaluate(() => window.recollect.ready);
  console.log(`opened in ${Math.round(ready)} ms, ${Date.now() - before} ms with the browser`);

  const charts = await page.evaluate(() =>
    Object.entries(window.recollect.charts).map(([name, chart]) => [
      name,
      chart.getOption().series.map((series) => series.data.length),
    ]),
  );
  for (const name of ['accuracy', 'boxes', 'along', 'plan', 'latency']) {
    check(charts.some(([other]) => other === name), `chart ${name} is missing`);
  }
  for (const [name, series] of charts) {
    check(series.length > 0 && series.every((count) => count > 0), `${name} lacks data: ${series}`);
  }
  console.log(charts.map(([name, series]) => `${name}: ${series.join(' + ')} points`).join('\n'));

  // Both axes of the plan have one scale.
  const scale = await page.evaluate(() => {
    const at = (x, y) => window.recollect.charts.plan.convertToPixel({ gridIndex: 0 }, [x, y]);
    const [origin, right, up] = [at(0, 0), at(1, 0), at(0, 1)];
    return [right[0] - origin[0], origin[1] - up[1]];
  });
  check(Math.abs(scale[0] / scale[1] - 1) < 0.02, `the plan is stretched: ${scale} pixels a metre`);

  // Pointing at a live image shows it and its key frame.
  await page.locator('#chart-plan').scrollIntoViewIfNeeded();
  const box = await page.locator('#chart-plan').boundingBox();
  const point = await page.evaluate(() => {
    const chart = window.recollect.charts.plan;
    const live = chart.getOption().series.find((series) => series.name === 'live images').data;
    return chart.convertToPixel({ gridIndex: 0 }, live[Math.floor(live.length / 2)]);
  });
  await page.mouse.move(box.x + point[0] - 12, box.y + point[1] - 12);
  await page.mouse.move(box.x + point[0], box.y + point[1], { steps: 4 });
  await page.waitForTimeout(300);
  const seen = await page.evaluate(() => ({
    widths: [...document.querySelectorAll('#inspector img')].map((image) => image.naturalWidth),
    text: document.querySelector('#inspector').textContent,
  }));
  check(seen.widths.length >= 2 && seen.widths.every((w) => w > 30), `images shown: ${seen.widths}`);
  check(/votes/.test(seen.text) && /recollected/.test(seen.text), `inspector says: ${seen.text}`);
  const kind = await page.locator('.kind').textContent();
  check(/rendered|real/i.test(kind), `rendered or real is not said: ${kind}`);

  if (screenshots) {
    await page.screenshot({ path: `${screenshots}/whole.png`, fullPage: true });
    for (const name of ['errors', 'route', 'places', 'training']) {
      await page.locator(`#${name}`).screenshot({ path: `${screenshots}/${name}.png` });
    }
  }
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.waitForTimeout(200);
  const paper = await page.evaluate(() => getComputedStyle(document.querySelector('section')).backgroundColor);
  check(paper !== 'rgb(255, 255, 255)', `dark is not dark: ${paper}`);
  if (screenshots) await page.screenshot({ path: `${screenshots}/dark.png`, fullPage: true });
  // Paper is light, whatever the screen is.
  await page.emulateMedia({ colorScheme: 'dark', media: 'print' });
  await page.waitForTimeout(200);
  const ink = await page.evaluate(
    () => window.recollect.charts.boxes.getOption().xAxis[0].axisLabel.color,
  );
  check(ink === '#1f2933', `charts are printed in ${ink}`);
  const pdf = await page.pdf({ format: 'A4' });
  check(pdf.length > 20000, 'prints nothing');
  if (screenshots) (await import('node:fs')).writeFileSync(`${screenshots}/print.pdf`, pdf);
} finally {
  await browser.close();
}
if (problems.length > 0) {
  console.error(problems.join('\n'));
  process.exit(1);
}

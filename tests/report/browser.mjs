// browser.mjs BROWSER PAGE PROFILE [PICTURES]: the page of evo-report as a user meets
// it, in a real browser (with its profile in that folder) driven over the DevTools
// protocol. Says what fails; status 1 then. With a folder for PICTURES, the page is
// left there as it looks on a desk, on a phone, in the dark and printed.
import { writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { accessFaults, launch } from '../browser/driver.mjs';

const [program, file, profile, pictures] = process.argv.slice(2);
const browser = await launch(program, profile);
const { call, evaluate, emulate, place, click, press, complaints, requests } = browser;

// ---- what a user does -----------------------------------------------------------------

const painted = 'new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))';

const open = async (width, height, scheme, calm = true) => {
  await emulate({ width, height, scheme, calm });
  await browser.open(pathToFileURL(file).href);
  await evaluate(painted);
};

const keep = (name, data) => pictures && writeFileSync(`${pictures}/${name}`, Buffer.from(data, 'base64'));
const photograph = async (name) => pictures && browser.picture(`${pictures}/${name}`);

const mouse = (type, x, y, buttons = 0) => call('Input.dispatchMouseEvent',
  { type, x, y, button: type === 'mouseMoved' ? 'none' : 'left', buttons, clickCount: type === 'mouseMoved' ? 0 : 1 });
const text = (selector) => evaluate(`document.querySelector(${JSON.stringify(selector)}).textContent`);

let failed = 0;
const check = (what, good, found = '') => {
  console.log(`${good ? 'ok' : 'NOT OK'}: ${what}${good ? '' : `; found ${JSON.stringify(found)}`}`);
  failed += good ? 0 : 1;
};

// ---- the checks --------------------------------------------------------------------------

const checkCharts = async () => {
  const blank = await evaluate(`[...document.querySelectorAll('[data-chart]')].filter((holder) => holder.offsetWidth > 0 &&
    !holder.querySelector('svg :is(path, circle, rect)')).map((holder) => holder.dataset.chart)`);
  const all = await evaluate(`document.querySelectorAll('[data-chart]').length`);
  check(`all ${all} charts are drawn`, all >= 8 && blank.length === 0, blank);
  // Ticks stand under their grid lines.
  const off = await evaluate(`[...document.querySelectorAll('.plot svg')].flatMap((svg) => {
    const lines = [...svg.querySelectorAll('line')].map((line) => Number(line.getAttribute('x1')));
    return [...svg.querySelectorAll('.tick-x')].map((tick) => Math.min(...lines.map((x) => Math.abs(x - Number(tick.getAttribute('x'))))));
  }).filter((distance) => distance > 0.5)`);
  check('every tick stands where its value is', off.length === 0, off);
};

// A robot that is far off does not flatten the others, and is there for the asking.
const checkOutliers = async () => {
  await open(1280, 1000, 'light');
  const found = await evaluate(`(() => {
    const rows = [...Array(24).keys()].map((k) => [k, k === 7 ? [-40, -40, -40] : [k % 5, k % 5, k % 5]]);
    const chart = { x: 'robots trained', y: 'fitness', whole: true, labels: ['robots trained', 'each robot'], series: [{ kind: 'points' }], rows };
    const holder = document.createElement('div');
    holder.className = 'chart';
    document.querySelector('main').prepend(holder);
    Charts.draw(holder, chart, () => {}, 'test');
    const lowest = () => Math.min(...[...holder.querySelectorAll('.tick-y')].map((it) => Number(it.textContent)));
    const before = lowest(), said = holder.querySelector('.readout').textContent;
    holder.querySelector('.outliers').click();
    const after = lowest();
    holder.remove();
    return { before, said, after };
  })()`);
  check('an outlier does not flatten a chart', found.before >= 0 && found.said.startsWith('1 point below what is shown'), found);
  check('and is shown when asked for', found.after <= -40, found);
};

// Which voxels matter: five maps, one scale, and how many robots.
const checkMaps = async () => {
  const maps = await evaluate(`(() => {
    const page = JSON.parse(document.getElementById('data').textContent);
    const maps = Object.values(page.charts).filter((chart) => chart.counts);
    return { widest: maps.map((chart) => chart.widest), scales: document.querySelectorAll('.scale .gradient').length,
      robots: maps.reduce((sum, chart) => sum + chart.counts[0][0], 0), numbers: document.querySelectorAll('.five svg text[font-size="9"]').length,
      all: page.charts['chart-1'].rows.filter((row) => row[2][1] !== null).length };
  })()`);
  check('the maps of voxels have one scale', maps.widest.length === 5 && new Set(maps.widest).size === 1 && maps.scales === 1, maps);
  check('and say of how many robots', maps.robots === maps.all && maps.numbers > 10, maps);
};

// The evolution sheet, the champion's ancestors, and its film.
const checkParts = async () => {
  const missing = await evaluate(`['.verdict', '.generation', '.step', '.film', '[data-cast] canvas'].filter((s) => !document.querySelector(s))`);
  check('verdict, generations, lineage and champion are there', missing.length === 0, missing);
};

// Who opens the page sees the champion move, unless they want less motion.
const checkMotion = async () => {
  await open(1280, 1000, 'light', false);
  await evaluate(settled);
  const moved = await text('[data-cast] .moment');
  check('the champion moves at once', /^step [1-9]/.test(moved), moved);
  await open(1280, 1000, 'light');
  const levels = await evaluate(`[...document.querySelectorAll('main :is(h1, h2, h3, h4)')].map((it) => Number(it.tagName[1]))`);
  check('headings go down by one', levels[0] === 2 && levels.every((level, k) => k === 0 || level <= levels[k - 1] + 1), levels);
};

// The champion's ancestors, each on a stage of its own, with one clock.
const checkLineage = async () => {
  await open(1280, 1000, 'light', false);
  const clock = `document.querySelector('.line + .replay .moment')?.textContent ?? ''`;
  await evaluate(`document.querySelector('.line').scrollIntoView()`);
  await evaluate(settled);
  await evaluate(settled);
  check('ancestors move when they come into view', /^step [1-9]/.test(await evaluate(clock)), await evaluate(clock));
  const stages = await evaluate(`[...document.querySelectorAll('.line canvas')].length`);
  const few = [];
  for (let k = 1; k <= stages; ++k) if (await colors(`.line > li:nth-child(${k}) canvas`) < 8) few.push(k);
  check('each on its own stage', stages >= 1 && few.length === 0, [stages, few]);
  await open(1280, 1000, 'light');
  // Changed voxels are marked: the mark's colour is on every stage but the first.
  const marked = await evaluate(`(async () => {
    document.querySelector('.line').scrollIntoView();
    await new Promise((done) => setTimeout(done, 500));
    return [...document.querySelectorAll('.line canvas')].map((canvas) => {
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      for (let k = 0; k < data.length; k += 4) if (data[k] === 0xc2 && data[k + 1] === 0x25 && data[k + 2] === 0x5c) return true;
      return false;
    });
  })()`);
  check('what changed since the parent is marked', marked[0] === false && marked.slice(1).every(Boolean), marked);
};

// How many colours the middle of a canvas shows.
const colors = (selector) => evaluate(`(() => {
  const canvas = document.querySelector(${JSON.stringify(selector)});
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
  const seen = new Set();
  for (let k = 0; k < data.length; k += 4) seen.add(data[k] << 16 | data[k + 1] << 8 | data[k + 2]);
  return seen.size;
})()`);
const settled = 'new Promise((done) => setTimeout(done, 400))';

const checkReplay = async (within) => {
  const moment = () => text(`${within} .moment`);
  await evaluate(settled);
  check('a replay is drawn', await colors(`${within} canvas`) > 8, await colors(`${within} canvas`));
  check('it begins at the start', (await moment()).startsWith('step 0'), await moment());
  await click(`${within} .play`);
  await evaluate(settled);
  await click(`${within} .play`);
  const played = await moment();
  check('it plays, and says step and return', /^step [1-9]\d* . return -?\d/.test(played), played);
  await evaluate(settled);
  check('it pauses', (await moment()) === played, await moment());
  await evaluate(`(() => { const s = document.querySelector('${within} input'); s.value = s.max; s.dispatchEvent(new Event('input')); })()`);
  check('it can be scrubbed to its end, and says why it ended', /^step \d+ .* . (time is up|goal|failed|end|over)/.test(await moment()), await moment());
};

// A click on a robot anywhere opens its card.
const checkCard = async () => {
  await click('.sheet a.best');
  await evaluate(settled);
  check('a click on a robot opens its card', await evaluate(`document.querySelector('dialog').open`));
  const parts = await evaluate(`['.portrait use', '.facts dd', '.replay canvas', '.chart svg', '.command code'].filter((s) => !document.querySelector('dialog ' + s))`);
  check('with body, facts, replay, curves and commands', parts.length === 0, parts);
  await checkReplay('dialog');
  await photograph('card.png');
  // A robot that has a parent is shown beside it, with one scrubber.
  const child = await evaluate(`(() => { const page = JSON.parse(document.getElementById('data').textContent).runs['run-1'].robots;
    return Object.keys(page).find((id) => page[id].replay && page[id].parents.some((parent) => page[parent]?.replay)) ?? null; })()`);
  if (child) {
    await evaluate(`document.querySelector('a[href="#run-1-${child}"]').click()`);
    await evaluate(settled);
    await click('dialog .beside');
    await evaluate(settled);
    check('a robot moves beside its parent', await evaluate(`document.querySelectorAll('dialog figure canvas').length === 2 && document.querySelectorAll('dialog input[type=range]').length === 1`));
    await evaluate(`(() => { const s = document.querySelector('dialog input'); s.value = s.max; s.dispatchEvent(new Event('input')); })()`);
    const ends = await evaluate(`[...document.querySelectorAll('dialog figcaption output')].map((it) => it.textContent)`);
    check('both go to their end', ends.length === 2 && ends.every((it) => /^return -?\d.* . \w/.test(it)), ends);
    await photograph('beside.png');
  } else check('a robot has a parent to stand beside', false);
  const address = await evaluate('location.hash');
  check('the address is the robot', /^#run-1-[0-9a-f]{12}$/.test(address), address);
  await press('Escape');
  await evaluate(painted);
  check('Escape closes it', !(await evaluate(`document.querySelector('dialog').open`)));
  check('and the address with it', (await evaluate('location.hash')) === '', await evaluate('location.hash'));
  await click('table.robots tbody tr:nth-child(2) td:nth-child(2)');
  await evaluate(painted);
  check('a click anywhere in a row opens its robot', await evaluate(`document.querySelector('dialog').open &&
    location.hash.slice(1) === document.querySelector('table.robots tbody tr:nth-child(2)').id`), await evaluate('location.hash'));
  await press('Escape');
  await evaluate(painted);
};

// Text against what is behind it, names of what can be pressed, and the tab key.
const checkAccess = async (theme) => {
  const { pale, nameless, twice } = await accessFaults(evaluate);
  check(`text can be read (4.5 to 1), ${theme}`, pale.length === 0, pale);
  check('what can be pressed or seen has a name', nameless.length === 0, nameless);
  check('no id is there twice', twice.length === 0, twice);
};

const checkKeyboard = async () => {
  await evaluate(`document.querySelector('.chart .plot').focus()`);
  await press('ArrowRight');
  const said = await text('.chart .readout');
  check('arrow keys read a chart', /robots trained \d/.test(said), said);
  await evaluate(`document.querySelector('.controls .play').focus()`);
  await press('Tab');
  const next = await evaluate(`document.activeElement.getAttribute('aria-label')`);
  check('the tab key goes on', next === 'Moment', next);
};

const checkHovering = async () => {
  const curve = await place('.chart .plot');
  await mouse('mouseMoved', curve.left + curve.width / 2, curve.top + curve.height / 2);
  const said = await text('.chart .readout');
  check('hovering over a curve says its values', /robots trained \d+.*best so far \d/.test(said), said);
  const scatter = await place('.chart.small .plot');
  await mouse('mouseMoved', scatter.left + scatter.width / 2, scatter.top + scatter.height / 2);
  const robot = await evaluate(`document.querySelector('.chart.small .readout use')?.getAttribute('href')`);
  check('hovering over a point shows its robot', /^#b-[0-9a-f]{12}$/.test(robot ?? ''), robot);
};

// What the buttons would save.
const checkSaving = async () => {
  const saved = await evaluate(`(async () => {
    const kept = [];
    const real = URL.createObjectURL;
    URL.createObjectURL = (blob) => { kept.push(blob); return '#'; };
    HTMLAnchorElement.prototype.click = function () { kept.push(this.download); };
    for (const button of document.querySelectorAll('.chart .tools button')) if (['SVG', 'CSV'].includes(button.textContent)) button.click();
    URL.createObjectURL = real;
    return Promise.all(kept.slice(0, 4).map((it) => typeof it === 'string' ? it : it.text()));
  })()`);
  check('a chart can be saved as SVG and as CSV', saved[0]?.startsWith('<svg') && saved[1]?.endsWith('.svg') &&
    saved[2]?.startsWith('"robots trained"') && saved[3]?.endsWith('.csv'), saved.map((it) => it?.slice(0, 60)));
};

const checkZooming = async () => {
  const axis = `[...document.querySelector('.chart').querySelectorAll('.tick-x')].map((l) => l.textContent).join()`;
  const before = await evaluate(axis);
  const { left, top, width, height } = await place('.chart .plot');
  await mouse('mouseMoved', left + width * 0.4, top + height / 2);
  await mouse('mousePressed', left + width * 0.4, top + height / 2, 1);
  for (const share of [0.5, 0.6, 0.7]) await mouse('mouseMoved', left + width * share, top + height / 2, 1);
  await mouse('mouseReleased', left + width * 0.7, top + height / 2);
  const zoomed = await evaluate(axis);
  check('dragging over a chart zooms in', zoomed !== before, zoomed);
  await click('.chart .tools button');
  check('the button shows all again', (await evaluate(axis)) === before, await evaluate(axis));
};

const checkSeries = async () => {
  await click('.chart .series input');
  const off = await evaluate(`document.querySelector('.chart .series label').classList.contains('off')`);
  const curve = await place('.chart .plot');
  await mouse('mouseMoved', curve.left + curve.width / 2 + 40, curve.top + curve.height / 2);
  const said = await text('.chart .readout');
  check('a series can be left out', off && !said.includes('best so far'), said);
};

const checkSorting = async () => {
  const column = (k) => `[...document.querySelector('table.robots').tBodies[0].rows].map((row) => row.cells[${k}].dataset.v)`;
  const names = await evaluate(`[...document.querySelector('table.robots').tHead.rows[0].cells].map((c) => c.textContent)`);
  for (const name of ['fitness', 'voxels', 'generation', 'id']) {
    const k = names.indexOf(name);
    const orders = [];
    for (let clicks = 1; clicks <= 2; ++clicks) {
      await click(`table.robots th:nth-child(${k + 1}) button`);
      const order = await evaluate(`document.querySelector('table.robots').tHead.rows[0].cells[${k}].getAttribute('aria-sort')`);
      const values = (await evaluate(column(k))).filter((value) => value !== '');
      const ranks = name === 'id' ? values : values.map(Number);
      const up = order === 'ascending' ? 1 : -1;
      const sorted = ranks.every((value, n) => n === 0 || value === ranks[n - 1] || value > ranks[n - 1] === (up > 0));
      check(`the table sorts by ${name}, ${order} (click ${clicks})`, order !== null && sorted, ranks);
      orders.push(order);
    }
    check('a second click turns the order round', orders[0] !== orders[1], orders);
  }
  await click(`table.robots th:nth-child(${names.indexOf('fitness') + 1}) button`);
  const scores = await evaluate(column(names.indexOf('fitness')));
  const failures = scores.filter((value) => value === '').length;
  check('failed robots come last', scores.slice(scores.length - failures).every((value) => value === ''), scores);
};

// Several runs: their curves side by side, each run folded until it is asked for.
const checkComparison = async () => {
  const answer = await evaluate(`({ says: document.querySelector('.answer h2')?.textContent, rows: document.querySelectorAll('.answer tbody tr').length })`);
  check('the page gives an answer', /cannot be told apart|finds fitter robots|Too few runs/.test(answer.says ?? '') && answer.rows >= 2, answer);
  check('champions are side by side', await evaluate(`document.querySelectorAll('.answer figure canvas').length >= 2 && document.querySelectorAll('.answer input[type=range]').length === 1`));
  await evaluate(settled);
  check('and are drawn', await colors('.answer figure:last-child canvas') > 8);
  const levels = await evaluate(`[...document.querySelectorAll('main :is(h1, h2, h3, h4)')].map((it) => Number(it.tagName[1]))`);
  check('headings go down by one', levels[0] === 2 && levels.every((level, k) => k === 0 || level <= levels[k - 1] + 1), levels);
  await checkAccess('light');
  const curve = await place('.chart .plot');
  await mouse('mouseMoved', curve.left + curve.width / 2, curve.top + curve.height / 2);
  const said = await text('.chart .readout');
  check('hovering over the curves says the value of each run', (said.match(/\d\.\d+/g) ?? []).length >= 2, said);
  await click('details > summary');
  await evaluate(painted);
  check('a run unfolds', await evaluate(`document.querySelector('details').open`));
  await checkCharts();
  await open(390, 844, 'dark');
  const width = await evaluate('document.documentElement.scrollWidth');
  check('nothing sticks out on a phone', width <= 390, width);
  await photograph('phone.png');
};

const checkPhone = async () => {
  await open(390, 844, 'dark');
  const width = await evaluate('document.documentElement.scrollWidth');
  check('nothing sticks out on a phone', width <= 390, width);
  const paper = await evaluate('getComputedStyle(document.body).backgroundColor');
  check('dark where the user wants it', paper === 'rgb(18, 22, 28)', paper);
  await checkCharts();
  await checkReplay('[data-cast]');
  await checkAccess('dark');
  await photograph('phone.png');
};

const checkPaper = async () => {
  const map = await evaluate(`(() => {
    dispatchEvent(new Event('beforeprint'));
    const width = document.querySelector('.five > div')?.offsetWidth ?? Infinity;
    dispatchEvent(new Event('afterprint'));
    return width;
  })()`);
  check('on paper, too, the maps of voxels can be read', map === null || map >= 180, map);
  // The first page has the champion, the verdict and the figures: A4 without its margins.
  await emulate({ width: 680, height: 1000, media: 'print' });
  const used = await evaluate(`(() => {
    document.body.classList.add('printing');
    const tiles = document.querySelector('.tiles');
    const bottom = tiles && !tiles.closest('details') ? tiles.getBoundingClientRect().bottom + scrollY : null;
    document.body.classList.remove('printing');
    return bottom;
  })()`);
  check('the first page on paper is well used', used === null || (used > 600 && used <= 1016), used);
  await emulate({ calm: true });
  const { data } = await call('Page.printToPDF', { printBackground: true });
  keep('paper.pdf', data);
  const pages = Buffer.from(data, 'base64').toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  const clean = await evaluate(`!document.querySelector('body.printing')`);
  check('it prints, and is as before afterwards', pages >= 1 && clean, { pages, clean });
};

try {
  await open(1280, 1000, 'light');
  await photograph('desk.png');
  if (await evaluate(`document.querySelector('details') !== null`)) {
    await checkComparison();
  } else {
    await checkCharts();
    await checkMaps();
    await checkOutliers();
    await checkParts();
    await checkMotion();
    await checkReplay('[data-cast]');
    await checkLineage();
    await checkAccess('light');
    await checkKeyboard();
    await checkHovering();
    await checkZooming();
    await checkSeries();
    await checkCard();
    await checkSaving();
    await checkSorting();
    await checkPhone();
  }
  await checkPaper();
  check('text of files stays text', await evaluate(`document.querySelector('img[src="x"]') === null`));
  check('no complaint on the console', complaints.length === 0, complaints);
  const outside = requests.filter((url) => !url.startsWith('data:') && !url.startsWith('file:'));
  check('nothing is asked of the network', outside.length === 0, outside);
} catch (error) {
  check('the browser can be driven', false, String(error));
}
await browser.close();
process.exit(failed ? 1 : 0);

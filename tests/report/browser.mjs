// browser.mjs BROWSER PAGE PROFILE [PICTURES]: the page of evo-report as a user meets
// it, in a real browser (with its profile in that folder) driven over the DevTools
// protocol. Says what fails; status 1 then. With a folder for PICTURES, the page is
// left there as it looks on a desk, on a phone, in the dark and printed.
import { writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { check, checkAccess, finish, launch } from '../browser/driver.mjs';

const [program, file, profile, pictures] = process.argv.slice(2);
const browser = await launch(program, profile);
const { call, evaluate, text, emulate, place, click, press, complaints, requests } = browser;

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

// ---- the checks --------------------------------------------------------------------------

// Drawn by evo-report; where a chart says a point is, its picture has a mark.
const checkCharts = async () => {
  const off = await evaluate(`(() => {
    const { charts } = JSON.parse(document.getElementById('data').textContent);
    return [...document.querySelectorAll('[data-chart]')].filter((holder) => {
      const { frame: [left, top, width, height], range: [x0, x1, y0, y1], series } = charts[holder.dataset.chart];
      const box = holder.querySelector('svg').viewBox.baseVal;
      return !holder.querySelector('svg :is(path, rect)') || left + width > box.width || top + height > box.height ||
        series.some(({ x }) => x.some((value) => value < x0 || value > x1));
    }).map((holder) => holder.dataset.name);
  })()`);
  const all = await evaluate(`document.querySelectorAll('[data-chart]').length`);
  check(`all ${all} charts are drawn`, all >= 8 && off.length === 0, off);
};

// Which voxels matter: five maps, one scale, and how many robots.
const checkMaps = async () => {
  const maps = await evaluate(`({ maps: document.querySelectorAll('[data-name^=voxels-]').length, scales: document.querySelectorAll('.scale .gradient').length,
    numbers: document.querySelectorAll('[data-name^=voxels-] text[text-anchor=middle]').length })`);
  check('the maps of voxels have one scale, and say of how many robots', maps.maps === 5 && maps.scales === 1 && maps.numbers > 50, maps);
};

// The result, the robot, the verdict and the curve are on the first screen, of a phone on two.
const checkFirstScreen = async (screens) => {
  const low = await evaluate(`Math.max(...[...document.querySelectorAll('.first .card, .first .tiles')].map((it) => it.getBoundingClientRect().bottom + scrollY))`);
  check(`what matters is on the first ${screens} screen(s)`, low <= screens * (screens === 1 ? 900 : 844), low);
  const result = await text('h1');
  check('the heading says the result', /^[\d.]+ on Walker-v0, /.test(result), result);
};

// The evolution sheet, the champion's ancestors, and its film.
const checkParts = async () => {
  const missing = await evaluate(`['.verdict', '.generation', '.step', '.film', '.first canvas', '.first [data-chart]'].filter((s) => !document.querySelector(s))`);
  check('verdict, generations, lineage and champion are there', missing.length === 0, missing);
};

// Who opens the page sees the champion move, unless they want less motion.
const checkMotion = async () => {
  await open(1280, 1000, 'light', false);
  await evaluate(settled);
  const moved = await text('[data-cast] .moment');
  check('the champion moves at once', /^step [1-9]/.test(moved), moved);
  await open(1280, 1000, 'light');
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
  const parts = await evaluate(`['.portrait use', '.facts dd', '.replay canvas', '.spark', '.command code'].filter((s) => !document.querySelector('dialog ' + s))`);
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

const checkUse = (theme, width = 1280) => checkAccess(evaluate, `${theme}, ${width} pixels`, { width, first: 2 });

const checkKeyboard = async () => {
  await evaluate(`document.querySelector('.chart svg').focus()`);
  await press('ArrowRight');
  const said = await text('.chart .readout');
  check('arrow keys read a chart', /robots trained \d/.test(said), said);
  await evaluate(`document.querySelector('.controls .play').focus()`);
  await press('Tab');
  const next = await evaluate(`document.activeElement.getAttribute('aria-label')`);
  check('the tab key leads on', next === 'Moment', next);
};

const hover = async (selector) => {
  await evaluate(`document.querySelector('${selector}').scrollIntoView({ block: 'center' })`);
  const box = await place(selector);
  await mouse('mouseMoved', box.left + box.width * 0.5, box.top + box.height * 0.4);
  return text(`${selector.split(' ')[0]} .readout`);
};
const checkHovering = async () => {
  const said = await hover('[data-name=fitness-by-robots] svg');
  check('hovering over a curve says its values', /robots trained \d+.*best so far [\d.]+/.test(said), said);
  await hover('[data-name=fitness-by-voxels] svg');
  const robot = await evaluate(`document.querySelector('[data-name=fitness-by-voxels] .readout use')?.getAttribute('href')`);
  check('hovering over a point shows its robot', /^#b-[0-9a-f]{12}$/.test(robot ?? ''), robot);
  const cell = await hover('[data-name=coverage] svg');
  check('and over a table what is there', /^[0-9a-f. failed\u2212]*voxels \d+, actuators \d+: /.test(cell), cell);
};

// What can be pressed can be hit with a finger (WCAG 2.5.8; links in sentences may be smaller).
const checkTargets = async () => {
  const small = await evaluate(`[...document.querySelectorAll('button, select, input, nav a, .sheet a, summary')].filter((it) => it.offsetWidth > 0)
    .filter((it) => { const { width, height } = it.getBoundingClientRect(); return width < 24 || height < 24; }).map((it) => it.textContent || it.className).slice(0, 5)`);
  check('what can be pressed is 24 pixels or larger', small.length === 0, small);
};

const checkSorting = async () => {
  const column = (k) => `[...document.querySelector('table.robots').tBodies[0].rows].map((row) => row.cells[${k}].textContent)`;
  const names = await evaluate(`[...document.querySelector('table.robots').tHead.rows[0].cells].map((c) => c.textContent)`);
  for (const name of ['fitness', 'voxels', 'generation', 'id']) {
    const k = names.indexOf(name);
    const orders = [];
    for (let clicks = 1; clicks <= 2; ++clicks) {
      await click(`table.robots th:nth-child(${k + 1}) button`);
      const order = await evaluate(`document.querySelector('table.robots').tHead.rows[0].cells[${k}].getAttribute('aria-sort')`);
      const values = (await evaluate(column(k))).filter((value) => !value.startsWith('failed'));
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
  check('failed robots come last', scores.at(-1).startsWith('failed') && !scores[0].startsWith('failed'), scores);
};

// Several runs: their curves side by side, each run folded until it is asked for.
const checkComparison = async () => {
  const answer = await evaluate(`({ says: document.querySelector('.answer h2')?.textContent, rows: document.querySelectorAll('.answer tbody tr').length })`);
  check('the page gives an answer', /cannot be told apart|finds fitter robots|Too few runs/.test(answer.says ?? '') && answer.rows >= 2, answer);
  check('champions are side by side', await evaluate(`document.querySelectorAll('.answer figure canvas').length >= 2 && document.querySelectorAll('.answer input[type=range]').length === 1`));
  await evaluate(settled);
  check('and are drawn', await colors('.answer figure:last-child canvas') > 8);
  await checkUse('light');
  const said = await hover('[data-name=best-so-far-Walker-v0] svg');
  check('hovering over the curves says the value of each run', (said.match(/\d\.\d+/g) ?? []).length >= 2, said);
  await click('details > summary');
  await evaluate(painted);
  check('a run unfolds', await evaluate(`document.querySelector('details').open`));
  await checkCharts();
  await open(390, 844, 'dark');
  await checkUse('dark', 390);
  await photograph('phone.png');
};

const checkPhone = async () => {
  await open(390, 844, 'dark');
  const paper = await evaluate('getComputedStyle(document.body).backgroundColor');
  check('dark where the user wants it', paper === 'rgb(18, 22, 28)', paper);
  await checkFirstScreen(2);
  await checkTargets();
  await checkReplay('[data-cast]');
  await checkUse('dark', 390);
  await photograph('phone.png');
};

const checkPaper = async () => {
  // A4 without its margins: nothing is cut at its right.
  await emulate({ width: 680, height: 1000, media: 'print' });
  const cut = await evaluate(`[...document.querySelectorAll('main :is(code, table, svg, .sheet)')].filter((it) => it.offsetWidth !== 0 && it.getBoundingClientRect().width > 0 &&
    !it.closest('details:not([open])') && it.getBoundingClientRect().right > 681).map((it) => it.className.baseVal ?? it.className ?? it.tagName)`);
  check('nothing is cut on paper', cut.length === 0, cut);
  await emulate({ calm: true });
  const { data } = await call('Page.printToPDF', { printBackground: true });
  keep('paper.pdf', data);
  const pages = Buffer.from(data, 'base64').toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  check('it prints', pages >= 1, pages);
};

try {
  await open(1280, 900, 'light');
  await photograph('desk.png');
  if (await evaluate(`document.querySelector('details') !== null`)) {
    await checkComparison();
  } else {
    await checkCharts();
    await checkMaps();
    await checkFirstScreen(1);
    await checkParts();
    await checkMotion();
    await checkReplay('[data-cast]');
    await checkLineage();
    await checkUse('light');
    await checkKeyboard();
    await checkHovering();
    await checkCard();
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
finish();

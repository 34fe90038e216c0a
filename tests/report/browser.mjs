// browser.mjs BROWSER PAGE PROFILE [PICTURES]: the page of evo-report as a user meets
// it, in a real browser (with its profile in that folder) driven over the DevTools
// protocol. Says what fails; status 1 then. With a folder for PICTURES, the page is
// left there as it looks on a desk, on a phone, in the dark and printed.
import { spawn } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [program, file, profile, pictures] = process.argv.slice(2);
const browser = spawn(program, ['--headless=new', '--no-sandbox', '--disable-gpu',
  '--remote-debugging-pipe', `--user-data-dir=${profile}`],
  { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });

// ---- the protocol: JSON messages that end with a zero byte --------------------------

const answers = new Map();
const complaints = [];
const requests = [];
let session, count = 0, received = '';

const call = (method, params = {}) => new Promise((resolve, reject) => {
  answers.set(++count, { resolve, reject });
  browser.stdio[3].write(JSON.stringify({ id: count, method, params, sessionId: session }) + '\0');
});

const hear = (message) => {
  if (message.id) {
    const { resolve, reject } = answers.get(message.id);
    if (message.error) reject(new Error(message.error.message));
    else resolve(message.result);
  } else if (message.method === 'Runtime.exceptionThrown') {
    complaints.push(message.params.exceptionDetails.exception?.description ?? 'exception');
  } else if (message.method === 'Runtime.consoleAPICalled') {
    complaints.push(message.params.args.map((arg) => arg.value).join(' '));
  } else if (message.method === 'Log.entryAdded') {
    complaints.push(message.params.entry.text);
  } else if (message.method === 'Network.requestWillBeSent') {
    requests.push(message.params.request.url);
  }
};

browser.stdio[4].on('data', (data) => {
  const messages = (received + data).split('\0');
  received = messages.pop();
  messages.forEach((message) => hear(JSON.parse(message)));
});

// ---- what a user does -----------------------------------------------------------------

const evaluate = async (expression) => {
  const { result, exceptionDetails } =
    await call('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? expression);
  return result.value;
};
const painted = 'new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))';

const open = async (width, height, scheme) => {
  await call('Emulation.setDeviceMetricsOverride',
    { width, height, deviceScaleFactor: 1, mobile: width < 600 });
  await call('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: scheme }] });
  await call('Page.navigate', { url: pathToFileURL(file).href });
  await evaluate(`new Promise((done) => document.readyState === 'complete' ? done() : addEventListener('load', done))`);
  await evaluate(painted);
};

const keep = (name, data) => pictures && writeFileSync(`${pictures}/${name}`, Buffer.from(data, 'base64'));
const photograph = async (name) => {
  if (!pictures) return;
  const { cssContentSize: { width, height } } = await call('Page.getLayoutMetrics');
  const clip = { x: 0, y: 0, width, height: Math.min(height, 8000), scale: 1 };
  keep(name, (await call('Page.captureScreenshot', { captureBeyondViewport: true, clip })).data);
};

// The rectangle of what a selector finds, scrolled into view.
const place = (selector) => evaluate(`(() => {
  const found = document.querySelector(${JSON.stringify(selector)});
  found.scrollIntoView({ block: 'center', behavior: 'instant' });
  const { left, top, width, height } = found.getBoundingClientRect();
  return { left, top, width, height };
})()`);
const mouse = (type, x, y, buttons = 0) => call('Input.dispatchMouseEvent',
  { type, x, y, button: type === 'mouseMoved' ? 'none' : 'left', buttons, clickCount: type === 'mouseMoved' ? 0 : 1 });
const click = async (selector) => {
  const { left, top, width, height } = await place(selector);
  await mouse('mousePressed', left + width / 2, top + height / 2, 1);
  await mouse('mouseReleased', left + width / 2, top + height / 2);
};
const text = (selector) => evaluate(`document.querySelector(${JSON.stringify(selector)}).textContent`);

let failed = 0;
const check = (what, good, found = '') => {
  console.log(`${good ? 'ok' : 'NOT OK'}: ${what}${good ? '' : `; found ${JSON.stringify(found)}`}`);
  failed += good ? 0 : 1;
};

// ---- the checks --------------------------------------------------------------------------

const checkCharts = async () => {
  const blank = await evaluate(`[...document.querySelectorAll('[data-chart]')].filter((holder) => {
    const canvas = [...holder.querySelectorAll('canvas')].find((c) => c.width > 0);
    if (!canvas) return true;
    const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    return !pixels.some((value) => value !== 0);
  }).map((holder) => holder.dataset.chart)`);
  const all = await evaluate(`document.querySelectorAll('[data-chart]').length`);
  check(`all ${all} charts are drawn`, all >= 8 && blank.length === 0, blank);
};

// The evolution sheet, the champion's ancestors, its film, and its video, which plays.
const checkParts = async () => {
  const missing = await evaluate(`['.generation', '.step', '.film, video, img'].filter((s) => !document.querySelector(s))`);
  check('generations, lineage and champion are there', missing.length === 0, missing);
  const videos = await evaluate(`Promise.all([...document.querySelectorAll('video')].map(async (video) => {
    video.preload = 'auto';
    if (video.readyState < 2) await new Promise((done) => { video.onloadeddata = video.onerror = done; setTimeout(done, 5000); });
    return video.readyState >= 2 && video.videoWidth > 0 && video.duration > 0;
  }))`);
  check(`${videos.length} videos can be played`, videos.every(Boolean), videos);
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

const checkZooming = async () => {
  const axis = `[...document.querySelector('.chart').querySelectorAll('.dygraph-axis-label-x')].map((l) => l.textContent).join()`;
  const before = await evaluate(axis);
  const { left, top, width, height } = await place('.chart .plot');
  await mouse('mouseMoved', left + width * 0.4, top + height / 2);
  await mouse('mousePressed', left + width * 0.4, top + height / 2, 1);
  for (const share of [0.5, 0.6, 0.7]) await mouse('mouseMoved', left + width * share, top + height / 2, 1);
  await mouse('mouseReleased', left + width * 0.7, top + height / 2);
  const zoomed = await evaluate(axis);
  check('dragging over a chart zooms in', zoomed !== before, zoomed);
  await click('.chart .series button');
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
  await photograph('phone.png');
};

const checkPaper = async () => {
  const { data } = await call('Page.printToPDF', { printBackground: true });
  keep('paper.pdf', data);
  const pages = Buffer.from(data, 'base64').toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  const clean = await evaluate(`!document.querySelector('.frozen, body.printing')`);
  check('it prints, and is as before afterwards', pages >= 1 && clean, { pages, clean });
};

try {
  const { targetId } = await call('Target.createTarget', { url: 'about:blank' });
  session = (await call('Target.attachToTarget', { targetId, flatten: true })).sessionId;
  for (const domain of ['Runtime', 'Log', 'Page', 'Network']) await call(`${domain}.enable`);
  await open(1280, 1000, 'light');
  await photograph('desk.png');
  if (await evaluate(`document.querySelector('details') !== null`)) {
    await checkComparison();
  } else {
    await checkCharts();
    await checkParts();
    await checkHovering();
    await checkZooming();
    await checkSeries();
    await checkSorting();
    await checkPhone();
  }
  await checkPaper();
  check('text of files stays text', await evaluate(`document.querySelector('img[src="x"]') === null`));
  check('no complaint on the console', complaints.length === 0, complaints);
  const outside = requests.filter((url) => !url.startsWith('data:') && !url.startsWith('file:'));
  check('nothing is asked of the network', outside.length === 0, outside);
  session = undefined;
  const gone = new Promise((done) => browser.on('exit', done));
  await call('Browser.close');
  await gone;
} catch (error) {
  check('the browser can be driven', false, String(error));
  browser.kill();
}
process.exit(failed ? 1 : 0);

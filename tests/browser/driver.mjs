// A page in a real browser as a user meets it, over the DevTools protocol.
import { spawn } from 'node:child_process';
import { writeFileSync } from 'node:fs';

let failed = 0;
export const check = (what, good, found = '') => {
  console.log(`${good ? 'ok' : 'NOT OK'}: ${what}${good ? '' : `; found ${JSON.stringify(found)}`}`);
  failed += good ? 0 : 1;
};
export const finish = () => process.exit(failed ? 1 : 0);

export const launch = async (program, profile, { offline = false } = {}) => {
  const browser = spawn(program, ['--headless=new', '--no-sandbox', '--disable-gpu', '--remote-debugging-pipe', `--user-data-dir=${profile}`],
    { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
  const answers = new Map();
  const complaints = [], requests = [];
  let session, count = 0;
  // JSON messages that end with a zero byte.
  const call = (method, params = {}) => new Promise((resolve, reject) => {
    answers.set(++count, { resolve, reject });
    browser.stdio[3].write(JSON.stringify({ id: count, method, params, sessionId: session }) + '\0');
  });
  const hear = (message) => {
    if (message.id) {
      const { resolve, reject } = answers.get(message.id);
      answers.delete(message.id);
      if (message.error) reject(new Error(message.error.message));
      else resolve(message.result);
    } else if (message.method === 'Runtime.exceptionThrown') {
      complaints.push(message.params.exceptionDetails.exception?.description ?? message.params.exceptionDetails.text);
    } else if (message.method === 'Runtime.consoleAPICalled') {
      complaints.push(message.params.args.map((arg) => arg.value).join(' '));
    } else if (message.method === 'Log.entryAdded') {
      complaints.push(message.params.entry.text);
    } else if (message.method === 'Network.requestWillBeSent') {
      requests.push(message.params.request.url);
    }
  };
  const parts = [];
  browser.stdio[4].on('data', (data) => {
    let rest = data;
    for (let at; (at = rest.indexOf(0)) >= 0; rest = rest.subarray(at + 1)) {
      parts.push(rest.subarray(0, at));
      hear(JSON.parse(Buffer.concat(parts.splice(0)).toString()));
    }
    if (rest.length) parts.push(rest);
  });

  const { targetId } = await call('Target.createTarget', { url: 'about:blank' });
  ({ sessionId: session } = await call('Target.attachToTarget', { targetId, flatten: true }));
  for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await call(`${domain}.enable`);
  if (offline) await call('Network.emulateNetworkConditions', { offline: true, latency: 0, downloadThroughput: -1, uploadThroughput: -1 });

  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await call('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? expression);
    return result.value;
  };
  const text = (selector) => evaluate(`document.querySelector(${JSON.stringify(selector)}).textContent`);
  // The value of an expression once it is true, within so many seconds.
  const until = async (expression, seconds = 10) => {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
      const value = await evaluate(expression);
      if (value) return value;
      await new Promise((done) => setTimeout(done, 60));
    }
    return evaluate(expression);
  };
  const emulate = async ({ width = 1280, height = 900, scheme = 'light', calm = false, media = '' } = {}) => {
    await call('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: width < 600 });
    await call('Emulation.setTouchEmulationEnabled', { enabled: width < 600 });
    await call('Emulation.setEmulatedMedia', { media, features: [{ name: 'prefers-color-scheme', value: scheme },
      { name: 'prefers-reduced-motion', value: calm ? 'reduce' : 'no-preference' }] });
  };
  const open = async (url) => {
    await call('Page.navigate', { url: 'about:blank' });
    await call('Page.navigate', { url });
    await until(`document.readyState === 'complete'`);
  };
  const picture = async (path, whole = true) => {
    const { cssContentSize: { width, height } } = await call('Page.getLayoutMetrics');
    const clip = whole ? { clip: { x: 0, y: 0, width, height: Math.min(height, 7000), scale: 1 }, captureBeyondViewport: true } : {};
    writeFileSync(path, Buffer.from((await call('Page.captureScreenshot', clip)).data, 'base64'));
  };
  // The rectangle of what a selector finds, and its middle, scrolled into view.
  const place = (selector) => evaluate(`(() => {
    const found = document.querySelector(${JSON.stringify(selector)});
    found.scrollIntoView({ block: 'center', behavior: 'instant' });
    const { left, top, width, height } = found.getBoundingClientRect();
    return { left, top, width, height, x: left + width / 2, y: top + height / 2 };
  })()`);
  const click = async (selector) => {
    const { x, y } = await place(selector);
    for (const type of ['mousePressed', 'mouseReleased']) await call('Input.dispatchMouseEvent', { type, x, y, button: 'left', buttons: 1, clickCount: 1 });
  };
  const press = async (key, text) => {
    const code = { Enter: 13, Tab: 9, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40, Delete: 46, Home: 36, Escape: 27 }[key] ?? key.toUpperCase().charCodeAt(0);
    await call('Input.dispatchKeyEvent', { type: 'keyDown', key, windowsVirtualKeyCode: code, ...(text ? { text } : {}) });
    await call('Input.dispatchKeyEvent', { type: 'keyUp', key, windowsVirtualKeyCode: code });
  };
  // A finger from the middle of what a selector finds, so many pixels up; a tap, where none.
  const swipe = async (selector, up = 0) => {
    const { x, y } = await place(selector);
    await call('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [{ x, y }] });
    for (let moved = 0; moved < up; moved += 15) {
      await call('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: [{ x, y: y - moved - 15 }] });
      await new Promise((done) => setTimeout(done, 20));
    }
    await call('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
  };
  const close = async () => {
    session = undefined;
    await Promise.race([call('Browser.close').catch(() => {}), new Promise((done) => setTimeout(done, 3000))]);
    browser.kill();
  };
  return { call, evaluate, text, until, emulate, open, picture, place, click, press, swipe, close, complaints, requests };
};

// What is hard to use on the page that is open, whose headings within <main> begin with this level.
export const checkAccess = async (evaluate, what, { width, first }) => {
  const { pale, nameless, twice, headings, wide } = await accessFaults(evaluate);
  check(`text can be read (4.5 to 1), ${what}`, pale.length === 0, pale);
  check(`what can be pressed or seen has a name, ${what}`, nameless.length === 0, nameless);
  check(`no id is there twice, ${what}`, twice.length === 0, twice);
  check(`headings go down by one, ${what}`, headings[0] === first && headings.every((level, k) => k === 0 || level <= headings[k - 1] + 1), headings);
  check(`nothing is wider than the screen, ${what}`, wide <= width, wide);
};

// Text too pale for what is behind it (below 4.5 to 1), what can be pressed or seen and has no
// name, what can be scrolled and not be reached with the keyboard, ids that are there twice.
const accessFaults = (evaluate) => evaluate(`(() => {
  const read = (text) => (text.match(/[\\d.]+/g) ?? []).map(Number);
  const luminance = ([r, g, b]) => [r, g, b].map((v) => v / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = (node) => {
    const picture = node.closest('svg');
    if (picture) {  // a number on its cell
      const { x, y, width, height } = node.getBBox(), middle = new DOMPoint(x + width / 2, y + height / 2);
      const cell = [...picture.querySelectorAll('path, rect')].filter((it) => !['none', null].includes(it.getAttribute('fill'))
        && !it.hasAttribute('fill-opacity') && it.isPointInFill(middle)).pop();
      if (cell) return read(getComputedStyle(cell).fill);
    }
    for (let at = node; at; at = at.parentElement) {
      const text = getComputedStyle(at).backgroundColor, color = read(text);
      if (text.startsWith('color(srgb')) return color.slice(0, 3).map((v) => v * 255);
      if (color.length === 3 || color[3] === 1) return color;
    }
    return [255, 255, 255];
  };
  const pale = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = walker.nextNode());) {
    const parent = node.parentElement;
    if (!node.textContent.trim() || !parent.getClientRects().length || parent.closest('script, style, noscript, title, option')) continue;
    const style = getComputedStyle(parent);
    const ink = read(parent.closest('svg') ? style.fill : style.color);
    const [a, b] = [luminance(ink), luminance(behind(parent))].sort((x, y) => y - x);
    if ((a + 0.05) / (b + 0.05) < 4.5) pale.push([node.textContent.trim().slice(0, 30), ((a + 0.05) / (b + 0.05)).toFixed(2)]);
  }
  const nameless = [...document.querySelectorAll('button, input, select, textarea, a, img, [role=img], summary')]
    .filter((it) => it.getClientRects().length && !(it.getAttribute('aria-label') || it.alt || it.textContent.trim() || it.labels?.length || it.querySelector('[aria-label]')))
    .map((it) => it.outerHTML.slice(0, 80));
  const unreachable = [...document.querySelectorAll('body *')].filter((it) => it.scrollWidth > it.clientWidth + 1 && it.getClientRects().length
      && ['auto', 'scroll'].includes(getComputedStyle(it).overflowX) && it.tabIndex < 0 && !it.querySelector('a, button, input, select, [tabindex="0"]'))
    .map((it) => it.outerHTML.slice(0, 80));
  const ids = [...document.querySelectorAll('[id]')].map((it) => it.id);
  return { pale: pale.slice(0, 8), nameless: [...nameless, ...unreachable], twice: ids.filter((id, k) => ids.indexOf(id) !== k).slice(0, 5),
    headings: [...document.querySelectorAll('main :is(h1, h2, h3, h4)')].map((it) => Number(it.tagName[1])), wide: document.documentElement.scrollWidth };
})()`);

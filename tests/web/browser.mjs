// browser.mjs BROWSER SITE PROFILE [PICTURES]: the site as a user meets it, from disk and
// without a network. Says what fails; status 1 then. With a folder for PICTURES, the pages are
// left there as they look on a desk, on a phone and in the dark.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { check, checkAccess, finish, launch } from '../browser/driver.mjs';

const [program, site, profile, pictures] = process.argv.slice(2);
const browser = await launch(program, profile, { offline: true });
const { evaluate, text, until, emulate, click, press, swipe } = browser;
const home = pathToFileURL(`${site}/`).href;
const play = async (hash = '') => {
  await browser.open(`${home}play.html${hash}`);
  await until(`document.documentElement.dataset.ready`, 30);
};
const photograph = (name, whole) => pictures && browser.picture(`${pictures}/${name}.png`, whole);

const stepped = `Number(document.getElementById('moment').textContent.match(/step (\\d+)/)?.[1]) > 3`;
const body = () => evaluate(`[...document.querySelectorAll('#grid > div')].map((row) => [...row.children].map((cell) => cell.className.replace('block-', '').replace('none', '.')).join('')).join('-')`);

const checkFirst = async () => {
  const began = Date.now();
  await play();
  check('the first robot moves', await until(stepped, 30), await text('#moment'));
  console.log(`    ${Date.now() - began} ms from opening to motion`);
  const high = await evaluate(`(() => {
    const { body, gait: [amplitude, period, phase] } = Evo.firstRobot;
    const player = Evo.evo.open('Walker-v0', { body });
    player.control({ kind: 'wave', amplitude, period, phase });
    player.reset();
    let high = 0;
    for (let t = 0; t < 100; ++t) {
      player.step(1);
      const feet = player.positions().filter((value, k) => k % 2 && k < 2 * player.objects[0].points);
      high = Math.max(high, Math.min(...feet) / player.voxel - 1);
    }
    player.close();
    return high;
  })()`);
  check('it leaps two voxels and more', high > 2, high);
  const sizes = await evaluate(`performance.getEntriesByType('resource').map((each) => each.name)`);
  check('it needs nothing but this folder', sizes.every((url) => url.startsWith(home)), sizes);
};

const checkKeyboard = async () => {
  await play('#task=Walker-v0&body=...-...-...&gait=0.5,20,0.7');
  await evaluate(`(() => { document.querySelector('#rows').value = 3; document.querySelector('#columns').value = 3; document.querySelector('#rows').dispatchEvent(new Event('change')); document.querySelector('#grid [tabindex="0"]').focus(); })()`);
  await press('Home');
  for (const row of ['HHH', 'VSV', 'V.V']) {
    for (const [c, letter] of [...row].entries()) {
      await press(letter.toLowerCase(), letter.toLowerCase());
      if (c < 2) await press('ArrowRight');
    }
    await press('ArrowDown'); await press('ArrowLeft'); await press('ArrowLeft');
  }
  check('a body is drawn with the keyboard', (await body()) === 'HHH-VSV-V.V', await body());
  await evaluate(`document.querySelector('#play').focus()`);
  if ((await text('#play')) === 'Play') await press('Enter', '\r');
  check('and it walks', await until(stepped), await text('#moment'));
  check('without a complaint', (await text('#message')) === '', await text('#message'));
};

// A file as if it were dropped on the page.
const drop = (name, content) => evaluate(`(() => {
  const transfer = new DataTransfer();
  transfer.items.add(new File([Uint8Array.from(atob('${Buffer.from(content).toString('base64')}'), (c) => c.charCodeAt(0))], '${name}'));
  dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, cancelable: true }));
})()`);

const at = (r, c) => `#grid [data-r="${r}"][data-c="${c}"]`;
const checkTouch = async () => {
  await emulate({ width: 390, height: 844 });
  await play('#task=Walker-v0&body=HH.-H..-...&gait=0.5,20,0.7');
  const low = await evaluate(`Math.max(...['evolve', 'copy-link', 'undo'].map((id) => document.getElementById(id).getBoundingClientRect().bottom))`);
  check('evolve, link and undo are on the first screen of a phone', low <= 844, low);
  await photograph('play-phone-first', false);
  await browser.place(at(2, 2));
  const before = await evaluate('scrollY');
  await swipe(at(2, 2), 150);
  check('a finger on the body scrolls and draws nothing', (await body()) === 'HH.-H..-...' && await until(`scrollY > ${before} + 40`), [before, await evaluate('scrollY'), await body()]);
  await new Promise((done) => setTimeout(done, 500));  // it glides
  await click('.materials .block-V');
  for (const cell of [[1, 0], [2, 0]]) await swipe(at(...cell));
  await click('.materials .block-H');
  for (const cell of [[1, 1], [1, 2], [2, 2]]) await swipe(at(...cell));
  check('a body is drawn with a finger', (await body()) === 'HH.-VHH-V.H', await body());
  check('and it walks', await until(stepped), await text('#moment'));
  const wide = await evaluate('document.documentElement.scrollWidth');
  check('nothing is wider than a phone', wide <= 390, wide);
  await photograph('play-phone');
  await emulate();
};

const checkUndo = async () => {
  await play('#task=Walker-v0&body=HH-VV&gait=0.5,20,0.7');
  const command = () => text('#command'), first = await command();
  await click('.materials .block-R');
  await click(at(0, 0));
  const drawn = await command();
  await evaluate(`(() => { const it = document.getElementById('period'); for (const value of [21, 25, 30]) { it.value = value; it.dispatchEvent(new Event('input')); } })()`);
  await evaluate(`(() => { const it = document.getElementById('task'); it.value = 'Jumper-v0'; it.dispatchEvent(new Event('change')); })()`);
  const last = await command();
  const key = (shiftKey) => evaluate(`document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'z', ctrlKey: true, shiftKey: ${shiftKey}, bubbles: true }))`);
  await key(false);
  await key(false);
  check('a task and a slider are undone', (await command()) === drawn && drawn !== first, await command());
  await click('#undo');
  check('so is a block', (await command()) === first && (await body()) === 'HH-VV' && await evaluate(`document.getElementById('undo').disabled`), await command());
  for (let k = 0; k < 3; ++k) await key(true);
  check('all of it is done again', (await command()) === last && last.includes('Jumper-v0') && await evaluate(`document.getElementById('redo').disabled`), await command());
};

// A climb at ten times the speed: what the task follows is never out of the picture.
const checkCamera = async () => {
  await play('#record=Climber-v0');
  await evaluate(`(() => {
    const paint = Evo.Stage.paint;
    globalThis.frames = { all: 0, lost: 0, top: 0 };
    Evo.Stage.paint = (canvas, scene, x, y, camera, ...more) => {
      paint(canvas, scene, x, y, camera, ...more);
      const points = [...new Set(scene.body.flatMap(([, ...corners]) => corners))];
      const middle = points.reduce((sum, p) => sum + y[p], 0) / points.length;
      const up = (middle - camera.low) * camera.scale;
      ++frames.all; frames.top = Math.max(frames.top, middle);
      if (up < 40 || up > canvas.clientHeight - 40) ++frames.lost;
    };
    const speed = document.getElementById('speed');
    speed.value = 10;
    speed.dispatchEvent(new Event('change'));
    document.getElementById('restart').click();
  })()`);
  check('the goal is reached', await until(`document.getElementById('moment').textContent.includes('goal reached')`, 30), await text('#moment'));
  const frames = await evaluate('frames');
  check('a climber stays in the picture', frames.all > 5 && frames.lost === 0 && frames.top > 80, frames);
  check('it earns what the record says', (await text('#goal')) === 'the record, to the last bit', await text('#goal'));
  await photograph('climber', false);
};

const checkLink = async () => {
  await play('#task=Jumper-v0&body=VVV-HHH-V.V&gait=0.31,17.5,1.25');
  check('a link restores the task', (await evaluate(`document.getElementById('task').value`)) === 'Jumper-v0');
  check('and the body', (await body()) === 'VVV-HHH-V.V', await body());
  check('and the rhythm', (await text('#command')).includes('--actions sine:0.31,17.5,1.25'), await text('#command'));
  check('and is its own address', (await evaluate('location.hash')) === '#task=Jumper-v0&body=VVV-HHH-V.V&gait=0.31,17.5,1.25', await evaluate('location.hash'));
  await evaluate(`navigator.clipboard.writeText = async (text) => { globalThis.copied = text; }`);
  await click('#copy-link');
  check('it is copied', (await until('globalThis.copied')) === `${home}play.html#task=Jumper-v0&body=VVV-HHH-V.V&gait=0.31,17.5,1.25`, await evaluate('copied'));
  const other = readdirSync(`${site}/records`).find((name) => name.endsWith('.js') && readFileSync(`${site}/records/${name}`, 'utf8').includes('"kind":"modular"')).slice(0, -3);
  await play(`#record=${other}&body=HVH-V.V`);
  check('a link gives a modular record another body', await until(`document.getElementById('gait-about').textContent.startsWith('Driven by the modular policy of the record ${other}')`) && (await body()) === 'HVH-V.V' && await until(stepped), await body());
  check('and stays', (await evaluate('location.hash')) === `#record=${other}&body=HVH-V.V`, await evaluate('location.hash'));
  await play(`#record=${other}&body=HXH`);
  check('a body that is none leaves it its own', await until(`document.getElementById('message').textContent.startsWith('The body in this address is none')`) && (await evaluate('location.hash')) === `#record=${other}`, [await text('#message'), await evaluate('location.hash')]);
  await play('#task=Walkr-v0&body=HH&gait=0.5,20,0.7');
  check('a link to no task says so in the words of the tools', (await text('#message')).includes("unknown task 'Walkr-v0' (did you mean 'Walker-v0'?)"), await text('#message'));
};

const checkTasks = async () => {
  const names = await evaluate('Evo.tasks.map(({ name }) => name)');
  check('there are 32 tasks', names.length === 32, names.length);
  const still = [];
  await evaluate(`document.getElementById('speed').value = 1`);
  for (const name of names) {
    await evaluate(`location.hash = '#task=${name}&body=RHHHR-VSSSV-VHRHV-V...V-V...V&gait=0.5,20,0.7'`);
    const moved = await until(`document.getElementById('task').value === '${name}' && ${stepped}`);
    if (!moved || (await text('#message')) !== '') still.push([name, await text('#message'), await text('#moment')]);
  }
  check('each loads and steps', still.length === 0, still);
};

const checkOwn = async () => {
  await play();
  const use = async (text) => {
    await evaluate(`(() => { document.getElementById('own').open = true; document.getElementById('own-text').value = ${JSON.stringify(text)}; document.getElementById('own-use').click(); })()`);
  };
  await use('format: evo/task\nversion: 1\nname: slope\nsteps: 50\nrobot: {at: [1, 1]}\nworld:\n  objects:\n    ground: {at: [0, 0], size: [30, 1], fill: "#"}\nobservation: [velocity: robot]\nreward: [displacement: {of: robot, axis: x}]\n');
  check('a task of one\'s own is taken', (await text('#message')) === '' && (await until(`document.getElementById('moment').textContent.includes('of 50')`)), await text('#message'));
  check('and its link carries it', (await evaluate('location.hash')).startsWith('#own=format'), await evaluate('location.hash'));
  await use('format: evo/task\nversion: 1\nname: slope\nsteps: 50\nrobot: {at: [1, 1]}\nworld: {objekts: {}}\n');
  check('a mistake is told as the tools tell it', (await text('#message')).endsWith("task:6:9: world: unknown key 'objekts' (did you mean 'objects'?); allowed: file, drawing, legend, objects"), await text('#message'));
  await use(JSON.stringify({ grid_width: 20, grid_height: 6, objects: { ground: { indices: [...Array(20).keys()], types: Array(20).fill(5), neighbors: Object.fromEntries([...Array(20).keys()].map((k) => [k, [k - 1, k + 1].filter((n) => n >= 0 && n < 20)])) } } }));
  check('so is a world of the design tool', (await text('#message')) === '', await text('#message'));
};

// What the page reads from a file, dropped or opened.
const checkFiles = async () => {
  await play();
  await drop('robot.json', JSON.stringify({ body: ['HVH', 'V.V'], task: 'UpStepper-v0' }));
  check('a dropped robot is taken', (await until(`document.getElementById('task').value === 'UpStepper-v0'`)) && (await body()) === 'HVH-V.V', await body());
  await drop('bad.json', '{"body": ["RR", "RR"]}');
  check('a robot without muscles is refused in the words of the tools', await until(`document.getElementById('message').textContent.includes('there is no actuator (H or V), nothing can move this robot')`), await text('#message'));
};

// Policies that the tools wrote.
const checkPolicies = async () => {
  const open = async (name) => {
    await play();
    await drop(name, readFileSync(`${process.env.EVO_FILES}/${name}`));
  };
  const about = () => text('#gait-about');
  const earned = async (expected) => {
    await evaluate(`(document.getElementById('speed').value = 10, document.getElementById('speed').dispatchEvent(new Event('change')))`);
    return await until(`document.getElementById('moment').textContent.includes('over')`, 60) && (await text('#return')) === (await evaluate(`Evo.number(${expected})`));
  };
  await open('policy.json');
  check('a dropped policy drives its robot', await until(`document.getElementById('gait-about').textContent.startsWith('Driven by the network of policy.json')`), await about());
  check('and moves', await until(stepped), await text('#moment'));
  await open('modular.json');
  check('a modular policy drives its robot', await until(`document.getElementById('gait-about').textContent.startsWith('Driven by the modular policy of modular.json')`), await about());
  for (const [name, size] of [['rows', 2], ['columns', 3]])
    await evaluate(`(() => { const pick = document.getElementById('${name}'); pick.value = ${size}; pick.dispatchEvent(new Event('change')); })()`);
  await evaluate(`document.querySelector('#grid [data-r="0"][data-c="0"]').focus()`);
  await press('Home');
  for (const [row, moves] of [['HVH', ['ArrowRight', 'ArrowRight', 'Home']], ['V.V', ['ArrowRight', 'ArrowRight', 'Home']]]) {
    for (const [c, letter] of [...row].entries()) { await press(letter.toLowerCase(), letter.toLowerCase()); await press(moves[c]); }
    await press('ArrowDown');
  }
  check('another body is drawn for it', (await body()) === 'HVH-V.V', await body());
  check('it drives that one, too', (await about()).startsWith('Driven by the modular policy') && await earned(process.env.EVO_OTHER_BODY), [await about(), await text('#return'), process.env.EVO_OTHER_BODY]);
  check('the command draws the same', (await text('#command')) === `printf 'HVH\\nV.V\\n' |\n  evo-eval --policy modular.h5`, await text('#command'));
  await photograph('any-body');
  await open('policy.h5');
  check('a file in HDF5 is answered with the way', await until(`document.getElementById('message').textContent.endsWith('evo-convert policy.h5 --to json -o policy.json')`), await text('#message'));
  await open('cut.json');
  check('a damaged file is refused', await until(`document.getElementById('message').textContent.startsWith('cut.json: ')`), await text('#message'));
  check('and the robot from before is there', await until(stepped), await text('#moment'));
};

const checkEvolve = async () => {
  await play('#evolve');
  check('a link begins to evolve', await until(`document.getElementById('evolve').textContent === 'Stop' && /tried/.test(document.getElementById('evolve-says').textContent)`, 20), await text('#evolve-says'));
  await play('#task=Walker-v0&body=RHHHR-VSSSV-VHRHV-V...V-V...V&gait=0.5,20,0.7');
  await click('#evolve');
  check('it evolves a better robot', await until(`/from −[0-9.]+ to [0-9]/.test(document.getElementById('evolve-says').textContent)`, 40), await text('#evolve-says'));
  check('which is the one on the stage', !(await evaluate('location.hash')).includes('gait=0.5,20,0.7'), await evaluate('location.hash'));
  await click('#evolve');
  check('and stops when told', (await text('#evolve-says')).includes('Stopped'), await text('#evolve-says'));
  await photograph('evolved');
};

const checkGallery = async () => {
  await browser.open(`${home}index.html`);
  const shown = () => evaluate(`[...document.querySelectorAll('#wall article')].filter((it) => !it.hidden).map((it) => it.dataset.name)`);
  const choose = (name, value) => evaluate(`(() => { const it = document.getElementById('choose').elements.${name}; it.value = '${value}'; it.dispatchEvent(new Event('input', { bubbles: true })); })()`);
  check('a card for each task', (await shown()).length === 32);
  await choose('difficulty', 'hard');
  check('they are chosen by difficulty', await evaluate(`[...document.querySelectorAll('#wall article')].every((it) => it.hidden === (it.dataset.difficulty !== 'hard'))`), await shown());
  await choose('difficulty', '');
  await choose('find', 'climb');
  check('and by name', (await shown()).length === 3 && (await text('#count')) === '3 of 32', await shown());
  await choose('find', '');
  await choose('sort', 'name');
  check('and sorted', (await shown())[0] === 'areamaximizer-v0', await shown());
  const loops = await evaluate(`Promise.all([...document.images].map((it) => (it.loading = 'eager', it.decode().then(() => 1, () => it.src))))`);
  check('each loop can be shown', loops.length === 32 && loops.every((it) => it === 1), loops);
  await photograph('gallery', false);
  await click('#still');
  check('they can be held still', await evaluate(`[...document.images].every((it) => it.src.endsWith('.png'))`));
};

// Every page of the folder: where it leads, and what a preview is made of.
const checkPages = () => {
  const pages = readdirSync(site, { recursive: true }).filter((name) => name.endsWith('.html'));
  const html = Object.fromEntries(pages.map((name) => [name, readFileSync(`${site}/${name}`, 'utf8')]));
  const lost = [], poor = [];
  for (const name of pages) {
    for (const [, to, part] of html[name].matchAll(/(?:href|src)="([^":#]*)(?:#([^"]*))?"/g)) {
      const path = to ? join(dirname(name), decodeURI(to)) : name;
      if (!existsSync(`${site}/${path}`) || (part && path !== 'play.html' && html[path] && !html[path].includes(`id="${part}"`))) lost.push(`${name}: ${to}#${part}`);
    }
    const meta = (key) => html[name].match(new RegExp(`<meta (?:name|property)="${key}" content="([^"]+)"`))?.[1];
    const title = html[name].match(/<title>(.+)<\/title>/)?.[1];
    if (!title || !meta('description') || meta('og:title') !== title || !existsSync(join(site, dirname(name), meta('og:image') ?? '-')) || !html[name].includes('rel="icon"') || !meta('theme-color')) poor.push(name);
  }
  check(`every link of ${pages.length} pages leads somewhere`, pages.length > 60 && lost.length === 0, lost);
  check('each has a title, a description, a picture, a colour', poor.length === 0, poor);
  const records = pages.filter((name) => /^records\/.*-v\d\.html$/.test(name));
  check('a record page tells of its task', records.length === 32 && records.every((name) => html[name].includes('evo/task') && html[name].includes(`og:title" content="${name.slice(8, -5)}: `)), records);
};

const checkRecords = async () => {
  await play();
  const names = await evaluate('Evo.tasks.map(({ name }) => name)');
  const wrong = [];
  for (const name of names) {
    const { earned, fitness } = await evaluate(`(async () => {
      const record = Evo.tasks.find(({ name }) => name === '${name}');
      await Evo.loadScript('records/${name}.js');
      const policy = Evo.controllers['${name}'];
      const player = Evo.evo.open(policy.task_yaml, policy.robot);
      player.control(policy);
      player.reset({ seed: record.seed ?? 0 });
      player.step(1e6);
      const earned = player.counts().total;
      player.close();
      return { earned, fitness: record.fitness };
    })()`);
    if (earned !== fitness) wrong.push([name, earned, fitness]);
  }
  check(`all ${names.length} records earn their returns, bit for bit`, names.length >= 32 && wrong.length === 0, wrong);
};

// Text against what is behind it, names of what can be pressed, ids, headings; with EVO_AXE, a
// path of axe.min.js, whatever that finds.
const checkPage = async (page, theme, width) => {
  await emulate({ scheme: theme, width, height: width < 600 ? 844 : 900 });
  await browser.open(`${home}${page}`);
  if (page === 'play.html') await until(`document.documentElement.dataset.ready`, 30);
  const what = `${page}, ${theme}, ${width} pixels`;
  await checkAccess(evaluate, what, { width, first: 1 });
  await photograph(`${page.replace(/\W/g, '-')}-${theme}-${width}`, false);
  if (!process.env.EVO_AXE) return;
  await evaluate(readFileSync(process.env.EVO_AXE, 'utf8') + ';0');
  const found = await evaluate(`axe.run({ preload: false }).then(({ violations }) => violations.map(({ id, nodes }) => [id, nodes[0].html.slice(0, 120)]))`);
  check(`axe-core finds nothing, ${what}`, found.length === 0, found);
};

const checkCalm = async () => {
  await emulate({ calm: true });
  await play();
  await new Promise((done) => setTimeout(done, 500));
  check('who wants less motion gets a robot at rest', (await text('#moment')).startsWith('step 0 ') && (await text('#play')) === 'Play', await text('#moment'));
  await emulate();
};

try {
  await emulate();
  await checkFirst();
  await photograph('play', false);
  await checkKeyboard();
  await checkTouch();
  await checkUndo();
  await checkCamera();
  await checkLink();
  await checkTasks();
  await checkOwn();
  await checkFiles();
  if (process.env.EVO_FILES) await checkPolicies();
  await checkEvolve();
  await checkGallery();
  checkPages();
  await checkRecords();
  await checkCalm();
  for (const page of ['index.html', 'play.html', 'records/Climber-v0.html', 'README.html', 'docs/physics.html'])
    for (const theme of ['light', 'dark'])
      for (const width of [1280, 390]) await checkPage(page, theme, width);
  check('nothing is complained of on the console', browser.complaints.length === 0, browser.complaints.slice(0, 4));
  check('nothing is asked of a network', browser.requests.every((url) => /^(file|blob|about|data):/.test(url)), browser.requests.filter((url) => !url.startsWith('file:')).slice(0, 4));
} catch (failure) {
  check('the test goes to its end', false, failure.stack);
} finally {
  await browser.close();
}
finish();

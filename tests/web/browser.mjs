// browser.mjs BROWSER SITE PROFILE [PICTURES]: the site as a user meets it, from disk and
// without a network. Says what fails; status 1 then. With a folder for PICTURES, the pages are
// left there as they look on a desk, on a phone, in the dark, and printed.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { accessFaults, launch } from '../browser/driver.mjs';

const [program, site, profile, pictures] = process.argv.slice(2);
const browser = await launch(program, profile, { offline: true });
const { evaluate, until, emulate, click, press, swipe } = browser;
const home = pathToFileURL(`${site}/index.html`).href;
const open = async (hash) => {
  await browser.open(home + hash);
  await until(`document.documentElement.dataset.ready`, 30);
};
const photograph = (name, whole) => pictures && browser.picture(`${pictures}/${name}.png`, whole);
const text = (selector) => evaluate(`document.querySelector(${JSON.stringify(selector)}).textContent`);

let failed = 0;
const check = (what, good, found = '') => {
  console.log(`${good ? 'ok' : 'NOT OK'}: ${what}${good ? '' : `; found ${JSON.stringify(found)}`}`);
  failed += good ? 0 : 1;
};
const stepped = `Number(document.getElementById('moment').textContent.match(/step (\\d+)/)?.[1]) > 3`;
const body = () => evaluate(`[...document.querySelectorAll('#grid > div')].map((row) => [...row.children].map((cell) => cell.className.replace('block-', '').replace('none', '.')).join('')).join('-')`);

const checkFirst = async () => {
  const began = Date.now();
  await open('');
  check('the first robot moves', await until(stepped, 30), await text('#moment'));
  console.log(`    ${Date.now() - began} ms from opening to motion`);
  const sizes = await evaluate(`performance.getEntriesByType('resource').map((each) => each.name)`);
  check('it needs nothing but this folder', sizes.every((url) => url.startsWith(home.slice(0, home.lastIndexOf('/')))), sizes);
};

const checkKeyboard = async () => {
  await open('#play?task=Walker-v0&body=...-...-...&gait=0.5,20,0.7');
  await evaluate(`(() => { document.querySelector('#rows').value = 3; document.querySelector('#columns').value = 3; document.querySelector('#rows').dispatchEvent(new Event('change')); document.querySelector('#grid [tabindex="0"]').focus(); })()`);
  await press('Home');
  for (const [r, row] of ['HHH', 'VSV', 'V.V'].entries()) {
    for (const [c, letter] of [...row].entries()) {
      await press(letter.toLowerCase(), letter.toLowerCase());
      if (c < 2) await press(r % 2 ? 'ArrowRight' : 'ArrowRight');
    }
    await press('ArrowDown'); await press('ArrowLeft'); await press('ArrowLeft');
  }
  check('a body is drawn with the keyboard', (await body()) === 'HHH-VSV-V.V', await body());
  await evaluate(`document.querySelector('#play').focus()`);
  if ((await text('#play')) === 'Play') await press('Enter', '\r');
  check('and it walks', await until(stepped), await text('#moment'));
  check('without a complaint', (await text('#message')) === '', await text('#message'));
};

const checkTouch = async () => {
  await emulate({ width: 390, height: 844 });
  await open('#play?task=Walker-v0&body=HH.-H..-...&gait=0.5,20,0.7');
  const at = (r, c) => `#grid [data-r="${r}"][data-c="${c}"]`;
  await click('.materials .block-V');
  await swipe([at(1, 0), at(2, 0)]);
  await click('.materials .block-H');
  await swipe([at(1, 1), at(1, 2), at(2, 2)]);
  check('a body is drawn with a finger', (await body()) === 'HH.-VHH-V.H', await body());
  check('and it walks', await until(stepped), await text('#moment'));
  const wide = await evaluate('document.documentElement.scrollWidth');
  check('nothing is wider than a phone', wide <= 390, wide);
  await photograph('play-phone');
  await emulate();
};

const checkLink = async () => {
  await open('#play?task=Jumper-v0&body=VVV-HHH-V.V&gait=0.31,17.5,1.25');
  check('a link restores the task', (await evaluate(`document.getElementById('task').value`)) === 'Jumper-v0');
  check('and the body', (await body()) === 'VVV-HHH-V.V', await body());
  check('and the rhythm', (await text('#command')).includes('--actions sine:0.31,17.5,1.25'), await text('#command'));
  check('and is its own address', (await evaluate('location.hash')) === '#play?task=Jumper-v0&body=VVV-HHH-V.V&gait=0.31,17.5,1.25', await evaluate('location.hash'));
  const other = await evaluate(`Evo.records.find(({ controller }) => controller === 'modular')?.name`);
  await open(`#play?record=${other}&body=HVH-V.V`);
  check('a link gives a modular record another body', await until(`document.getElementById('gait-about').textContent.startsWith('Driven by the modular policy of the record ${other}')`) && (await body()) === 'HVH-V.V' && await until(stepped), await body());
  check('and stays', (await evaluate('location.hash')) === `#play?record=${other}&body=HVH-V.V`, await evaluate('location.hash'));
  await open(`#play?record=${other}&body=HXH`);
  check('a body that is none leaves it its own', await until(`document.getElementById('message').textContent.startsWith('The body in this address is none')`) && (await evaluate('location.hash')) === `#play?record=${other}`, [await text('#message'), await evaluate('location.hash')]);
  await open('#play?task=Walkr-v0&body=HH&gait=0.5,20,0.7');
  check('a link to no task says so in the words of the tools', (await text('#message')).includes("unknown task 'Walkr-v0' (did you mean 'Walker-v0'?)"), await text('#message'));
};

const checkTasks = async () => {
  const names = await evaluate('Evo.taskNames');
  check('there are 32 tasks', names.length === 32, names.length);
  const still = [];
  await evaluate(`document.getElementById('speed').value = 1`);
  for (const name of names) {
    await evaluate(`location.hash = '#play?task=${name}&body=RHHHR-VSSSV-VHRHV-V...V-V...V&gait=0.5,20,0.7'`);
    const moved = await until(`Evo.page === 'play' && document.getElementById('task').value === '${name}' && ${stepped}`);
    if (!moved || (await text('#message')) !== '') still.push([name, await text('#message'), await text('#moment')]);
  }
  check('each loads and steps', still.length === 0, still);
  await open('#tasks');
  await until(`document.querySelectorAll('#tasks article').length === 32`);
  const poor = await evaluate(`[...document.querySelectorAll('#tasks article')].filter((it) => it.querySelectorAll('li').length < 3 || !it.querySelector('code').textContent.includes('evo/task')).map((it) => it.id)`);
  check('each is told', poor.length === 0, poor);
  await photograph('tasks');
};

const checkOwn = async () => {
  await open('');
  const use = async (text) => {
    await evaluate(`(() => { document.getElementById('own').open = true; document.getElementById('own-text').value = ${JSON.stringify(text)}; document.getElementById('own-use').click(); })()`);
  };
  await use('format: evo/task\nversion: 1\nname: slope\nsteps: 50\nrobot: {at: [1, 1]}\nworld:\n  objects:\n    ground: {at: [0, 0], size: [30, 1], fill: "#"}\nobservation: [velocity: robot]\nreward: [displacement: {of: robot, axis: x}]\n');
  check('a task of one\'s own is taken', (await text('#message')) === '' && (await until(`document.getElementById('moment').textContent.includes('of 50')`)), await text('#message'));
  check('and its link carries it', (await evaluate('location.hash')).startsWith('#play?own=format'), await evaluate('location.hash'));
  await use('format: evo/task\nversion: 1\nname: slope\nsteps: 50\nrobot: {at: [1, 1]}\nworld: {objekts: {}}\n');
  check('a mistake is told as the tools tell it', (await text('#message')).endsWith("task:6:9: world: unknown key 'objekts' (did you mean 'objects'?); allowed: file, drawing, legend, objects"), await text('#message'));
  await use(JSON.stringify({ grid_width: 20, grid_height: 6, objects: { ground: { indices: [...Array(20).keys()], types: Array(20).fill(5), neighbors: Object.fromEntries([...Array(20).keys()].map((k) => [k, [k - 1, k + 1].filter((n) => n >= 0 && n < 20)])) } } }));
  check('so is a world of the design tool', (await text('#message')) === '', await text('#message'));
};

// What the page reads from a file, dropped or opened.
const checkFiles = async () => {
  await open('');
  const drop = (name, content) => evaluate(`(() => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([${JSON.stringify(content)}], ${JSON.stringify(name)}));
    dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, cancelable: true }));
  })()`);
  await drop('robot.json', JSON.stringify({ body: ['HVH', 'V.V'], task: 'UpStepper-v0' }));
  check('a dropped robot is taken', (await until(`document.getElementById('task').value === 'UpStepper-v0'`)) && (await body()) === 'HVH-V.V', await body());
  await drop('bad.json', '{"body": ["RR", "RR"]}');
  check('a robot without muscles is refused in the words of the tools', await until(`document.getElementById('message').textContent.includes('there is no actuator (H or V), nothing can move this robot')`), await text('#message'));
  const record = readFileSync(`${site}/records/Walker-v0.js`, 'utf8').replace(/^[^=]*= /, '').replace(/^'use strict';\nEvo.controllers[^=]*= /, '').replace(/;\n$/, '');
  await drop('policy.json', record.slice(record.indexOf('{"format"')));
  check('a dropped policy in JSON drives its robot', await until(`document.getElementById('gait-about').textContent.includes('network of policy.json')`), await text('#gait-about'));
};

// Policies that the tools wrote.
const checkPolicies = async () => {
  const folder = process.env.EVO_FILES;
  const drop = async (name, page = '') => {
    await open(page);
    const content = readFileSync(`${folder}/${name}`).toString('base64');
    await evaluate(`(() => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([Uint8Array.from(atob('${content}'), (c) => c.charCodeAt(0))], '${name}'));
      dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, cancelable: true }));
    })()`);
  };
  const about = () => text('#gait-about');
  const earned = async (expected) => {
    await evaluate(`(document.getElementById('speed').value = 10, document.getElementById('speed').dispatchEvent(new Event('change')))`);
    return await until(`document.getElementById('moment').textContent.includes('over')`, 60) && (await text('#return')) === (await evaluate(`Evo.number(${expected})`));
  };
  await drop('policy.json', '#records');
  check('a policy dropped on another page opens in Play', await until(`Evo.page === 'play' && document.getElementById('gait-about').textContent.startsWith('Driven by the network of policy.json')`), await about());
  check('and moves', await until(stepped), await text('#moment'));
  await drop('modular.json');
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
  await drop('policy.h5');
  check('a file in HDF5 is answered with the way', await until(`document.getElementById('message').textContent.endsWith('evo-convert policy.h5 --to json -o policy.json')`), await text('#message'));
  await drop('cut.json');
  check('a damaged file is refused', await until(`document.getElementById('message').textContent.startsWith('cut.json: ')`), await text('#message'));
  check('and the robot from before is there', await until(stepped), await text('#moment'));
};

const checkEvolve = async () => {
  await open('#play?task=Walker-v0&body=RHHHR-VSSSV-VHRHV-V...V-V...V&gait=0.5,20,0.7');
  await click('#evolve');
  check('it evolves a better robot', await until(`/from −[0-9.]+ to [0-9]/.test(document.getElementById('evolve-says').textContent)`, 40), await text('#evolve-says'));
  check('which is the one on the stage', !(await evaluate('location.hash')).includes('gait=0.5,20,0.7'), await evaluate('location.hash'));
  await click('#evolve');
  check('and stops when told', (await text('#evolve-says')).includes('Stopped'), await text('#evolve-says'));
  await photograph('evolved');
};

const checkRecords = async () => {
  await open('#records');
  await until(`document.querySelectorAll('#records article').length > 0`);
  const names = await evaluate('Evo.records.map(({ name }) => name)');
  check('a card for each record', (await evaluate(`document.querySelectorAll('#records article').length`)) === names.length);
  check('those in view play', await until(`document.querySelector('#records article button').textContent === 'Pause' && /now/.test(document.querySelector('#records article td').textContent)`, 20), await text('#records article td'));
  await photograph('records', false);
  // The same that the cards do, at once and not in the time of the screen.
  const wrong = [];
  for (const name of names) {
    const { earned, fitness } = await evaluate(`(async () => {
      const record = Evo.records.find(({ name }) => name === '${name}');
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

// Text against what is behind it, names of what can be pressed, ids, and the tab key.
const checkAccess = async (hash, theme) => {
  await open(hash);
  await until(`document.querySelectorAll('main > section:not([hidden]) h1').length === 1`);
  const { pale, nameless, twice } = await accessFaults(evaluate);
  check(`text can be read (4.5 to 1), ${hash}, ${theme}`, pale.length === 0, pale);
  check(`what can be pressed or seen has a name, ${hash}`, nameless.length === 0, nameless);
  check(`no id is there twice, ${hash}`, twice.length === 0, twice);
  const headings = await evaluate(`[...document.querySelectorAll('main > section:not([hidden]) :is(h1, h2, h3)')].map((it) => Number(it.tagName[1]))`);
  check(`headings go down by one, ${hash}`, headings[0] === 1 && headings.every((level, k) => k === 0 || level <= headings[k - 1] + 1), headings);
};

const checkCalm = async () => {
  await emulate({ calm: true });
  await open('');
  await new Promise((done) => setTimeout(done, 500));
  check('who wants less motion gets a robot at rest', (await text('#moment')).startsWith('step 0 ') && (await text('#play')) === 'Play', await text('#moment'));
  await emulate();
};

try {
  await emulate();
  await checkFirst();
  await photograph('play');
  await checkKeyboard();
  await checkTouch();
  await checkLink();
  await checkTasks();
  await checkOwn();
  await checkFiles();
  if (process.env.EVO_FILES) await checkPolicies();
  await checkEvolve();
  await checkRecords();
  await checkCalm();
  for (const scheme of ['light', 'dark']) {
    await emulate({ scheme });
    for (const hash of ['#play', '#records', '#tasks']) await checkAccess(hash, scheme);
  }
  await open('');
  await photograph('play-dark');
  await emulate({ media: 'print' });
  await photograph('play-print');
  check('nothing is complained of on the console', browser.complaints.length === 0, browser.complaints.slice(0, 4));
  check('nothing is asked of a network', browser.requests.every((url) => /^(file|blob|about|data):/.test(url)), browser.requests.filter((url) => !url.startsWith('file:')).slice(0, 4));
} catch (failure) {
  check('the test goes to its end', false, failure.stack);
} finally {
  await browser.close();
}
process.exit(failed ? 1 : 0);

// module.mjs ROOT BUILD CASES: the WebAssembly build against the tools, bit for bit (CASES is
// what tests/web/cases wrote). Says what differs; status 1 then.
import { readFileSync } from 'node:fs';
import { isDeepStrictEqual } from 'node:util';
import { dataFiles, loadScripts, read } from './native.mjs';

const [root, build, cases] = process.argv.slice(2);
loadScripts(root);
const lines = (path) => readFileSync(path, 'utf8').trim().split('\n');
const bytes = (name) => readFileSync(`${build}/bindings/web/${name}.wasm`);
const files = dataFiles(root);
const slow = Boolean(process.env.EVO_SLOW);

let failed = 0;
const check = (what, found, expected) => {
  if (found === expected) return;
  console.log(`NOT OK: ${what}: ${found}, expected ${expected}`);
  ++failed;
};

const asked = WebAssembly.Module.imports(new WebAssembly.Module(bytes('player'))).map(({ module, name }) => `${module} ${name}`);
const allowed = ['env __syscall_stat64', 'env emscripten_notify_memory_growth', 'env evo_page_read_yaml',
  'wasi_snapshot_preview1 environ_get', 'wasi_snapshot_preview1 environ_sizes_get', 'wasi_snapshot_preview1 proc_exit'];
check('what the module asks of a page', asked.sort().join(', '), allowed.join(', '));

const pinned = await Evo.start(bytes('pinned'), files);
const table = lines(`${root}/tests/data/pinned/trajectories.tsv`).slice(1).map((line) => line.split('\t'));
for (const [task, quick, whole] of table) {
  const found = pinned.ask('evo_pinned', task, slow ? 500 : 100);
  check(`${task}: hash of positions, velocities, observations and rewards`, found[0], quick);
  if (slow) check(`${task}: hash after 500 steps`, found[1], whole);
}
console.log(`${table.length} tasks: the pinned hashes`);

const evo = await Evo.load(bytes('player'), files);
let steps = 0, spent = 0;
const played = {};
for (const line of lines(`${cases}/cases.jsonl`)) {
  const { name, task, robot, controller, seed, draws, return: expected } = JSON.parse(line);
  try {
    if (name.startsWith('random')) check(`${name}: its id`, evo.robot(JSON.stringify(robot)).id, name.split(' ')[1]);
    const player = evo.open(task, robot);
    player.control(controller);
    player.reset({ seed, draws });
    const began = performance.now();
    player.step(1e6);
    spent += performance.now() - began;
    const { total, steps: taken, rules, terms, ended, folding } = player.counts();
    steps += taken;
    check(name, total, expected);
    const parts = terms.reduce((sum, term) => sum + term, rules + folding);
    check(`${name}: its parts add up`, Math.abs(parts - total) < 1e-9, true);
    check(`${name}: it ends`, ended > 0, true);
    player.close();
  } catch (failure) {
    check(name, failure.message, expected);
  }
  const kind = name.split(' ')[0];
  played[kind] = (played[kind] ?? 0) + 1;
}
console.log(Object.entries(played).map(([kind, count]) => `${kind}: ${count}`).join(', '));
console.log(`${steps} control steps in ${Math.round(spent)} ms: ${Math.round(1000 * steps / spent)} a second`);
check('records were played', played.record >= 6 && played.reference === 64 && played.random >= 100 && played.trained === 4, true);

// The page's own reader of HDF5.
const found = { policy: 0, rollout: 0 };
for (const line of lines(`${cases}/hdf5.jsonl`)) {
  const { path, ...expected } = JSON.parse(line);
  const bytes = new Uint8Array(readFileSync(path));
  try {
    const opened = await Evo.openHdf5(bytes);
    if (expected.policy) {
      check(`${path}: as evo-convert has it`, isDeepStrictEqual(opened.policy, expected.policy), true);
      ++found.policy;
      continue;
    }
    const { rollout } = opened, { episodes, names, cells, ...facts } = expected.rollout;
    for (const [name, value] of Object.entries(facts)) check(`${path}: ${name}`, isDeepStrictEqual(rollout[name], value), true);
    check(`${path}: objects`, rollout.world.objects.map(({ name }) => name).join(), names.join());
    check(`${path}: cells`, isDeepStrictEqual(rollout.world.cells.map((cell) => cell.slice(2)), cells), true);
    check(`${path}: episodes`, rollout.episodes, episodes.length);
    for (const [k, episode] of episodes.entries()) {
      const read = await rollout.episode(k);
      for (const name of ['seed', 'draws', 'rewards', 'actions']) check(`${path}: ${name} of episode ${k}`, isDeepStrictEqual(read[name], episode[name]), true);
      check(`${path}: positions of episode ${k}`, isDeepStrictEqual(Array.from(read.positions), episode.positions), true);
    }
    ++found.rollout;
  } catch (failure) {
    check(path, failure.stack, 'a policy or rollout');
  }
}
check('files in HDF5 were read', found.policy >= 8 && found.rollout === 5, true);
console.log(`HDF5: ${found.policy} policies, ${found.rollout} rollouts`);

// A damaged file is refused, or read with other numbers, and never anything else.
{
  const whole = ['eight', 'modular'].map((name) => new Uint8Array(readFileSync(`${cases}/${name}.h5`)));
  let seed = 1, refused = 0;
  const random = (below) => { seed = (Math.imul(seed, 1103515245) + 12345) >>> 0; return Math.floor(seed / 2 ** 32 * below); };
  for (let k = 0; k < (slow ? 4000 : 600); ++k) {
    const bytes = whole[k % 2];
    const damaged = k % 3 ? bytes.slice() : bytes.slice(0, random(bytes.length));
    if (k % 3) for (let n = 0; n < 1 + k % 8; ++n) damaged[random(k % 5 < 2 ? 4096 : damaged.length)] = random(256);
    try {
      const { rollout } = await Evo.openHdf5(damaged);
      await rollout?.episode(0);
    } catch (failure) {
      if (failure.name === 'Refusal') ++refused;
      else check(`damage ${k}`, failure.stack, 'a refusal');
    }
  }
  check('damaged files were refused', refused > 200, true);
  console.log(`${refused} damaged files refused`);
}

for (const line of lines(`${cases}/refused.jsonl`)) {
  const { what, text, error } = JSON.parse(line);
  let said = 'nothing';
  try { evo[what](text); } catch (failure) { said = failure.message; }
  check(`a refused ${what}`, said, error);
}
process.exit(failed ? 1 : 0);

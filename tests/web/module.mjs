// module.mjs ROOT BUILD CASES: the WebAssembly build against the tools, bit for bit (CASES is
// what tests/web/cases wrote). Says what differs; status 1 then.
import { readFileSync } from 'node:fs';
import { dataFiles, loadScripts } from '../../bindings/web/native.mjs';

const [root, build, cases] = process.argv.slice(2);
loadScripts(root);
const lines = (path) => readFileSync(path, 'utf8').trim().split('\n');
const bytes = readFileSync(`${build}/bindings/web/player.wasm`);

let failed = 0;
const check = (what, found, expected) => {
  if (found === expected) return;
  console.log(`NOT OK: ${what}: ${found}, expected ${expected}`);
  ++failed;
};

const asked = WebAssembly.Module.imports(new WebAssembly.Module(bytes)).map(({ module, name }) => `${module} ${name}`);
const allowed = ['env __syscall_stat64', 'env emscripten_notify_memory_growth', 'env evo_page_read_yaml',
  'wasi_snapshot_preview1 environ_get', 'wasi_snapshot_preview1 environ_sizes_get', 'wasi_snapshot_preview1 proc_exit'];
check('what the module asks of a page', asked.sort().join(', '), allowed.join(', '));

const evo = await Evo.load(bytes, dataFiles(root));
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
check('records were played', played.record === 32 && played.reference === 64 && played.random >= 100 && played.trained === 4, true);

for (const line of lines(`${cases}/refused.jsonl`)) {
  const { what, text, error } = JSON.parse(line);
  let said = 'nothing';
  try { evo[what](text); } catch (failure) { said = failure.message; }
  check(`a refused ${what}`, said, error);
}
process.exit(failed ? 1 : 0);

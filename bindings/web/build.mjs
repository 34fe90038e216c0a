// build.mjs ROOT MODULE POLICIES OUT: the site from its sources (bindings/web/site), the module
// (player.wasm), tasks, and records (POLICIES has each policy as NAME.json).
import { copyFileSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const [root, module, policies, out, version] = process.argv.slice(2);
const read = (path) => readFileSync(`${root}/${path}`, 'utf8');
const site = (name) => read(`bindings/web/site/${name}`);
const yaml = readFileSync('/usr/share/nodejs/js-yaml/dist/js-yaml.min.js', 'utf8');
mkdirSync(`${out}/records`, { recursive: true });

const policy = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data:; worker-src blob:; base-uri 'none'; form-action 'none'";
const folder = (path) => readdirSync(`${root}/${path}`).filter((name) => name.endsWith('.yaml')).map((name) => `${path}/${name}`);
const files = Object.fromEntries([...folder('tasks'), ...folder('tasks/physics')].map((path) => [path, read(path)]));
const isTask = (text) => /^format: *evo\/task$/m.test(text);
const taskNames = folder('tasks').filter((path) => isTask(files[path])).map((path) => path.slice('tasks/'.length, -'.yaml'.length));

const [header, ...rows] = read('records/published.tsv').split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split('\t'));
const published = Object.fromEntries(rows.map((row) => [row[0], Object.fromEntries(header.map((name, k) => [name, row[k]]).slice(1).filter(([, value]) => value))]));
const records = readdirSync(`${root}/records`, { withFileTypes: true }).filter((entry) => entry.isDirectory()).map(({ name }) => {
  const { task, robot, fitness, seed, shifted, command, robots, steps, sequence } = JSON.parse(read(`records/${name}/record.json`));
  return { name, task, controller: JSON.parse(readFileSync(`${policies}/${name}.json`, 'utf8')).kind, robot, fitness, seed, shifted, command, robots, steps, can: sequence?.fitness };
});
for (const { name } of records) {
  const { kind, task, task_yaml, robot, normalizer, action, actor, clock, gait, sequence, sine, actions } = JSON.parse(readFileSync(`${policies}/${name}.json`, 'utf8'));
  const document = { format: 'evo/policy', version: 1, kind, task, task_yaml, robot, normalizer, action, actor, clock, gait, sequence, sine, actions };
  writeFileSync(`${out}/records/${name}.js`, `'use strict';\nEvo.controllers[${JSON.stringify(name)}] = ${JSON.stringify(document)};\n`);
  copyFileSync(`${root}/records/${name}/policy.h5`, `${out}/records/${name}.policy.h5`);
}

const workerSource = [yaml, site('yaml.js'), site('module.js'), site('evolve.js')].join('\n');
const assignments = (values) => `'use strict';\nglobalThis.Evo ??= {};\n` + Object.entries(values).map(([name, value]) => `Evo.${name} = ${JSON.stringify(value)};\n`).join('');
writeFileSync(`${out}/data.js`, assignments({ files, taskNames, records, published, firstRobot: JSON.parse(site('first-robot.json')), workerSource,
  packedModule: gzipSync(readFileSync(module), { level: 9 }).toString('base64') }));
writeFileSync(`${out}/js-yaml.js`, yaml);
const scripts = ['js-yaml.js', 'data.js', 'yaml.js', 'module.js', 'stage.js', 'player.js', 'common.js', 'play.js', 'records.js', 'tasks.js', 'main.js'];
for (const name of scripts.slice(2)) writeFileSync(`${out}/${name}`, site(name));
writeFileSync(`${out}/site.css`, site('site.css'));
writeFileSync(`${out}/index.html`, site('index.html').replace('{{policy}}', policy).replace('{{version}}', version)
  .replace('{{scripts}}', scripts.map((name) => `<script src="${name}" defer></script>`).join('\n')));

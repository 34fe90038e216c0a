// build.mjs ROOT MODULE RECORDS OUT VERSION [URL]: the site from its sources (bindings/web/site),
// the module (player.wasm), tasks, documents and records: RECORDS has NAME.json, the policy, and
// NAME.svg and NAME.png, its loop and a picture. URL: where the site will stand, for the pictures of previews.
import { copyFileSync, existsSync, mkdirSync, readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join, normalize, relative } from 'node:path/posix';
import { gzipSync } from 'node:zlib';
import { marked } from '/usr/share/nodejs/marked/lib/marked.esm.js';
import { dataFiles, loadScripts, read as readFrom, scripts as libraries } from './native.mjs';

const [root, module, made, out, version, url = ''] = process.argv.slice(2);
const read = (path) => readFrom(root, path);
const site = (name) => read(`bindings/web/site/${name}`);
const write = (path, text) => { mkdirSync(dirname(`${out}/${path}`), { recursive: true }); writeFileSync(`${out}/${path}`, text); };
const copy = (from, path) => { mkdirSync(dirname(`${out}/${path}`), { recursive: true }); copyFileSync(from, `${out}/${path}`); };
const plain = (text) => String(text).replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/"/g, '&quot;');
const number = (value, digits = 2) => Number(value).toFixed(digits).replace(/^-(?=.*[1-9])/, '−').replace('-', '');
const signed = (value) => (value >= 0 ? '+' : '−') + Math.abs(value);

// ---- what there is to show ------------------------------------------------------------------

loadScripts(root);
const files = dataFiles(root);
const evo = await globalThis.Evo.load(readFileSync(module), files);
const [header, ...rows] = read('records/published.tsv').split('\n').filter((line) => line && !line.startsWith('#')).map((line) => line.split('\t'));
// Every task in the order of the paper, its record, and what was published.
const entries = rows.map((row) => {
  const published = Object.fromEntries(header.map((name, k) => [name, row[k]]));
  const name = published.task;
  const { kind, task, task_yaml, robot, normalizer, action, actor, clock, gait, sequence, sine, actions } = JSON.parse(readFileSync(`${made}/${name}.json`, 'utf8'));
  return { name, facts: evo.task(name), published, record: JSON.parse(read(`records/${name}/record.json`)),
    policy: { format: 'evo/policy', version: 1, kind, task, task_yaml, robot, normalizer, action, actor, clock, gait, sequence, sine, actions } };
});

// ---- pages ------------------------------------------------------------------------------------

const page = (path, { title, description, main, image = 'records/Walker-v0.png', current = path, scripts = [] }) => {
  const up = '../'.repeat(path.split('/').length - 1);
  const values = { up, title: plain(title), description: plain(description), main, image: (url ? `${url.replace(/\/$/, '')}/` : up) + image, version,
    scripts: scripts.map((name) => `<script src="${name}" defer></script>`).join('\n') };
  write(path, site('page.html').replace(/\{\{(\w+)\}\}/g, (_, name) => values[name])
    .replace(`<a href="${up}${current}"`, '$& aria-current="page"'));
};
const picture = (name, path, attributes = '') => `<picture><source media="(prefers-reduced-motion: reduce)" srcset="${path}${name}.png">` +
  `<img src="${path}${name}.svg" width="480" height="300" alt="The record of ${name}"${attributes}></picture>`;

// The record's return as a bar, the paper's as a mark.
const bar = (value, paper) => {
  const low = Math.min(0, value, paper), wide = Math.max(0, value, paper) - low, at = (each) => (100 * (each - low) / wide).toFixed(1);
  return `<svg class="bar" viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true"><rect width="100" height="6"/>` +
    `<rect class="value" width="${at(value)}" height="6"/>` +
    `<rect class="mark" x="${Math.min(99, Math.max(0, at(paper) - 0.5))}" width="1" height="6"/></svg>`;
};
const card = ({ name, facts, record, published: { paper } }, k) =>
  `<article class="card" data-name="${name.toLowerCase()}" data-difficulty="${facts.difficulty}" data-order="${k}" data-lead="${(record.fitness - paper) / Math.abs(paper)}">
<a href="records/${name}.html">${picture(name, 'records/', k < 8 ? '' : ' loading="lazy"')}<h2>${name.replace(/(?<=[a-z])(?=[A-Z])/g, '<wbr>')}</h2></a>
<p><b>${number(record.fitness)}</b> paper ${number(paper)} <small>${facts.difficulty}</small></p>${bar(record.fitness, Number(paper))}</article>`;
page('index.html', { title: 'evo: soft robots, drawn and evolved', description: 'A wall of soft robots at the 32 tasks of Evolution Gym. Draw one of your own, let it evolve, beat the record.',
  main: site('index.html').replace('{{cards}}', entries.map(card).join('\n')), scripts: ['gallery.js'] });

const scripts = ['js-yaml.js', 'data.js', 'yaml.js', 'module.js', 'stage.js', 'player.js', 'common.js', 'play.js', 'main.js'];
page('play.html', { title: 'Draw a soft robot · evo', description: 'Draw a soft robot, watch it at any of 32 tasks, let it evolve, beat the record. All of it is simulated in the page.',
  main: site('play.html'), scripts });

const list = (items) => `<ul>${items.map((item) => `<li>${plain(item)}</li>`).join('')}</ul>`;
const commands = ({ command, robot, robots, steps, core_minutes, date, tools, failure, note }, title) => `<h2>${title}</h2>
<pre class="command" tabindex="0" aria-label="Commands"><code>${plain(command.replaceAll(' && ', '\n'))}</code></pre>
<p class="about">Robot ${robot} of ${robots}, ${number(steps / 1e6, 1)} million steps, ${core_minutes} core minutes, ${date}, ${tools}. ${
  plain(failure ? `Its episode ends in a failure, which costs 3: ${failure}. ` : '')}${plain(note ?? '')}</p>
`;
const row = (name, value, more = '') => `<tr><th scope="row">${name}</th><td>${value}${more && ` <small>${plain(more)}</small>`}</td></tr>`;
entries.forEach(({ name, facts, record, published: { paper, paper_method, paper_robots, few, few_method, few_robots }, policy }, k) => {
  const { shifted, sequence, fitness } = record;
  const [before, after] = [entries[k - 1], entries[k + 1]].map((each) => each?.name);
  const paid = facts.reward.map(({ words, formula, weight, when }) => `${words} (${weight === 1 ? '' : `${weight} × `}${formula}${when && `, when ${when}`})`.replace('(-', '(−'));
  const ends = [...facts.rules.map(({ when, reward, ends: over }) => `${when}: ${signed(reward)}${over ? '' : ', and it continues'}`),
    `folding onto itself: ${signed(facts.folding)}`, `after ${facts.steps} steps`];
  page(`records/${name}.html`, { title: `${name}: ${number(fitness)} · evo`, current: 'index.html', image: `records/${name}.png`,
    description: `${facts.description} The record earns ${number(fitness)}, the paper ${number(paper)}. Watch it, or draw a robot that beats it.`, main: `
<h1>${name} <small>${facts.difficulty}</small></h1>
<p class="lead">${plain(facts.description)}</p>
<div class="record"><div>${picture(name, '')}
<p class="row"><a class="button main" href="../play.html#task=${name}">Beat it</a><a class="button" href="../play.html#record=${name}">Watch the record</a><a class="button" href="${name}.policy.h5" download>Policy</a></p>
${bar(fitness, Number(paper))}<table>${row('return', `<b>${number(fitness, 3)}</b>`, policy.kind)}
${shifted ? row('from perturbed starts', `${number(shifted.mean, 3)} ± ${number(shifted.standard_error, 3)}`, 'every start coordinate moved by up to 0.0001 blocks') : ''}
${sequence ? row('a body can', number(sequence.fitness, 3), 'a sequence of actions, once') : ''}
${row('the paper', number(paper, 3), `${paper_method}, ${paper_robots} robots, mean over seeds`)}
${few ? row('later, few robots', number(few, 3), few_robots === 'shown' ? `${few_method}, its single robot` : `${few_method}, ${few_robots} robots`) : ''}</table></div>
<div><h2>Paid for</h2>${list(paid)}<h2>Ends</h2>${list(ends)}<h2>Senses</h2>${list(facts.observation)}${facts.notes.length ? `<h2>Unlike the paper</h2>${list(facts.notes)}` : ''}</div></div>
${commands(record, 'Commands that made the record')}${sequence ? commands(sequence, `What a body can: ${sequence.body.join(' ')}`) : ''}
<details><summary>The task as a file</summary><pre tabindex="0"><code>${plain(facts.yaml)}</code></pre></details>
<p class="row">${before ? `<a rel="prev" href="${before}.html">← ${before}</a>` : ''} ${after ? `<a rel="next" href="${after}.html">${after} →</a>` : ''}</p>` });
  write(`records/${name}.js`, `'use strict';\nEvo.controllers[${JSON.stringify(name)}] = ${JSON.stringify(policy)};\n`);
  for (const kind of ['svg', 'png']) copy(`${made}/${name}.${kind}`, `records/${name}.${kind}`);
  copy(`${root}/records/${name}/policy.h5`, `records/${name}.policy.h5`);
});

// ---- documents: README, docs, and all that they lead to -------------------------------------------------

const documents = new Map();  // by path in the repository
const leads = (html, from) => html.replace(/(href|src|srcset)="([^"#:]+)(#[^"]*)?"/g, (_, name, to, part = '') =>
  `${name}="${relative(dirname(from), document(normalize(join(dirname(from), to)).replace(/\/$/, '')))}${part}"`);
// Where a file of the repository is in the site; it is put there.
const document = (path) => {
  if (/^records\/[^/]*-v\d$/.test(path)) return `${path}.html`;
  const folder = statSync(`${root}/${path}`).isDirectory();
  if (folder && existsSync(`${root}/${path}/README.md`)) return document(`${path}/README.md`);
  if (!folder && !path.endsWith('.md')) { copy(`${root}/${path}`, path); return path; }
  const place = folder ? `${path}/index.html` : path.replace(/md$/, 'html');
  if (documents.has(place)) return place;
  documents.set(place, {});
  const text = folder ? `# ${path}\n\nThe files of this folder.\n\n${readdirSync(`${root}/${path}`).map((name) => `- [${name}](${name})\n`).join('')}` : read(path);
  const html = leads(marked(text), place).replaceAll('<th></th>', '<td></td>').replace(/<thead>\s*<tr>\s*(<td><\/td>\s*)+<\/tr>\s*<\/thead>/g, '')
    .replaceAll('<table>', '<div class="scroll" tabindex="0" role="group" aria-label="Table"><table>').replaceAll('</table>', '</table></div>')
    .replaceAll('<pre>', '<pre tabindex="0">');
  const words = (pattern) => html.match(pattern)?.[1].replace(/<[^>]*>|\n/g, ' ').replace(/&[^;]*;/g, "'").trim() ?? '';
  documents.set(place, { html, title: words(/<h1[^>]*>(.*?)<\/h1>/), description: words(/<p>(.*?)<\/p>/s).slice(0, 160) });
  return place;
};
for (const path of ['README.md', ...readdirSync(`${root}/docs`, { recursive: true }).filter((name) => name.endsWith('.md')).map((name) => `docs/${name}`)]) document(path);
const index = [...documents].filter(([path]) => /^(README|docs\/[^/]*)\.html$/.test(path)).sort(([a], [b]) => (a > b) - (a < b));
for (const [path, { html, title, description }] of documents)
  page(path, { title: `${title} · evo`, description, current: 'README.html', main: `<div class="document"><article>${html}</article><nav aria-label="Documents"><ul>${
    index.map(([to, { title: name }]) => `<li><a href="${relative(dirname(path), to)}"${to === path ? ' aria-current="true"' : ''}>${name}</a></li>`).join('')}</ul></nav></div>` });

// ---- what the page Play loads -------------------------------------------------------------------

const yaml = readFileSync(libraries[0], 'utf8');
const workerSource = [yaml, site('yaml.js'), site('module.js'), site('evolve.js')].join('\n');
const data = { files, workerSource, firstRobot: JSON.parse(site('first-robot.json')), packedModule: gzipSync(readFileSync(module), { level: 9 }).toString('base64'),
  tasks: entries.map(({ name, facts: { difficulty }, record: { fitness, seed }, published: { paper } }) => ({ name, difficulty, fitness, seed, paper: Number(paper) })) };
write('data.js', `'use strict';\nglobalThis.Evo ??= {};\n` + Object.entries(data).map(([name, value]) => `Evo.${name} = ${JSON.stringify(value)};\n`).join(''));
write('js-yaml.js', yaml);
for (const name of [...scripts.slice(2), 'gallery.js', 'site.css', 'icon.svg']) write(name, site(name));

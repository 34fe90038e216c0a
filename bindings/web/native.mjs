// What Node needs to run the module: for the site's pages and for tests.
import { readFileSync, readdirSync } from 'node:fs';
import vm from 'node:vm';

export const read = (root, path) => readFileSync(`${root}/${path}`, 'utf8');
export const scripts = ['/usr/share/nodejs/js-yaml/dist/js-yaml.min.js'];

// The files that tasks are found in.
export const dataFiles = (root) => Object.fromEntries(['tasks', 'tasks/physics'].flatMap((folder) =>
  readdirSync(`${root}/${folder}`).filter((name) => name.endsWith('.yaml')).map((name) => [`${folder}/${name}`, read(root, `${folder}/${name}`)])));

export const loadScripts = (root) => {
  for (const path of [...scripts, ...['yaml', 'module'].map((name) => `${root}/bindings/web/site/${name}.js`)])
    vm.runInThisContext(readFileSync(path, 'utf8'), { filename: path });
};

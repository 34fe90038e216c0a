// Small helpers of the page.
'use strict';
Evo.element = (name, attributes = {}, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
};
Evo.id = (name) => document.getElementById(name);
Evo.number = (value) => Number.isFinite(value) ? value.toFixed(3).replace(/^-(?=.*[1-9])/, '−').replace('-', '') : '–';
Evo.calm = matchMedia('(prefers-reduced-motion: reduce)');
// The module unpacked, for this page and for Workers.
Evo.moduleBytes = () => Evo.unpacked ??= (async () => {
  const packed = Uint8Array.from(atob(Evo.packedModule), (c) => c.charCodeAt(0));
  return new Uint8Array(await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer());
})();
// A script of this site; records come this way, as pages from disk may not read files.
Evo.loaded = {};
Evo.controllers = {};  // of records, by name
Evo.loadScript = (path) => Evo.loaded[path] ??= new Promise((done, failed) => {
  const script = Evo.element('script', { src: path });
  script.onload = done;
  script.onerror = () => failed(new Error(`${path}: cannot be loaded; the folder of this site is not complete`));
  document.head.append(script);
});
Evo.copy = async (button, text) => {
  const label = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = Evo.element('textarea', { class: 'hidden', 'aria-hidden': 'true' });
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');  // the clipboard of a page from disk
    area.remove();
  }
  button.textContent = 'Copied';
  setTimeout(() => { button.textContent = label; }, 1400);
};

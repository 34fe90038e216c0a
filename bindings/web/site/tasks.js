// Tasks: what each is, from its own file, in the words of evo-inspect.
'use strict';
Evo.tasksPage = (evo) => {
  const { element, id } = Evo;
  const sign = (value) => (value >= 0 ? '+' : '−') + Math.abs(value);
  const list = (items) => element('ul', { class: 'plain' }, ...items.map((item) => element('li', {}, item)));
  const drawWorld = (canvas, name) => {
    const player = evo.open(name, { body: Evo.fullBody });
    try {
      player.reset();
      const scene = Evo.Stage.sceneOf(player);
      const raw = player.positions(), x = [], y = [];
      for (let p = 0; p < player.points; ++p) { x.push(raw[2 * p] / player.voxel); y.push(raw[2 * p + 1] / player.voxel); }
      const low = Math.min(...y, ...scene.fixed.map(([, fy]) => fy)), high = Math.max(...y, ...scene.fixed.map(([, fy, , h]) => fy + h));
      const left = Math.min(...x, ...scene.fixed.map(([fx]) => fx)), right = Math.max(...x, ...scene.fixed.map(([fx, , w]) => fx + w));
      const width = canvas.clientWidth, height = canvas.clientHeight;
      const wide = right - left, tall = high - low;
      // A tall world is seen from its foot, a long one whole.
      const scale = Math.max(Math.min(width / (wide + 2), height / (tall + 3)), height / 34);
      const across = width / scale;
      Evo.Stage.paint(canvas, scene, x, y, { scale, left: across > wide ? left - (across - wide) / 2 : left - 1, low: Math.min(low, 0) - 1.6 }, Evo.Stage.look());
    } finally { player.close(); }
  };
  const card = ({ name }) => {
    const facts = evo.task(name);
    const canvas = element('canvas', { class: 'stage', role: 'img', 'aria-label': `The world of ${name}` });
    let drawn = false;
    Evo.whenSeen(canvas, () => { if (!drawn) { drawn = true; drawWorld(canvas, name); } });
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { if (drawn) drawWorld(canvas, name); });
    new ResizeObserver(() => { if (drawn && canvas.clientWidth) drawWorld(canvas, name); }).observe(canvas);
    const rewards = facts.reward.map(({ words, formula, weight, when }) => `${words} (${weight === 1 ? '' : `${weight} × `}${formula}${when ? `, when ${when}` : ''})`.replace('(-', '(−'));
    const ends = [...facts.rules.map(({ when, reward, ends: over }) => `${when}: ${sign(reward)}${over ? '' : ', and it goes on'}`), `folding onto itself: ${sign(facts.folding)}`, `after ${facts.steps} steps`];
    return element('article', { class: 'card', id: `task-${name}` }, canvas, element('div', {},
      element('h2', {}, name, ' ', element('small', {}, facts.difficulty)),
      element('p', {}, facts.description),
      element('details', {}, element('summary', {}, 'What is paid, sensed, and ends it'),
        element('p', {}, 'Paid for'), list(rewards),
        element('p', {}, 'Ends'), list(ends),
        element('p', {}, 'Senses'), list(facts.observation),
        ...(facts.notes.length ? [element('p', {}, 'Unlike the paper'), list(facts.notes)] : []),
        element('p', {}, 'The task as a file'), element('pre', { class: 'command', tabindex: 0, 'aria-label': `${name} as YAML` }, element('code', {}, facts.yaml))),
      element('div', { class: 'row' }, element('a', { href: `#play?task=${name}` }, 'Play this task'),
        ...Evo.records.filter((record) => record.task === name).slice(0, 1).map(() => element('a', { href: '#records' }, 'Its record')))));
  };
  let made = false;
  return { show: () => { if (!made) { made = true; id('tasks').append(...Evo.tasks.map(card)); } }, hide: () => {} };
};

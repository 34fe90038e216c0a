// Records: the best robot of each task, simulated as it comes into view.
'use strict';
Evo.controllers = {};
Evo.recordsPage = (evo) => {
  const { element, id, number } = Evo;
  const card = (record) => {
    const canvas = element('canvas', { class: 'stage', role: 'img', 'aria-label': `The record of ${record.task}` });
    const now = element('span', {}, '');
    const play = element('button', { type: 'button', 'aria-label': `Play the record of ${record.task}` }, 'Play');
    const published = Evo.published[record.task] ?? {};
    const row = (name, ...value) => element('tr', {}, element('th', { scope: 'row' }, name), element('td', {}, ...value));
    const { shifted } = record;
    const table = element('table', { class: 'facts' }, element('tbody', {},
      row('return', element('b', {}, number(record.fitness)), ' ', now),
      ...(shifted ? [row('from perturbed starts', `${number(shifted.mean)} ± ${number(shifted.standard_error)}`)] : []),
      ...(record.can ? [row('a body can', number(record.can), ' ', element('small', {}, 'a sequence of actions, once'))] : []),
      ...(published.paper ? [row('the paper', `${number(Number(published.paper))} `, element('small', {}, `${published.paper_method}, ${published.paper_robots} robots`))] : []),
      ...(published.few ? [row('later, few robots', `${published.few} `, element('small', {}, `${published.few_method}, ${published.few_robots} robots`))] : []),
      ...(record.robots ? [row('found with', `${record.robots} robots, ${number(record.steps / 1e6)} million steps`)] : [])));
    const made = element('article', { class: 'card', id: `record-${record.name}` }, canvas, element('div', {},
      element('h2', {}, record.task, ' ', element('small', {}, record.controller)), table,
      element('details', {}, element('summary', {}, 'Commands that made it'), element('pre', { class: 'command', tabindex: 0, 'aria-label': 'Commands' }, element('code', {}, record.command ?? ''))),
      element('div', { class: 'row' }, play, element('a', { href: `#play?record=${record.name}` }, 'Open in Play'),
        element('a', { href: `records/${record.name}.policy.h5`, download: '' }, 'Policy'))));
    let theatre = null, opening = null;
    const told = (it) => {
      play.textContent = it.playing ? 'Pause' : 'Play';
      const { total, ended } = it.player.counts();
      now.textContent = ended === 0 ? `now ${number(total)}` : total === record.fitness ? 'earned again, to the last bit' : `earned ${total}: not the same`;
      if (ended !== 0) made.dataset.earned = total;
    };
    const open = () => opening ??= (async () => {
      await Evo.loadScript(`records/${record.name}.js`);
      const policy = Evo.controllers[record.name];
      const player = evo.open(policy.task_yaml, policy.robot);
      player.control(policy);
      theatre = new Evo.Player(canvas, told);
      theatre.speed = 2;
      theatre.show(player, { seed: record.seed ?? 0 });
    })().catch((failure) => { now.textContent = failure.message; opening = null; throw failure; });
    play.addEventListener('click', async () => { await open(); if (theatre.playing) theatre.pause(); else theatre.play(); });
    let seen = false;
    Evo.whenSeen(canvas, async () => {
      seen = true;
      await open();
      if (seen && !Evo.calm.matches && Evo.page === 'records') theatre.play();
    }, () => { seen = false; theatre?.pause(); });
    return made;
  };
  let made = false;
  return {
    show: () => {
      if (made) return;
      made = true;
      const order = Evo.tasks.map(({ name }) => name);
      const best = [...Evo.records].sort((a, b) => order.indexOf(a.task) - order.indexOf(b.task) || b.fitness - a.fitness);
      id('records').append(...best.map(card));
    },
    hide: () => {},
  };
};

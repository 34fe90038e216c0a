// What moves on the page: the cards of robots, replays, tables that can be sorted.
'use strict';
(() => {
  const { attach, bodies, symbol, spark, element, number, thumbnail } = Charts;
  const page = JSON.parse(document.getElementById('data').textContent);

  // What can be told from the others of a run.
  for (const run of Object.values(page.runs)) {
    for (const robot of Object.values(run.robots)) robot.children = [];
    for (const [id, robot] of Object.entries(run.robots)) for (const parent of robot.parents) run.robots[parent]?.children.push(id);
    for (const [id, robot] of Object.entries(run.robots)) bodies.set(id, robot);
  }
  new Set([...document.querySelectorAll('use')].map((use) => use.getAttribute('href').slice(3))).forEach(symbol);
  const count = (robot, kinds) => [...robot.body].filter((letter) => kinds.includes(letter)).length;
  const fitness = (run, value) => value === null ? 'failed' : number(value, page.runs[run].decimals);
  const withError = (run, [mean, error]) => `${fitness(run, mean)} \u00b1 ${fitness(run, error)}`;

  // ---- a card a robot ---------------------------------------------------------------

  const dialog = element('dialog', { class: 'robot', 'aria-label': 'Robot' });
  document.body.append(dialog);
  let playing = null;
  const leave = () => {
    playing?.end();
    playing = null;
    dialog.replaceChildren();
  };
  // The address names the robot whose card is open, so that it can be passed on.
  let addressBefore = null;
  const name = (hash) => history.replaceState(null, '', hash || location.pathname + location.search);
  dialog.addEventListener('close', () => {
    leave();
    name(addressBefore);
    addressBefore = null;
  });
  dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });

  const link = (run, id) => {
    const made = element('a', { href: `#${run}-${id}`, class: 'relative', 'aria-label': 'robot ' + id }, thumbnail(id));
    made.append(element('span', {}, fitness(run, page.runs[run].robots[id].fitness)));
    return made;
  };
  const relatives = (run, title, ids) => {
    const known = ids.filter((id) => page.runs[run].robots[id]);
    if (known.length === 0) return '';
    return element('div', { class: 'relatives' }, element('h4', {}, title), ...known.slice(0, 12).map((id) => link(run, id)),
      ...(known.length > 12 ? [`and ${known.length - 12} more`] : []));
  };
  const copyable = (text) => {
    const button = element('button', { type: 'button', 'aria-label': 'Copy: ' + text }, 'Copy');
    button.addEventListener('click', () => copy(button, text));
    return element('div', { class: 'command' }, element('code', {}, text), button);
  };
  const copy = (button, text) => {
    const area = element('textarea', { 'aria-hidden': 'true' });
    area.value = text;
    button.after(area);
    area.select();
    document.execCommand('copy');  // the clipboard of a page from disk
    area.remove();
    button.textContent = 'Copied';
    setTimeout(() => { button.textContent = 'Copy'; }, 1500);
  };

  const factsOf = (run, robot) => {
    const { done, robots } = page.runs[run], rows = robot.body.split('/');
    return [['fitness', robot.failure === undefined ? fitness(run, robot.fitness) : `failed: ${robot.failure}`],
      robot.score && ['from perturbed starts', withError(run, robot.score)],
      [`${done} as`, `robot ${robot.number}, in generation ${robot.generation}`],
      robot.sharing !== undefined && ['controller', `that of all robots of generation ${robot.sharing}`],
      robot.best && ['best evaluation', `after ${number(robot.best[0], 0)} of ${number(robot.best[1], 0)} steps`],
      ['body', `${rows.length}\u00d7${rows[0].length}, ${count(robot, 'RSHV')} voxels, ${count(robot, 'HV')} actuators`],
      robot.tool && ['made by', robot.tool]].filter(Boolean);
  };

  const actor = (run, id, name, more = {}) => ({ data: page.runs[run].robots[id].replay, world: page.runs[run].world, name, ...more });
  // The robot's episode, and on demand its parent's beside it.
  const stageOf = (run, id) => {
    const robot = page.runs[run].robots[id];
    const stage = element('div', { class: 'replay' });
    const parent = robot.parents.find((other) => page.runs[run].robots[other]?.replay);
    const show = (beside) => {
      playing?.end();
      const child = actor(run, id, beside ? 'This robot' : 'Robot ' + id);
      const cast = [child];
      if (beside) {
        cast.unshift(actor(run, parent, 'Its parent'));
        child.parent = cast[0];
      }
      playing = Replays.player(stage, cast);
      if (!parent) return;
      const other = element('button', { type: 'button', class: 'beside' }, beside ? 'Alone' : 'Beside its parent');
      other.addEventListener('click', () => { show(!beside); stage.querySelector('.beside').focus(); });
      stage.append(other);
    };
    return { stage, show };
  };

  const openRobot = (run, id) => {
    const robot = page.runs[run]?.robots[id];
    if (!robot) return;
    leave();
    const close = element('button', { type: 'button', class: 'close', 'aria-label': 'Close' }, '\u00d7');
    close.addEventListener('click', () => dialog.close());
    const shown = element('div', { class: 'portrait' });
    shown.append(thumbnail(id));
    const facts = element('dl', { class: 'facts' });
    for (const [name, value] of factsOf(run, robot)) facts.append(element('dt', {}, name), element('dd', {}, value));
    const moving = robot.replay && stageOf(run, id);
    const charts = Object.entries(robot.charts ?? {}).map(([name, points]) => spark(name, points, page.runs[run].decimals));
    dialog.append(close, element('h3', {}, 'Robot ', element('span', { class: 'id' }, id)),
      element('div', { class: 'top' }, shown, facts), ...(moving ? [moving.stage] : []),
      relatives(run, 'Parents', robot.parents), relatives(run, 'Children', robot.children),
      element('div', { class: 'three' }, ...charts), element('div', { class: 'commands' }, ...(robot.commands ?? []).map(copyable)));
    addressBefore ??= robotOf(location.hash) ? '' : location.hash;
    name(`#${run}-${id}`);
    if (!dialog.open) dialog.showModal();
    dialog.scrollTop = 0;
    moving?.show(false);
    reach();
  };

  // A link to a robot opens its card; one inside of a card another card.
  const robotOf = (hash) => {
    const found = /^#?(run-\d+)-([0-9a-f]{12})$/.exec(hash);
    return found && page.runs[found[1]]?.robots[found[2]] ? found.slice(1) : null;
  };
  document.addEventListener('click', (event) => {
    const anchor = event.target.closest('a[href^="#"]');
    const row = event.target.closest('table.robots tbody tr');  // anywhere in it
    const robot = robotOf(anchor ? anchor.getAttribute('href') : row?.id ?? '');
    if (!robot) return;
    event.preventDefault();
    openRobot(...robot);
  });

  // ---- what stands on the page from the start ------------------------------------------

  document.querySelectorAll('[data-chart]').forEach((holder) => {
    const run = holder.dataset.run, robots = run ? Object.entries(page.runs[run].robots) : [];
    attach(holder, page.charts[holder.dataset.chart], robots, (id) => link(run, id));
  });
  // Who comes into view moves, unless the user wants less of it or has stopped it.
  const stages = new Set();
  const perform = (holder, cast) => {
    stages.add(holder);
    const stage = Replays.player(holder, cast);
    let stopped = false;
    holder.addEventListener('click', () => { stopped = holder.querySelector('.play').getAttribute('aria-label') === 'Play'; });
    new IntersectionObserver(([{ isIntersecting }]) => {
      if (!isIntersecting) stage.stop();
      else if (!stopped && !Replays.calm()) stage.ready.then(stage.start);
    }).observe(cast[0].canvas);
  };
  const drawReplays = () => {
    document.querySelectorAll('[data-cast]').forEach((holder) => {
      if (holder.offsetWidth === 0 || stages.has(holder)) return;
      perform(holder, JSON.parse(holder.dataset.cast).map(([run, id, name]) => actor(run, id, name)));
    });
    // Ancestors, each a small stage of its own, with one clock.
    document.querySelectorAll('.line').forEach((line) => {
      const holder = line.nextElementSibling;
      if (line.offsetWidth === 0 || stages.has(holder)) return;
      const canvases = [...line.querySelectorAll('canvas')];
      if (canvases.length === 0) return;
      const cast = canvases.map((canvas) => actor(line.dataset.run, canvas.dataset.robot, 'Robot ' + canvas.dataset.robot, { canvas, close: true }));
      const steps = [...line.children];
      cast.forEach((child, k) => {  // a parent is the step before, if it moves
        if (k > 0 && steps.indexOf(child.canvas.closest('.line > li')) === steps.indexOf(cast[k - 1].canvas.closest('.line > li')) + 1) child.parent = cast[k - 1];
      });
      perform(holder, cast);
    });
  };
  const drawVisible = () => { drawReplays(); reach(); };

  document.querySelectorAll('[data-copy]').forEach((button) => button.addEventListener('click', () => copy(button, button.dataset.copy)));

  // ---- tables -----------------------------------------------------------------------

  // The least first, or the greatest; what has no value comes last either way.
  const sorted = (list, valueOf, descending) => {
    const values = list.map((it) => [it, valueOf(it) ?? '']);
    const missing = (value) => value === '';
    return values.sort(([, a], [, b]) => missing(a) || missing(b) ? missing(a) - missing(b)
      : (a < b ? -1 : a > b ? 1 : 0) * (descending ? -1 : 1)).map(([it]) => it);
  };
  // Headings that sort: `show(column, descending)` does it.
  const headings = (table, show) => {
    const cells = [...table.tHead.rows[0].cells];
    cells.forEach((cell, column) => {
      if (cell.dataset.sort === undefined) return;
      const button = element('button', { type: 'button' }, cell.textContent);
      cell.replaceChildren(button);
      button.addEventListener('click', () => {
        const now = cell.getAttribute('aria-sort');
        const descending = now ? now === 'ascending' : cell.dataset.sort === 'descending';
        cells.forEach((other) => other.removeAttribute('aria-sort'));
        cell.setAttribute('aria-sort', descending ? 'descending' : 'ascending');
        show(column, descending);
      });
    });
  };
  // Cells say their value in data-v.
  const sortable = (table) => headings(table, (column, descending) => table.tBodies[0].append(...sorted([...table.tBodies[0].rows], (row) => {
    const value = row.cells[column].dataset.v;
    return value === '' || isNaN(value) ? value : Number(value);
  }, descending)));

  // All robots, so many at a time.
  const listRobots = (holder) => {
    const run = holder.dataset.run, { robots } = page.runs[run], all = Object.keys(robots), rows = 50;
    const changed = ({ body, parents }) => {
      const before = robots[parents.find((id) => robots[id])]?.body;
      return before?.length === body.length ? [...body].filter((letter, k) => letter !== before[k]).length : undefined;
    };
    const some = (which) => all.some((id) => which(robots[id]) !== undefined);
    const columns = [['fitness', (it) => it.fitness], ['perturbed starts', (it) => it.score?.[0]], ['number', (it) => it.number], ['generation', (it) => it.generation],
      ['voxels', (it) => count(it, 'RSHV')], ['actuators', (it) => count(it, 'HV')], ['rigid', (it) => count(it, 'R')], ['soft', (it) => count(it, 'S')],
      ['horizontal', (it) => count(it, 'H')], ['vertical', (it) => count(it, 'V')], ['changed', changed],
      ['nodes', (it) => it.genes?.[0]], ['links', (it) => it.genes?.[1]]].filter(([, value]) => some(value));
    columns.push(['id', (it, id) => id]);
    const text = (name, robot, value) => value === undefined ? '' : name === 'fitness' ? robot.failure === undefined ? fitness(run, value) : 'failed: ' + robot.failure
      : name === 'perturbed starts' ? withError(run, robot.score) : String(value);
    const table = element('table', { class: 'data robots' });
    const look = (name) => name === 'id' ? 'id' : ['rigid', 'soft', 'horizontal', 'vertical'].includes(name) ? 'n kind' : 'n';
    table.createTHead().insertRow().append(element('th', {}, 'robot'), ...columns.map(([name]) =>
      element('th', { class: look(name), 'data-sort': ['number', 'generation', 'id'].includes(name) ? 'ascending' : 'descending' }, name)));
    const body = table.createTBody(), says = element('span'), back = element('button', { type: 'button' }, '\u2190 Back'), on = element('button', { type: 'button' }, 'On \u2192');
    let order = sorted(all, (id) => robots[id].fitness, true), from = 0;
    table.tHead.rows[0].cells[1].setAttribute('aria-sort', 'descending');
    const show = (first) => {
      from = first;
      body.replaceChildren(...order.slice(from, from + rows).map((id) => element('tr', { id: `${run}-${id}` }, element('td', {}, element('a', { class: 'to-robot', href: `#${run}-${id}`, 'aria-label': 'robot ' + id }, thumbnail(id))),
        ...columns.map(([name, value]) => element('td', { class: look(name) + (name === 'fitness' && robots[id].failure !== undefined ? ' failed' : '') }, text(name, robots[id], value(robots[id], id)))))));
      says.textContent = `${from + 1} to ${Math.min(order.length, from + rows)} of ${number(order.length, 0)}`;
      back.disabled = from === 0;
      on.disabled = from + rows >= order.length;
    };
    headings(table, (column, descending) => {
      order = sorted(all, (id) => columns[column - 1][1](robots[id], id), descending);
      show(0);
    });
    back.addEventListener('click', () => show(from - rows));
    on.addEventListener('click', () => show(from + rows));
    holder.append(element('div', { class: 'scroll' }, table), ...(order.length > rows ? [element('div', { class: 'pages' }, back, says, on)] : []));
    show(0);
  };

  // Runs of a comparison are folded; what is in them is drawn when it has a size.
  const unfold = () => {
    const robot = robotOf(location.hash);
    if (robot) return openRobot(...robot);
    const target = location.hash && document.getElementById(location.hash.slice(1));
    const fold = target && target.closest('details');
    if (!fold || fold.open) return;
    fold.open = true;
    target.scrollIntoView();
  };

  // What can be scrolled can be reached with the keyboard.
  const reach = () => document.querySelectorAll('.scroll, .command code').forEach((box) => {
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
    else box.removeAttribute('tabindex');
  });
  addEventListener('resize', reach);

  drawVisible();
  document.querySelectorAll('details').forEach((fold) => fold.addEventListener('toggle', drawVisible));
  addEventListener('hashchange', unfold);
  unfold();
  document.querySelectorAll('table.sortable').forEach(sortable);
  document.querySelectorAll('.robots[data-run]').forEach(listRobots);
})();

// What moves on the page: charts, the cards of robots, replays, tables that can be
// sorted.
'use strict';
(() => {
  const { draw, redrawAll, scale, element, number, thumbnail } = Charts;
  const page = JSON.parse(document.getElementById('data').textContent);

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
    const score = page.runs[run].robots[id].fitness;
    made.append(element('span', {}, score === null ? 'failed' : number(score)));
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

  // Evaluations during training, and what the algorithm logged beside them.
  const learning = (robot) => {
    const charts = [];
    if (robot.curve?.length)
      charts.push(['evaluation', { x: 'training steps', y: 'return', whole: true, labels: ['training steps', 'best so far', 'evaluation'],
        series: [{ kind: 'step' }, { kind: 'line' }], rows: robot.curve.map(([step, value, best]) => [step, [best, best, best], [value, value, value]]) }]);
    for (const [name, points] of Object.entries(robot.log ?? {}))
      charts.push([name, { x: 'training steps', y: name, whole: true, labels: ['training steps', name], series: [{ kind: 'line' }],
        rows: points.map(([step, value]) => [step, [value, value, value]]) }]);
    return charts;
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
    const picture = thumbnail(id);
    picture.setAttribute('viewBox', document.getElementById('b-' + id).getAttribute('viewBox'));
    shown.append(picture);
    const facts = element('dl', { class: 'facts' });
    for (const [name, value] of robot.facts) facts.append(element('dt', {}, name), element('dd', {}, value));
    const moving = robot.replay && stageOf(run, id);
    const charts = element('div', { class: 'three' });
    dialog.append(close, element('h3', {}, 'Robot ', element('span', { class: 'id' }, id)),
      element('div', { class: 'top' }, shown, facts), ...(moving ? [moving.stage] : []),
      relatives(run, 'Parents', robot.parents), relatives(run, 'Children', robot.children), charts,
      element('div', { class: 'commands' }, ...robot.commands.map(copyable)));
    addressBefore ??= robotOf(location.hash) ? '' : location.hash;
    name(`#${run}-${id}`);
    if (!dialog.open) dialog.showModal();
    dialog.scrollTop = 0;
    moving?.show(false);
    for (const [name, chart] of learning(robot)) {
      const holder = element('div', { class: 'chart small' });
      charts.append(holder);
      draw(holder, chart, () => {}, `${id} ${name}`);
    }
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

  // A row an evaluation, and lines between those of one robot; the champion's last.
  const addCurves = (chart, robots) => {
    Object.assign(chart, { rows: [], robots: [], edges: [] });
    const missing = [null, null, null];
    for (const [id, { curve }] of Object.entries(robots).sort(([a], [b]) => (a === chart.champion) - (b === chart.champion)))
      curve.forEach(([step, value], n) => {
        const best = id === chart.champion;
        if (value === null) return;
        if (n > 0 && chart.robots.at(-1) === id) chart.edges.push([chart.rows.length - 1, chart.rows.length, best]);
        chart.rows.push([step, best ? missing : [value, value, value], best ? [value, value, value] : missing]);
        chart.robots.push(id);
      });
  };
  const drawCharts = () => document.querySelectorAll('[data-chart]').forEach((holder) => {
    if (holder.offsetWidth === 0 || holder.hasChildNodes()) return;
    const chart = page.charts[holder.dataset.chart];
    if (chart?.champion) addCurves(chart, page.runs[holder.dataset.run].robots);
    if (chart && (chart.cells || chart.rows).length > 0) draw(holder, chart, (id) => openRobot(holder.dataset.run, id), holder.dataset.name);
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
  const drawVisible = () => { drawCharts(); drawReplays(); reach(); };

  document.querySelectorAll('[data-scale]').forEach((place) => place.append(...scale(Number(place.dataset.scale))));
  document.querySelectorAll('[data-copy]').forEach((button) => button.addEventListener('click', () => copy(button, button.dataset.copy)));

  // ---- tables -----------------------------------------------------------------------

  // Cells say their value in data-v; those without one come last either way.
  const sort = (table, column, descending) => {
    const rows = [...table.tBodies[0].rows].map((row) => ({ row, value: row.cells[column].dataset.v ?? '' }));
    const numeric = rows.every(({ value }) => value === '' || Number.isFinite(Number(value)));
    const order = numeric ? (a, b) => Number(a) - Number(b) : (a, b) => (a < b ? -1 : a > b ? 1 : 0);
    rows.sort((a, b) => {
      if (a.value === '' || b.value === '') return (a.value === '') - (b.value === '');
      return descending ? order(b.value, a.value) : order(a.value, b.value);
    });
    table.tBodies[0].append(...rows.map(({ row }) => row));
    [...table.tHead.rows[0].cells].forEach((cell, k) => {
      if (k === column) cell.setAttribute('aria-sort', descending ? 'descending' : 'ascending');
      else cell.removeAttribute('aria-sort');
    });
  };

  const sortable = (table) => {
    [...table.tHead.rows[0].cells].forEach((cell, column) => {
      if (cell.dataset.sort === undefined) return;
      const button = element('button', { type: 'button' }, cell.textContent);
      cell.dataset.name = cell.textContent;  // paper repeats headings, but no buttons
      cell.replaceChildren(button);
      button.addEventListener('click', () => {
        const now = cell.getAttribute('aria-sort');
        const descending = now ? now === 'ascending' : cell.dataset.sort === 'descending';
        sort(table, column, descending);
      });
    });
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

  // Paper is narrower than a screen: charts are drawn anew for it.
  addEventListener('beforeprint', () => { document.body.classList.add('printing'); redrawAll(); });
  addEventListener('afterprint', () => { document.body.classList.remove('printing'); redrawAll(); });

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
})();

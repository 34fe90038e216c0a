// What moves on the page: charts, the cards of robots, replays, tables that can be
// sorted.
'use strict';
(() => {
  const { draw, redrawAll, element, number, thumbnail } = Charts;
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
    const stage = element('div', { class: 'replay' });
    const charts = element('div', { class: 'three' });
    dialog.append(close, element('h3', {}, 'Robot ', element('span', { class: 'id' }, id)),
      element('div', { class: 'top' }, shown, facts), ...(robot.replay ? [stage] : []),
      relatives(run, 'Parents', robot.parents), relatives(run, 'Children', robot.children), charts,
      element('div', { class: 'commands' }, ...robot.commands.map(copyable)));
    addressBefore ??= robotOf(location.hash) ? '' : location.hash;
    name(`#${run}-${id}`);
    if (!dialog.open) dialog.showModal();
    dialog.scrollTop = 0;
    if (robot.replay) playing = Replays.player(stage, robot.replay, page.runs[run].world, 'Robot ' + id);
    for (const [name, chart] of learning(robot)) {
      const holder = element('div', { class: 'chart small' });
      charts.append(holder);
      draw(holder, chart, () => {}, `${id} ${name}`);
    }
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
  const stages = new Map();
  const drawReplays = () => document.querySelectorAll('[data-replay]').forEach((holder) => {
    if (holder.offsetWidth === 0 || stages.has(holder)) return;
    const { run, replay } = holder.dataset;
    const stage = Replays.player(holder, page.runs[run].robots[replay].replay, page.runs[run].world, 'The champion');
    stages.set(holder, stage);
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (Object.keys(page.runs).length === 1 && !calm) stage.ready.then(stage.start);
  });
  const drawVisible = () => { drawCharts(); drawReplays(); };

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

  drawVisible();
  document.querySelectorAll('details').forEach((fold) => fold.addEventListener('toggle', drawVisible));
  addEventListener('hashchange', unfold);
  unfold();
  document.querySelectorAll('table.sortable').forEach(sortable);
})();

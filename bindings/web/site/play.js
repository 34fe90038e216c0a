// Play: a body drawn, a rhythm set, a task chosen, and what comes of it.
'use strict';
Evo.playPage = (evo) => {
  const { element, id, number } = Evo;
  const materials = [['R', 'Rigid'], ['S', 'Soft'], ['H', 'Muscle, sideways'], ['V', 'Muscle, upright'], ['.', 'Nothing']];
  const className = (letter) => 'block-' + (letter === '.' ? 'none' : letter);
  const nameOf = Object.fromEntries(materials.map(([letter, name]) => [letter, name.toLowerCase()]));
  const begin = { task: 'Walker-v0', body: Evo.firstRobot.body, gait: Evo.firstRobot.gait };
  // `other`: a policy instead of the rhythm, from a record or a `file` of that name.
  const state = { ...begin, other: null, about: '', record: null, file: null, start: {} };
  let material = 'H';
  const message = id('message');
  let worker = null;

  // ---- the theatre -----------------------------------------------------------------------

  const told = (theatre) => {
    const { total, steps, ended, terms, rules, folding } = theatre.player.counts();
    id('return').textContent = number(total);
    id('moment').textContent = `step ${steps} of ${theatre.player.steps}` + (ended ? ` · ${Evo.endings[ended]}` : '');
    if (ended) earned = total;
    showGoal();
    id('play').textContent = theatre.playing ? 'Pause' : 'Play';
    [...terms, rules, folding].forEach((value, k) => { if (cells[k]) cells[k].textContent = number(value); });
  };
  let cells = [], earned = null;  // by the last whole episode of this robot
  const theatre = new Evo.Player(id('stage'), told);
  // What is to be beaten: what was published on the task, then the record.
  const showGoal = () => {
    const known = Evo.tasks.find(({ name }) => name === (state.other?.task ?? state.task));
    const goals = known ? [['the paper', known.paper], ['the record', known.fitness]].sort((a, b) => a[1] - b[1]) : [];
    const [beaten, next] = [goals.filter(([, value]) => earned > value), goals.find(([, value]) => !(earned > value))];
    id('goal').textContent = earned !== null && earned === known?.fitness ? 'the record, to the last bit'
      : [...beaten.slice(-1).map(([name]) => `beats ${name}`), ...(next ? [`to beat: ${number(next[1])} (${next[0]})`] : [])].join('; ');
    id('goal').classList.toggle('beaten', beaten.length > 0);
  };
  const showTerms = (facts) => {
    cells = [];
    const row = (what, more) => {
      const value = element('td', { class: 'number' }, number(0));
      cells.push(value);
      return element('tr', {}, element('td', {}, what, ...(more ? [element('br'), element('small', {}, more)] : [])), value);
    };
    const weighted = ({ formula, weight }) => weight === 1 ? formula : `${weight} × ${formula}`.replace('-', '−');
    id('terms').replaceChildren(
      ...facts.reward.map((term) => row(term.words, weighted(term) + (term.when ? `, when ${term.when}` : ''))),
      row(facts.rules.length ? 'rules' : 'rules (this task has none)', facts.rules.map((rule) =>
        `${rule.when}: ${rule.reward >= 0 ? '+' : '−'}${Math.abs(rule.reward)}${rule.ends ? ' and the end' : ''}`).join('; ')),
      row('folding onto itself', `${facts.folding}`.replace('-', '−') + ' and the end'));
  };

  const controller = () => state.other ?? { kind: 'wave', amplitude: state.gait[0], period: state.gait[1], phase: state.gait[2] };
  // A modular policy fits any body: with it, a changed body stays driven.
  const fitsAny = () => state.other?.kind === 'modular';
  const isItsOwn = () => state.body.join() === state.other.robot.body.join();
  const driver = { network: 'network', modular: 'modular policy', sine: 'gait', sequence: 'sequence' };
  const drivenBy = (kind, of) => `Driven by the ${driver[kind] ?? kind} of ${of}${kind === 'modular' ? ' It fits any body: draw another one.' : ''}`;
  const say = (text) => { message.textContent = text; };
  // Everything anew from the state. What cannot be built is said, and the old robot stays.
  const build = ({ keepMessage = false } = {}) => {
    let player;
    try {
      const facts = evo.task(state.task);
      player = evo.open(state.task, { body: state.body });
      player.control(controller());
      const was = theatre.playing;
      earned = null;
      theatre.show(player, state.start);
      state.facts = facts;
      id('stage').setAttribute('aria-label', `The robot at ${facts.name}`);
      id('task-about').textContent = facts.description;
      showTerms(facts);
      theatre.draw();
      if (was) theatre.play();
      if (!keepMessage) say('');
    } catch (failure) {
      if (failure.name !== 'Refusal') throw failure;
      if (player && theatre.player !== player) player.close();
      say(failure.message.replace(/^robot: (\/body: )?/, 'This body cannot be used: '));
      return false;
    }
    remember();
    keep(worker);
    return true;
  };
  const rhythm = (slider) => {  // a change of the rhythm alone: from the start, without a new world
    earned = null;
    theatre.player?.control(controller());
    theatre.restart();
    remember();
    keep(slider);
  };

  // ---- undo -------------------------------------------------------------------------------

  const undoable = ['task', 'body', 'gait', 'other', 'about', 'record', 'file', 'start'];
  const past = [], future = [];
  let shown = null, keptBy = null;
  // Changes `by` one slider, or one evolution, are undone as one.
  const keep = (by) => {
    if (shown && undoable.every((name) => shown[name] === state[name])) return;
    if (shown && !(by && by === keptBy)) past.push(shown);
    future.length = 0;
    keptBy = by;
    shown = { ...state };
    showUndo();
  };
  const showUndo = () => { id('undo').disabled = !past.length; id('redo').disabled = !future.length; };
  const showAll = () => { drawGrid(); showGait(); showOther(); showTask(); };
  const travel = (from, to) => {
    if (!from.length) return;
    stopEvolving();
    to.push(shown);
    keptBy = null;
    Object.assign(state, shown = from.pop());
    showAll();
    build();
    showUndo();
  };
  id('undo').addEventListener('click', () => travel(past, future));
  id('redo').addEventListener('click', () => travel(future, past));
  addEventListener('keydown', (event) => {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || event.altKey || !['z', 'y'].includes(key) || event.target.matches('textarea')) return;
    event.preventDefault();
    if (key === 'y' || event.shiftKey) travel(future, past); else travel(past, future);
  });

  for (const name of ['play', 'stage']) id(name).addEventListener('click', () => theatre.playing ? theatre.pause() : theatre.play());
  id('restart').addEventListener('click', () => theatre.restart());
  id('step').addEventListener('click', () => theatre.step());
  id('speed').addEventListener('change', () => { theatre.speed = Number(id('speed').value); });
  id('zoom').addEventListener('change', () => { theatre.zoom = Number(id('zoom').value); theatre.view.reset(); theatre.draw(); });
  addEventListener('unhandledrejection', ({ reason }) => { if (reason?.name === 'Refusal') say(reason.message); });
  addEventListener('error', ({ error }) => { if (error?.name === 'Refusal') say(error.message); });

  // ---- the body ---------------------------------------------------------------------------

  const picks = materials.map(([letter, name], k) => {
    const pick = element('button', { type: 'button', role: 'radio', class: className(letter), 'aria-checked': 'false', tabindex: '-1' }, name);
    pick.addEventListener('click', () => choose(letter));
    pick.addEventListener('keydown', (event) => {
      const move = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (!move) return;
      event.preventDefault();
      const next = (k + move + materials.length) % materials.length;
      choose(materials[next][0]);
      picks[next].focus();
    });
    return pick;
  });
  id('materials').append(...picks);
  const choose = (letter) => {
    material = letter;
    picks.forEach((pick, k) => {
      pick.setAttribute('aria-checked', String(materials[k][0] === letter));
      pick.tabIndex = materials[k][0] === letter ? 0 : -1;
    });
  };
  choose('H');

  const grid = id('grid');
  let focused = [0, 0];
  const cell = (r, c) => grid.children[r]?.children[c];
  const label = (r, c) => `row ${r + 1}, column ${c + 1}: ${nameOf[state.body[r][c]]}`;
  const drawGrid = () => {
    grid.replaceChildren(...state.body.map((row, r) => element('div', { role: 'row' }, ...[...row].map((letter, c) =>
      element('button', { type: 'button', role: 'gridcell', class: className(letter), tabindex: '-1', 'data-r': r, 'data-c': c, 'aria-label': label(r, c) })))));
    focused = [Math.min(focused[0], state.body.length - 1), Math.min(focused[1], state.body[0].length - 1)];
    cell(...focused).tabIndex = 0;
    id('rows').value = state.body.length;
    id('columns').value = state.body[0].length;
  };
  const put = (r, c, letter) => {
    if (state.body[r]?.[c] === undefined || state.body[r][c] === letter) return false;
    state.body = state.body.map((row, k) => k === r ? row.slice(0, c) + letter + row.slice(c + 1) : row);
    cell(r, c).className = className(letter);
    cell(r, c).setAttribute('aria-label', label(r, c));
    return true;
  };
  const changed = () => {
    if (!fitsAny()) dropOther();
    stopEvolving();
    build();
    keep();  // also a body that cannot be used, yet
  };
  // A mouse draws along its way; a finger that moves scrolls, its tap is a click.
  let drawn = false;
  const drawAt = (event) => {
    const hit = document.elementFromPoint(event.clientX, event.clientY)?.closest('#grid button');
    if (hit) drawn = put(Number(hit.dataset.r), Number(hit.dataset.c), material) || drawn;
  };
  const endDrawing = () => { if (drawn) changed(); drawn = false; };
  grid.addEventListener('pointerdown', (event) => {
    if (event.pointerType !== 'mouse') return;
    grid.setPointerCapture(event.pointerId);
    drawAt(event);
  });
  grid.addEventListener('pointermove', (event) => { if (event.pointerType === 'mouse' && event.buttons) drawAt(event); });
  grid.addEventListener('pointerup', endDrawing);
  grid.addEventListener('click', (event) => { drawAt(event); endDrawing(); });
  grid.addEventListener('keydown', (event) => {
    const [r, c] = focused;
    const move = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0], Home: [0, -99], End: [0, 99] }[event.key];
    if (move) {
      const to = [Math.min(state.body.length - 1, Math.max(0, r + move[0])), Math.min(state.body[0].length - 1, Math.max(0, c + move[1]))];
      cell(r, c).tabIndex = -1;
      focused = to;
      cell(...to).tabIndex = 0;
      cell(...to).focus();
    } else {
      const key = event.key.toUpperCase();
      const letter = event.ctrlKey || event.metaKey || event.altKey ? null
        : 'RSHV.'.includes(key) && key.length === 1 ? key : ['Delete', 'Backspace', '0'].includes(event.key) ? '.' : [' ', 'Enter'].includes(event.key) ? material : null;
      if (letter === null) return;
      if (put(r, c, letter)) changed();
    }
    event.preventDefault();
  });
  grid.addEventListener('focusin', ({ target }) => {
    if (!target.dataset.r) return;
    cell(...focused).tabIndex = -1;
    focused = [Number(target.dataset.r), Number(target.dataset.c)];
    target.tabIndex = 0;
  });
  for (const name of ['rows', 'columns']) for (let k = 1; k <= 10; ++k) id(name).append(element('option', { value: k }, k));
  const resize = () => {
    const rows = Number(id('rows').value), columns = Number(id('columns').value);
    const body = state.body.map((row) => row.slice(0, columns).padEnd(columns, '.'));
    while (body.length < rows) body.unshift('.'.repeat(columns));  // grows upwards, feet stay
    state.body = body.slice(body.length - rows);
    drawGrid();
    changed();
  };
  id('rows').addEventListener('change', resize);
  id('columns').addEventListener('change', resize);
  const seed = () => Math.floor(Math.random() * 2 ** 31);
  const take = (body) => { state.body = body; drawGrid(); changed(); };
  id('random').addEventListener('click', () => {
    try { take(evo.sample(state.body.length, state.body[0].length, seed()).body); } catch (failure) { say(failure.message); }
  });
  id('mutate').addEventListener('click', () => {
    try { take(evo.mutate({ body: state.body }, 0.1, seed()).body); } catch (failure) { say(failure.message); }
  });

  // ---- the rhythm -------------------------------------------------------------------------

  const sliders = ['amplitude', 'period', 'phase'];
  const units = [(v) => `±${Math.round(100 * v)} %`, (v) => `${Math.round(10 * v) / 10} steps`, (v) => `${Math.round(v * 180 / Math.PI)}°`];
  const showGait = () => sliders.forEach((name, k) => {
    id(name).value = state.gait[k];
    id(`${name}-value`).textContent = units[k](state.gait[k]);
  });
  sliders.forEach((name, k) => id(name).addEventListener('input', () => {
    state.gait = state.gait.map((value, n) => n === k ? Number(id(name).value) : value);
    id(`${name}-value`).textContent = units[k](state.gait[k]);
    stopEvolving();
    rhythm(name);
  }));
  const showOther = () => {
    id('gait-wave').hidden = Boolean(state.other);
    id('gait-other').hidden = !state.other;
    id('gait-about').textContent = state.about;
  };
  const useOther = (document, about, { record = null, file = null } = {}) => {
    Object.assign(state, { other: document, about, record, file });
    showOther();
  };
  const dropOther = () => {
    if (!state.other) return;
    useOther(null, '');
    state.start = {};
    showGait();
  };
  id('gait-back').addEventListener('click', () => { dropOther(); build(); });

  // ---- the task ---------------------------------------------------------------------------

  const groups = { easy: element('optgroup', { label: 'Easy' }), medium: element('optgroup', { label: 'Medium' }), hard: element('optgroup', { label: 'Hard' }) };
  for (const { name, difficulty } of Evo.tasks) groups[difficulty].append(element('option', { value: name }, name));
  const ownOption = element('option', { value: '', hidden: '' }, 'your own');
  id('task').append(...Object.values(groups), ownOption);
  const showTask = () => {
    const known = Evo.tasks.some(({ name }) => name === state.task);
    ownOption.hidden = known;
    id('task').value = known ? state.task : '';
  };
  const useTask = (text) => {
    const before = state.task;
    state.task = text;
    stopEvolving();
    dropOther();
    if (!build()) { state.task = before; showTask(); return false; }
    showTask();
    return true;
  };
  id('task').addEventListener('change', () => { if (id('task').value) useTask(id('task').value); });
  id('own-use').addEventListener('click', () => {
    const text = id('own-text').value;
    if (!text.trim()) { say('There is no task yet: paste one into the field.'); return; }
    useTask(text.trimEnd() + '\n');
  });

  // ---- evolve for me ------------------------------------------------------------------------

  const says = id('evolve-says'), curve = id('evolve-curve');
  let progress = [];
  const drawCurve = () => {
    const ratio = devicePixelRatio || 1, width = curve.clientWidth, height = curve.clientHeight;
    if (!width || progress.length === 0) return;
    curve.width = width * ratio;
    curve.height = height * ratio;
    const g = curve.getContext('2d'), colors = Evo.Stage.look();
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    const most = progress[progress.length - 1][0], low = progress[0][1], high = progress[progress.length - 1][1];
    const X = (tried) => 4 + (width - 8) * (tried - 1) / Math.max(1, most - 1), Y = (total) => height - 20 - (height - 38) * (high > low ? (total - low) / (high - low) : 0.5);
    g.strokeStyle = colors.grid;
    g.beginPath(); g.moveTo(4, height - 19.5); g.lineTo(width - 4, height - 19.5); g.stroke();
    g.strokeStyle = colors.mark;
    g.lineWidth = 2;
    g.lineJoin = 'round';
    g.beginPath();
    progress.forEach(([tried, total], k) => {
      if (k === 0) g.moveTo(X(tried), Y(total));
      else { g.lineTo(X(tried), Y(progress[k - 1][1])); g.lineTo(X(tried), Y(total)); }
    });
    g.stroke();
    g.fillStyle = colors.text;
    g.font = colors.font;
    g.textAlign = 'right'; g.fillText(`${most} robots`, width - 4, height - 5);
    g.textAlign = 'left'; g.fillText(number(low), 4, Math.min(height - 24, Y(low) - 5));
    g.textAlign = 'right'; g.fillText(number(high), width - 4, Y(high) - 5);
  };
  const stopEvolving = () => {
    if (!worker) return;
    worker.terminate();
    worker = null;
    id('evolve').textContent = 'Evolve';
  };
  const evolve = async () => {
    dropOther();
    if (!build()) return;
    id('evolve').textContent = 'Stop';
    says.textContent = 'Starting…';
    const first = { body: state.body, gait: state.gait };
    progress = [];
    const source = URL.createObjectURL(new Blob([Evo.workerSource], { type: 'text/javascript' }));
    const mine = worker = new Worker(source);
    URL.revokeObjectURL(source);
    let shown = 0, began = null;
    mine.onmessage = ({ data }) => {
      if (mine !== worker) return;
      if (data.failed) { say(data.failed); stopEvolving(); return; }
      if (data.done) {
        stopEvolving();
        const { body, gait, total, tried } = shown;
        says.textContent = tried > 1 ? `From ${number(began)} to ${number(total)}, found as robot ${tried} of ${progress[progress.length - 1][0]}. It is the one you see.`
          : `None of ${progress[progress.length - 1][0]} robots earned more than the first.`;
        return;
      }
      const { tried, best, seconds } = data;
      began ??= best.total;
      progress.push([tried, best.total]);
      curve.hidden = false;
      drawCurve();
      says.textContent = `${tried} tried in ${Math.round(seconds)} s; from ${number(began)} to ${number(best.total)}.`;
      if (shown?.tried !== best.tried) {
        shown = best;
        if (best.tried === 1) return;
        Object.assign(state, { body: best.body, gait: best.gait });
        drawGrid();
        showGait();
        build();
        theatre.play();
      }
    };
    mine.onerror = (event) => { say(event.message); stopEvolving(); };
    mine.postMessage({ module: await Evo.moduleBytes(), files: Evo.files,
      search: { task: state.task, ...first, seed: 1, seconds: Number(id('evolve-time').value), most: 100000 } });
    if (!Evo.calm.matches) theatre.play();
  };
  id('evolve').addEventListener('click', () => { if (worker) { stopEvolving(); says.textContent += ' Stopped.'; } else evolve(); });

  // ---- keeping and opening ------------------------------------------------------------------

  const isNamed = () => Evo.tasks.some(({ name }) => name === state.task);
  const address = () => {
    if (state.record) return `#record=${state.record}` + (isItsOwn() ? '' : `&body=${state.body.join('-')}`);
    if (state.other) return '#';  // a file is more than an address holds
    const task = isNamed() ? `task=${state.task}` : `own=${encodeURIComponent(state.task)}`;
    return `#${task}&body=${state.body.join('-')}&gait=${state.gait.join(',')}`;
  };
  const bodyPrinted = () => `printf '${state.body.join('\\n')}\\n' |\n  `;
  const command = () => {
    const policy = state.record ? `records/${state.record}/policy.h5` : state.file;
    if (fitsAny() && !isItsOwn()) return `${bodyPrinted()}evo-eval --policy ${policy}`;
    if (state.record || state.other) return `evo-eval --policy ${policy} ${policy}`;
    const task = isNamed() ? state.task : './task.yaml';
    return `${bodyPrinted()}evo-eval --task ${task} --actions sine:${state.gait.join(',')}`;
  };
  const remember = () => {
    id('command').textContent = command();
    id('copy-link').disabled = Boolean(state.other && !state.record);
    id('copy-link').title = id('copy-link').disabled ? 'A link cannot carry a file; pass the file on.' : '';
    id('command-about').textContent = isNamed() || state.other ? 'The same robot with the tools:' : 'The same robot with the tools, once the task is saved as task.yaml:';
    if (location.hash !== address()) history.replaceState(null, '', address());
  };
  // The robot as evo-eval would write it, with the return of a whole episode.
  const robotDocument = () => {
    const player = evo.open(state.task, { body: state.body });
    try {
      player.control(controller());
      player.reset(state.start);
      player.step(1e7);
      const made = { ...evo.robot(JSON.stringify({ body: state.body })) };
      made.origin = state.other ? { tool: 'evo page', controller: state.other.kind } : { tool: 'evo page', sine: state.gait };
      return { ...made, fitness: player.counts().total, task: player.task };
    } finally { player.close(); }
  };
  id('copy-link').addEventListener('click', () => Evo.copy(id('copy-link'), location.href.split('#')[0] + address()));
  id('copy-json').addEventListener('click', () => {
    try { Evo.copy(id('copy-json'), JSON.stringify(robotDocument())); } catch (failure) { say(failure.message); }
  });
  id('download').addEventListener('click', () => {
    try {
      const made = robotDocument();
      const url = URL.createObjectURL(new Blob([JSON.stringify(made) + '\n'], { type: 'application/json' }));
      element('a', { href: url, download: `${made.id}.json` }).click();
      setTimeout(() => URL.revokeObjectURL(url), 1000);
    } catch (failure) { say(failure.message); }
  });

  // Whatever a file holds: a policy, a robot, a world, a task.
  const usePolicy = (document, about, { start = {}, read, ...from }) => {
    stopEvolving();
    const before = { ...state };
    Object.assign(state, { task: document.task_yaml ?? document.task, body: document.robot.body, start });
    useOther(document, about, from);
    drawGrid();
    if (!build()) {  // what stood there before stays, and why it does
      const why = message.textContent;
      Object.assign(state, before);
      showOther();
      drawGrid();
      build();
      say(read ? `${read}: ${why}` : why);
    }
    const named = Evo.tasks.find(({ name }) => name === document.task);
    ownOption.hidden = Boolean(named);
    id('task').value = named ? named.name : '';
  };
  const useRobot = (text) => {
    const robot = evo.robot(text);
    stopEvolving();
    dropOther();
    state.body = robot.body;
    if (Array.isArray(robot.origin?.sine) && robot.origin.sine.length === 3) state.gait = robot.origin.sine;
    if (Evo.tasks.some(({ name }) => name === robot.task)) state.task = robot.task;
    showAll();
    build();
  };
  const useText = (name, text) => {
    let json = null;
    try { json = JSON.parse(text); } catch { /* YAML, letters or several lines of JSON */ }
    if (json?.format === 'evo/policy') usePolicy(json, drivenBy(json.kind, `${name}.`), { file: name.replace(/\.json$/, '.h5'), read: name });
    else if (json?.objects && json?.grid_width) { useTask(text); id('own').open = true; id('own-text').value = state.facts?.yaml ?? text; }
    else if (!json && /^(format: *evo\/task|world:|observation:)/m.test(text)) { id('own').open = true; id('own-text').value = text; useTask(text); }
    else useRobot(text);
  };
  const useFile = async (file) => {
    const text = await file.text();
    try {
      if (/^.HDF\r\n/.test(text)) { say(`${file.name}: HDF5 is opened in JSON here: evo-convert ${file.name} --to json -o ${file.name.replace(/\.h5$/, '')}.json`); return; }
      useText(file.name, text);
      if (state.other && !Evo.calm.matches) theatre.play();
    } catch (failure) {
      if (failure.name !== 'Refusal') throw failure;
      say(`${file.name}: ${failure.message}`);
    }
  };
  id('open').addEventListener('change', () => { if (id('open').files[0]) useFile(id('open').files[0]); id('open').value = ''; });

  // ---- addresses ------------------------------------------------------------------------------

  const isSound = (body) => body.length <= 10 && body.every((row) => row.length === body[0].length && /^[.RSHV]{1,10}$/.test(row));
  const unsound = 'The body in this address is none of 1x1 to 10x10 blocks of . R S H V.';
  let current = null;
  const restore = async (query) => {
    if (query === current && theatre.player) return;
    current = query;
    const given = new URLSearchParams(query);
    const record = given.get('record'), body = given.get('body')?.split('-');
    if (record) {
      const known = Evo.tasks.find(({ name }) => name === record);
      if (!known) { say(`There is no record '${record}'.`); return; }
      await Evo.loadScript(`records/${record}.js`);
      const policy = Evo.controllers[record];
      usePolicy(policy, drivenBy(policy.kind, `the record ${record}.`), { record, start: { seed: known.seed ?? 0 } });
      if (body && fitsAny()) {
        if (isSound(body)) take(body);
        else say(unsound);
      }
    } else {
      dropOther();
      state.task = given.get('own') ?? given.get('task') ?? state.task;
      if (body) state.body = body;
      const gait = given.get('gait')?.split(',').map(Number);
      if (gait?.length === 3 && gait.every(Number.isFinite) && gait[1] > 0) state.gait = gait;
      if (!isSound(state.body)) { state.body = begin.body; showAll(); build(); say(unsound); return; }
      showAll();
      if (!build()) {  // an address that does not work shows why, beside a robot that does
        const why = message.textContent;
        Object.assign(state, begin);
        showAll();
        build();
        say(why);
      }
    }
    if (given.has('evolve')) evolve();
    else if (!Evo.calm.matches) theatre.play();
  };
  return { show: restore, open: useFile };
};

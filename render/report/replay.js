// Episodes that the page has with it, a few kilobytes each (replay.h), drawn as the site draws
// them (bindings/web/site/stage.js): one, or several side by side at the same moment.
'use strict';
const Replays = (() => {
  const { element, number } = Charts;

  // Numbers as replay.cpp packs them: second differences, zigzag, 7 bits a byte.
  const unpack = (bytes, series, frames) => {
    let at = 0;
    const next = () => {
      let value = 0, shift = 1, byte;
      do { byte = bytes[at++]; value += (byte & 127) * shift; shift *= 128; } while (byte & 128);
      return value % 2 ? -(value + 1) / 2 : value / 2;
    };
    const all = [];
    for (let s = 0; s < series; ++s) {
      const values = new Float32Array(frames);
      let before = 0, slope = 0;
      for (let f = 0; f < frames; ++f) {
        const read = next();  // the value, then its first difference, then second ones
        if (f === 0) before = read;
        else slope = f === 1 ? read : slope + read;
        before += slope;
        values[f] = before;
      }
      all.push(values);
    }
    return all;
  };

  const decode = async (data) => {
    const packed = Uint8Array.from(atob(data.packed), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const series = unpack(bytes, 1 + 2 * data.points, data.frames);
    const x = [], y = [];
    for (let p = 0; p < data.points; ++p) {
      x.push(series[1 + 2 * p].map((v) => v / data.scale));
      y.push(series[2 + 2 * p].map((v) => v / data.scale));
    }
    return { x, y, score: series[0].map((v) => v / 1000), ...way(data, x, y) };
  };

  // The robot's centre at every frame, smoothed: where the camera looks.
  const way = (data, x, y) => {
    const centre = (of, f) => { let sum = 0; for (let p = 0; p < data.robot; ++p) sum += of[p][f]; return sum / data.robot; };
    const reach = Math.round(48 / data.stride);
    const smooth = (values) => values.map((_, f) => {
      let sum = 0, weight = 0;
      for (let k = -reach; k <= reach; ++k) {
        const w = Math.exp(-((k * data.stride) ** 2) / 800);
        sum += w * values[Math.min(values.length - 1, Math.max(0, f + k))];
        weight += w;
      }
      return sum / weight;
    });
    const frames = [...Array(data.frames).keys()];
    return { cameraX: smooth(frames.map((f) => centre(x, f))), cameraY: smooth(frames.map((f) => centre(y, f))) };
  };

  // What a series has at a step, between frames on a curve through four of them (Catmull-Rom).
  const moment = (data, step) => {
    const last = data.frames - 1, f = Math.min(Math.floor(step / data.stride), last), next = Math.min(f + 1, last);
    const length = Math.min(next * data.stride, data.steps) - f * data.stride;
    const s = length > 0 ? Math.min(1, (step - f * data.stride) / length) : 0;
    const before = Math.max(0, f - 1), after = Math.min(last, f + 2);
    return (of) => {
      const a = of[before], b = of[f], c = of[next], d = of[after];
      return b + 0.5 * s * (c - a + s * (2 * a - 5 * b + 4 * c - d + s * (3 * (b - c) + d - a)));
    };
  };

  // Voxels of a robot at the start, by their place in the world.
  const voxels = ({ data, episode }) => new Map(data.body.map(([letter, , , bl], k) =>
    [`${Math.round(episode.x[bl][0])} ${Math.round(episode.y[bl][0])}`, { letter, k }]));
  const changedSince = (parent, child) => {
    const before = voxels(parent);
    return [...voxels(child)].filter(([place, { letter }]) => before.get(place)?.letter !== letter).map(([, { k }]) => k);
  };

  const paint = ({ canvas, data, world, episode, changed, close }, step, zoom, colors, strength) => {
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !episode) return;
    const now = moment(data, Math.min(step, data.steps));
    const x = episode.x.map(now), y = episode.y.map(now);
    let scale = Math.max(width / 26, height / 15) * zoom;
    if (close) {  // no more than the robot and where it stands
      const extent = (of) => Math.max(...of.slice(0, data.robot).map((p) => p[0])) - Math.min(...of.slice(0, data.robot).map((p) => p[0]));
      scale = width / (1.35 * Math.max(extent(episode.x), extent(episode.y)) + 2.5);
    }
    const camera = { scale, left: now(episode.cameraX) - width / scale / 2, low: Math.max(-1.6, now(episode.cameraY) - height / scale * 0.45) };
    Evo.Stage.paint(canvas, { fixed: world.fixed, objects: data.objects, body: data.body, outline: data.outline }, x, y, camera, colors,
      { outlined: changed, strength });
  };

  const watched = new Set();
  const calm = () => matchMedia('(prefers-reduced-motion: reduce)').matches;

  // A player in `holder` of the `cast`: [{data, world, name, canvas?, close?, parent?: one of
  // the cast, whose voxels that changed since are marked}..]. They have one clock; who is
  // over waits for the others. Canvases that the cast does not bring stand in the holder.
  const player = (holder, cast) => {
    const steps = Math.max(...cast.map(({ data }) => data.steps));
    const several = cast.length > 1;
    const play = element('button', { type: 'button', class: 'play', 'aria-label': 'Play' }, '\u25b6');
    const scrub = element('input', { type: 'range', min: 0, max: steps, step: 'any', value: 0, 'aria-label': 'Moment' });
    const says = element('output', { class: 'moment' });
    const speed = element('select', { 'aria-label': 'Speed' });
    for (const value of [0.1, 0.25, 0.5, 1, 2, 4]) speed.append(element('option', value === 1 ? { value, selected: '' } : { value }, `${value}\u00d7`));
    const zoom = element('select', { 'aria-label': 'Zoom' });
    for (const [value, label] of [[0.5, 'far'], [1, 'near'], [1.8, 'close']]) zoom.append(element('option', value === 1 ? { value, selected: '' } : { value }, label));
    const stages = element('div', { class: several ? 'stages' : '' });
    for (const actor of cast) {
      if (actor.canvas) continue;
      actor.canvas = element('canvas', { class: 'stage', role: 'img', 'aria-label': `${actor.name} at its task` });
      actor.own = true;
      actor.says = element('output');
      stages.append(several ? element('figure', {}, actor.canvas, element('figcaption', {}, element('b', {}, actor.name), ' ', actor.says)) : actor.canvas);
    }
    holder.replaceChildren(...(stages.hasChildNodes() ? [stages] : []),
      element('div', { class: 'controls' }, play, scrub, says, speed, ...(cast.some(({ close }) => !close) ? [zoom] : [])));

    let at = 0, playing = false, last = 0, rested = 0, gone = false, ready = false, look = Evo.Stage.look();
    const told = ({ data, episode }) => {
      const step = Math.min(at, data.steps), frame = Math.min(Math.round(step / data.stride), data.frames - 1);
      const ended = at >= data.steps ? ` \u00b7 ${data.ending}` : '';
      return `return ${number(episode.score[at >= data.steps ? data.frames - 1 : frame], 3)}${ended}`;
    };
    const draw = () => {
      if (!ready || gone) return;
      // Changed voxels flash while the robots move, and are outlined while they stand.
      const strength = playing && !calm() ? 0.5 + 0.5 * Math.cos(performance.now() / 160) : 1;
      for (const actor of cast) {
        paint(actor, at, Number(zoom.value), look, strength);
        if (several && actor.says) actor.says.textContent = told(actor);
      }
      says.textContent = `step ${Math.min(Math.round(at), steps)}` + (several ? ` of ${steps}` : ` \u00b7 ${told(cast[0])}`);
      scrub.value = at;
    };
    const tick = (now) => {
      if (!playing || gone) return;
      const passed = Math.min(0.1, (now - last) / 1000);
      last = now;
      if (at < steps) {
        at = Math.min(steps, at + passed * cast[0].data.rate * Number(speed.value));
        rested = 0;
      } else {
        rested += passed;
        if (rested > 1.5) at = 0;  // and again
      }
      draw();
      requestAnimationFrame(tick);
    };
    const show = (on) => { play.textContent = on ? '\u275a\u275a' : '\u25b6'; play.setAttribute('aria-label', on ? 'Pause' : 'Play'); };
    const stop = () => { playing = false; show(false); draw(); };
    const start = () => {
      if (playing || gone) return;
      if (at >= steps) at = 0;
      playing = true;
      last = performance.now();
      show(true);
      requestAnimationFrame(tick);
    };
    const toggle = () => playing ? stop() : start();
    play.addEventListener('click', toggle);
    for (const { canvas, own } of cast) if (own) canvas.addEventListener('click', toggle);
    scrub.addEventListener('input', () => { at = Number(scrub.value); stop(); });
    zoom.addEventListener('change', draw);
    const refresh = () => { look = Evo.Stage.look(); draw(); };
    watched.add(refresh);
    const size = new ResizeObserver(draw);
    for (const { canvas } of cast) size.observe(canvas);
    const done = Promise.all(cast.map(async (actor) => { actor.episode = await (actor.data.episode ??= decode(actor.data)); })).then(() => {
      for (const actor of cast) if (actor.parent) actor.changed = changedSince(actor.parent, actor);
      ready = true;
      draw();
    }).catch(() => says.replaceChildren('This browser cannot unpack the replay; a newer one can.'));
    return { ready: done, start, stop, end: () => { gone = true; playing = false; size.disconnect(); watched.delete(refresh); } };
  };

  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => watched.forEach((refresh) => refresh()));
  return { player, calm };
})();

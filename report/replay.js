// Episodes that the page has with it, a few kilobytes each (replay.h), drawn as the site draws
// them (web/site/stage.js).
'use strict';
const Replays = (() => {
  const { element, number } = Charts;
  const frames_per_second = 50;  // control steps of a second at speed 1

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
    return { x, y, score: series[0].map((v) => v / 1000) };
  };

  // Centre of the robot at every frame, and smoothed for the camera.
  const path = (data, episode) => {
    const centre = (of, f) => { let sum = 0; for (let p = 0; p < data.robot; ++p) sum += of[p][f]; return sum / data.robot; };
    const smooth = (values) => values.map((_, f) => {
      let sum = 0, weight = 0;
      for (let k = -24; k <= 24; ++k) {
        const w = Math.exp(-k * k / 200);
        sum += w * values[Math.min(values.length - 1, Math.max(0, f + k))];
        weight += w;
      }
      return sum / weight;
    });
    const frames = [...Array(data.frames).keys()];
    const x = frames.map((f) => centre(episode.x, f)), y = frames.map((f) => centre(episode.y, f));
    return { x, y, cameraX: smooth(x), cameraY: smooth(y) };
  };

  // The moment `at` (in frames, fractions between) onto a canvas.
  const paint = (canvas, data, world, episode, way, at, zoom, colors) => {
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width) return;
    const f = Math.min(Math.floor(at), data.frames - 1), n = Math.min(f + 1, data.frames - 1), s = at - f;
    const between = (of) => of[f] + (of[n] - of[f]) * s;
    const scale = Math.max(width / 26, height / 15) * zoom;
    const camera = { scale, left: between(way.cameraX) - width / scale / 2, low: Math.max(-1.6, between(way.cameraY) - height / scale * 0.45) };
    const scene = { fixed: world.fixed, objects: data.objects, body: data.body, outline: data.outline };
    Evo.Stage.paint(canvas, scene, episode.x.map(between), episode.y.map(between), camera, colors);
  };

  const watched = new Set();

  // A player in `holder`. Returns what stops it for good.
  const player = (holder, data, world, name) => {
    const canvas = element('canvas', { class: 'stage', role: 'img', 'aria-label': `${name} at its task` });
    const play = element('button', { type: 'button', class: 'play', 'aria-label': 'Play' }, '\u25b6');
    const scrub = element('input', { type: 'range', min: 0, max: data.frames - 1, step: 'any', value: 0, 'aria-label': 'Moment' });
    const says = element('output', { class: 'moment' });
    const speed = element('select', { 'aria-label': 'Speed' });
    for (const value of [0.1, 0.25, 0.5, 1, 2, 4]) speed.append(element('option', value === 1 ? { value, selected: '' } : { value }, `${value}\u00d7`));
    const zoom = element('select', { 'aria-label': 'Zoom' });
    for (const [value, label] of [[0.5, 'far'], [1, 'near'], [1.8, 'close']]) zoom.append(element('option', value === 1 ? { value, selected: '' } : { value }, label));
    const bar = element('div', { class: 'controls' }, play, scrub, says, speed, zoom);
    holder.replaceChildren(canvas, bar);
    let episode, way, at = 0, playing = false, last = 0, gone = false, look = Evo.Stage.look();
    const draw = () => {
      if (!episode || gone) return;
      paint(canvas, data, world, episode, way, at, Number(zoom.value), look);
      const f = Math.min(Math.round(at), data.frames - 1);
      const step = Math.min(data.steps, f * data.stride);
      const ended = f === data.frames - 1 ? ` \u00b7 ${data.ending}` : '';
      says.textContent = `step ${step} \u00b7 return ${number(Math.round(episode.score[f] * 1000) / 1000)}${ended}`;
      scrub.value = at;
    };
    const tick = (now) => {
      if (!playing || gone) return;
      at += Math.min(0.1, (now - last) / 1000) * frames_per_second / data.stride * Number(speed.value);
      last = now;
      if (at >= data.frames - 1) { at = data.frames - 1; stop(); }
      draw();
      if (playing) requestAnimationFrame(tick);
    };
    const show = (on) => { play.textContent = on ? '\u275a\u275a' : '\u25b6'; play.setAttribute('aria-label', on ? 'Pause' : 'Play'); };
    const stop = () => { playing = false; show(false); };
    const start = () => {
      if (at >= data.frames - 1) at = 0;
      playing = true;
      last = performance.now();
      show(true);
      requestAnimationFrame(tick);
    };
    play.addEventListener('click', () => playing ? stop() : start());
    canvas.addEventListener('click', () => playing ? stop() : start());
    scrub.addEventListener('input', () => { stop(); at = Number(scrub.value); draw(); });
    zoom.addEventListener('change', draw);
    const refresh = () => { look = Evo.Stage.look(); draw(); };
    watched.add(refresh);
    const size = new ResizeObserver(draw);
    size.observe(canvas);
    const ready = decode(data).then((decoded) => { episode = decoded; way = path(data, decoded); draw(); })
      .catch(() => says.replaceChildren('This browser cannot unpack the replay; a newer one can.'));
    return { ready, start, end: () => { gone = true; playing = false; size.disconnect(); watched.delete(refresh); } };
  };

  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => watched.forEach((refresh) => refresh()));
  return { player };
})();

// The picture of a moment: terrain, objects and a robot on a canvas, in the page's colours.
// Lengths are voxels. Used by the site and by the reports of evo-report.
'use strict';
(typeof globalThis.Evo === 'object' ? globalThis.Evo : (globalThis.Evo = {})).Stage = (() => {
  const kinds = { R: '--rigid', S: '--soft', H: '--horizontal', V: '--vertical', '#': '--fixed' };
  const look = () => {
    const style = getComputedStyle(document.documentElement);
    const css = (name) => style.getPropertyValue(name).trim();
    return { of: Object.fromEntries(Object.entries(kinds).map(([kind, name]) => [kind, css(name)])),
      object: css('--object'), softObject: css('--soft-object'), sky: css('--sky'), earth: css('--earth'),
      line: css('--outline'), grid: css('--line'), text: css('--muted'), mark: css('--mark'), font: '12px system-ui, sans-serif' };
  };
  const mix = (hex, other, share) => {
    const read = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
    const [a, b] = [read(hex), read(other)];
    return `rgb(${a.map((v, k) => Math.round(v + (b[k] - v) * share)).join()})`;
  };

  // A canvas of its size on the page, sharp on any screen; null while it is not shown.
  const prepare = (canvas) => {
    const ratio = globalThis.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !height) return null;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const g = canvas.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    return { g, width, height };
  };

  // `scene`: {fixed: [[x, y, width, height]..], objects and body: [[letter, top left, top right,
  // bottom left, bottom right]..] by number of point, outline: [[a, b]..] surfaces of the robot}.
  // `x` and `y`: of the points. `camera`: {left, low, scale: pixels a voxel}. `outlined`: voxels of
  // the body, by number, that are marked with that `strength`.
  const paint = (canvas, scene, x, y, camera, colors, { marks = [], outlined = [], strength = 1 } = {}) => {
    const ready = prepare(canvas);
    if (!ready) return;
    const { g, width, height } = ready;
    const { left, low, scale } = camera;
    const right = left + width / scale, rows = height / scale;
    const X = (value) => (value - left) * scale, Y = (value) => height - (value - low) * scale;
    g.fillStyle = colors.sky;
    g.fillRect(0, 0, width, height);
    if (scale >= 6) {
      g.lineWidth = 1;
      g.strokeStyle = colors.grid;
      g.beginPath();
      for (let k = Math.ceil(left); k < right; ++k) { g.moveTo(X(k), 0); g.lineTo(X(k), Y(0)); }
      for (let k = Math.max(0, Math.ceil(low)); k < low + rows; ++k) { g.moveTo(0, Y(k)); g.lineTo(width, Y(k)); }
      g.globalAlpha = 0.35; g.stroke(); g.globalAlpha = 1;
    }
    if (low < 0) { g.fillStyle = colors.earth; g.fillRect(0, Y(0), width, height); }
    g.font = colors.font;
    g.fillStyle = colors.text;
    g.textAlign = 'center';
    const every = scale >= 14 ? 5 : scale >= 6 ? 10 : 20;
    for (let k = Math.ceil(left / every) * every; low * scale < -18 && k < right; k += every) if (k >= 0) g.fillText(k, X(k), Y(0) + 15);
    for (const { at, label } of marks) {
      if (at < left || at > right) continue;
      g.strokeStyle = g.fillStyle = colors.mark;
      g.setLineDash([6, 5]);
      g.lineWidth = 1.5;
      g.beginPath(); g.moveTo(X(at), 18); g.lineTo(X(at), Y(0)); g.stroke();
      g.setLineDash([]);
      g.fillText(label, X(at), 14);
    }
    const shape = (corners, fill) => {
      g.beginPath();
      corners.forEach(([px, py], k) => k ? g.lineTo(X(px), Y(py)) : g.moveTo(X(px), Y(py)));
      g.closePath();
      g.fillStyle = fill;
      g.fill();
      g.lineWidth = Math.max(0.6, 0.03 * scale);
      g.strokeStyle = colors.line;
      g.globalAlpha = 0.45; g.stroke(); g.globalAlpha = 1;
    };
    for (const [fx, fy, w, h] of scene.fixed)
      if (fx + w > left && fx < right) shape([[fx, fy], [fx + w, fy], [fx + w, fy + h], [fx, fy + h]], colors.of['#']);
    const draw = ([kind, tl, tr, bl, br], robot) => {
      const corners = [tl, tr, br, bl].map((p) => [x[p], y[p]]);
      let fill = robot || kind === '#' ? colors.of[kind] : kind === 'S' ? colors.softObject : colors.object;
      if (robot && (kind === 'H' || kind === 'V')) {
        const length = (a, b) => Math.hypot(x[a] - x[b], y[a] - y[b]);
        const now = kind === 'H' ? (length(tl, tr) + length(bl, br)) / 2 : (length(tl, bl) + length(tr, br)) / 2;
        fill = now < 1 ? mix(fill, '#28181e', 0.55 * Math.min(1, (1 - now) / 0.4)) : mix(fill, '#ffffff', 0.55 * Math.min(1, (now - 1) / 0.6));
      }
      shape(corners, fill);
    };
    scene.objects.forEach((each) => draw(each, false));
    scene.body.forEach((each) => draw(each, true));
    g.strokeStyle = colors.line;
    g.lineWidth = Math.max(1.2, 0.11 * scale);
    g.lineJoin = g.lineCap = 'round';
    g.beginPath();
    for (const [a, b] of scene.outline) { g.moveTo(X(x[a]), Y(y[a])); g.lineTo(X(x[b]), Y(y[b])); }
    g.stroke();
    // Heights, over whatever stands there.
    g.textAlign = 'right';
    for (let k = Math.max(every, Math.ceil(low / every) * every); Y(k) > 30; k += every) {
      g.fillStyle = colors.sky;
      g.fillRect(width - 32, Y(k) - 8, 32, 16);
      g.fillStyle = colors.text;
      g.fillText(k, width - 10, Y(k) + 4);
      g.fillRect(width - 7, Y(k), 7, 1);
    }
    if (outlined.length) {
      g.strokeStyle = colors.mark;
      g.lineWidth = Math.max(2, 0.16 * scale);
      g.globalAlpha = strength;
      for (const k of outlined) {
        const [, tl, tr, bl, br] = scene.body[k];
        g.beginPath();
        [tl, tr, br, bl].forEach((p, n) => n ? g.lineTo(X(x[p]), Y(y[p])) : g.moveTo(X(x[p]), Y(y[p])));
        g.closePath();
        g.stroke();
      }
      g.globalAlpha = 1;
    }
  };

  // The scene of a player (module.js) at its start.
  const sceneOf = (player) => {
    const at = player.positions();
    const fixed = [], objects = [], body = [];
    const robot = player.objects.findIndex((object) => object.name === 'robot');
    for (const [object, letter, tl, tr, bl, br] of player.cells) {
      if (player.objects[object].static) {
        const [cx, cy] = [Math.round(at[2 * bl] / player.voxel), Math.round(at[2 * bl + 1] / player.voxel)];
        const last = fixed[fixed.length - 1];
        if (last && last[1] === cy && last[0] + last[2] === cx) ++last[2];  // rows as one
        else fixed.push([cx, cy, 1, 1]);
      } else {
        (object === robot ? body : objects).push([letter, tl, tr, bl, br]);
      }
    }
    const edges = new Map();
    for (const [, tl, tr, bl, br] of body)
      for (const [a, b] of [[tl, tr], [tr, br], [bl, br], [tl, bl]]) {
        const key = a < b ? `${a},${b}` : `${b},${a}`;
        edges.set(key, edges.has(key) ? null : [a, b]);
      }
    return { fixed, objects, body, outline: [...edges.values()].filter(Boolean) };
  };

  // Follows what the task follows without haste, by `passed` seconds, and never loses it: it stays
  // in the middle half of the picture.
  const camera = () => {
    let x, y, span;
    return {
      reset() { x = undefined; },
      at(canvas, centres, zoom, passed) {
        const width = canvas.clientWidth, height = canvas.clientHeight, aspect = height / width;
        const xs = centres.map((c) => c[0]), ys = centres.map((c) => c[1]);
        const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
        const wanted = Math.max(Math.min(26, 15 / aspect), right - left + 10, (high - low + 8) / aspect);
        const glide = x === undefined ? 1 : 1 - Math.exp(-8 * passed);
        const follow = (at, to, room) => Math.min(to + room, Math.max(to - room, at + (to - at) * glide));
        span = follow(span ?? wanted, wanted, wanted / 4);
        const scale = width / span * zoom;
        x = follow(x ?? 0, (left + right) / 2, width / scale / 4);
        y = follow(y ?? 0, (low + high) / 2, height / scale / 4);
        return { left: x - width / scale / 2, low: Math.max(-1.6, y - height / scale * 0.45), scale };
      },
    };
  };
  return { look, mix, paint, sceneOf, camera };
})();

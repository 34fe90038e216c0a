// Charts as SVG: they are sharp on paper, can be saved, and every tick stands where
// its value is. Data: see charts.h.
'use strict';
const Charts = (() => {
  let clips = 0;
  const NS = 'http://www.w3.org/2000/svg';
  // Okabe and Ito's, safe for colour-blind readers; olive and grey for its yellow and black.
  const palette = ['#d55e00', '#0072b2', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#8a7a17', '#7f8894'];

  const svg = (name, attributes = {}, ...children) => {
    const made = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  };
  const element = (name, attributes = {}, ...children) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  };

  // Four significant digits, thousands as they are.
  const number = (value) =>
    Number.isInteger(value) ? value.toLocaleString('en').replaceAll(',', '\u202f') : String(Number(value.toPrecision(4)));

  // Round numbers in [low, high], about so many.
  const ticks = (low, high, count, whole) => {
    if (!(high > low)) return [low];
    const rough = (high - low) / Math.max(1, count);
    const power = 10 ** Math.floor(Math.log10(rough));
    let step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough * 0.999);
    if (whole) step = Math.max(1, Math.round(step));
    const all = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) all.push(Number((k * step).toPrecision(12)));
    return all;
  };
  const short = (value) => Math.abs(value) >= 10000 ? number(value / 1000) + 'k' : number(value);

  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const lookOfPage = { text: 'var(--muted)', grid: 'var(--line)', paper: 'var(--card)', font: 12 };
  const lookOfFile = { text: '#444', grid: '#ddd', paper: '#fff', font: 12 };

  const colorsOf = (chart) => chart.series.map((series, k) => series.color !== undefined ? palette[series.color]
    : series.kind === 'best' ? palette[0] : series.kind === 'points' ? palette[1]
      : series.kind === 'edges' ? [palette[7], palette[0]][k] : palette[k % palette.length]);

  // From where up most robots of a chart are: a few that are far below would flatten the others.
  // What lies lower than three times the middle half's width below it is out of sight, unless all
  // is asked for. The best are what an evolution is for: nothing is cut above.
  const mostFrom = (values) => {
    const sorted = values.sort((a, b) => a - b);
    const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
    const wide = at(0.75) - at(0.25);
    return sorted.length < 8 || !(wide > 0) ? -Infinity : at(0.25) - 3 * wide;
  };

  // What is in sight: x from a zoom or all of it, y from the rows within, and how many points
  // are below.
  const window_ = (chart) => {
    let [x0, x1] = chart.zoom ?? [Infinity, -Infinity];
    let y0 = Infinity, y1 = -Infinity;
    if (!chart.zoom) for (const [x] of chart.rows) { x0 = Math.min(x0, x); x1 = Math.max(x1, x); }
    const inSight = chart.rows.filter((row) => row[0] >= x0 && row[0] <= x1);
    const single = (series) => ['points', 'edges'].includes(series.kind);
    const robots = inSight.flatMap((row) => chart.series.map((series, k) => single(series) && chart.visible[k] ? row[k + 1][1] : null)).filter((value) => value !== null);
    const ends = inSight.flatMap((row) => chart.series.flatMap((series, k) => series.band && chart.visible[k] ? row[k + 1] : [])).filter((value) => value !== null);
    const least = chart.all ? -Infinity : mostFrom([...(robots.length ? robots : ends)]);
    const below = robots.filter((value) => value < least).length;
    for (const row of inSight) {
      chart.series.forEach((series, k) => {
        const [low, value, high] = row[k + 1];
        if (value === null || !chart.visible[k] || (single(series) && value < least)) return;
        y0 = Math.min(y0, value, low < least ? value : low); y1 = Math.max(y1, value, high);
      });
    }
    const bands = robots.length === 0 && ends.some((value) => value < y0);
    if (!(x1 > x0)) { x0 -= 1; x1 += 1; }
    if (y0 > y1) { y0 = 0; y1 = 1; }
    if (y0 === y1) { y0 -= 0.5; y1 += 0.5; }
    const pad = 0.05 * (y1 - y0);
    return { x0, x1, y0: y0 - pad, y1: y1 + pad, below, bands };
  };

  // An SVG of `chart`, and from values to its pixels.
  const plot = (chart, width, height, look) => {
    const colors = colorsOf(chart);
    const seen = window_(chart);
    const ticksY = ticks(seen.y0, seen.y1, (height - 50) / 38, false);
    const margin = { left: 31 + 7 * Math.max(3, ...ticksY.map((value) => short(value).length)), right: 20, top: 10, bottom: 40 };
    const inner = { width: width - margin.left - margin.right, height: height - margin.top - margin.bottom };
    const inset = chart.zoom ? 0 : 10;
    const x = (value) => margin.left + inset + (value - seen.x0) / (seen.x1 - seen.x0) * (inner.width - 2 * inset);
    const y = (value) => margin.top + (seen.y1 - value) / (seen.y1 - seen.y0) * inner.height;
    const place = (k) => k.toFixed(1);
    const picture = svg('svg', { xmlns: NS, viewBox: `0 0 ${width} ${height}`, width, height, 'font-size': look.font,
      'font-family': 'system-ui, "DejaVu Sans", Verdana, sans-serif', role: 'img', 'aria-label': `${chart.y} against ${chart.x}` });
    const clip = `clip-${++clips}`;
    picture.append(svg('clipPath', { id: clip }, svg('rect', { x: margin.left, y: margin.top - 4, width: inner.width, height: inner.height + 8 })));

    for (const value of ticksY) {
      picture.append(svg('line', { x1: margin.left, x2: width - margin.right, y1: place(y(value)), y2: place(y(value)), stroke: look.grid }));
      picture.append(svg('text', { x: margin.left - 7, y: place(y(value) + 4), 'text-anchor': 'end', fill: look.text, class: 'tick-y' }, short(value)));
    }
    for (const value of ticks(seen.x0, seen.x1, inner.width / 70, chart.whole)) {
      picture.append(svg('line', { x1: place(x(value)), x2: place(x(value)), y1: margin.top, y2: height - margin.bottom + 4, stroke: look.grid }));
      picture.append(svg('text', { x: place(x(value)), y: height - margin.bottom + 17, 'text-anchor': 'middle', fill: look.text, class: 'tick-x' }, short(value)));
    }
    picture.append(svg('text', { x: margin.left + inner.width / 2, y: height - 5, 'text-anchor': 'middle', fill: look.text }, chart.x));
    picture.append(svg('text', { transform: `translate(13 ${margin.top + inner.height / 2}) rotate(-90)`, 'text-anchor': 'middle', fill: look.text }, chart.y));

    const marks = svg('g', { 'clip-path': `url(#${clip})`, fill: 'none', 'stroke-linejoin': 'round' });
    const end = ([at, ...values]) => `${place(x(at))} ${place(y(values.find((value) => value[1] !== null)[1]))}`;
    for (const thick of [false, true]) {
      const lines = (chart.edges ?? []).filter((edge) => edge[2] === thick && chart.visible[thick ? 1 : 0]);
      if (lines.length) marks.append(svg('path', { d: lines.map(([from, to]) => `M${end(chart.rows[from])}L${end(chart.rows[to])}`).join(''),
        stroke: thick ? palette[0] : look.text, 'stroke-width': thick ? 3 : 1, 'stroke-opacity': thick ? 1 : 0.35 }));
    }
    chart.series.forEach((series, k) => {
      if (!chart.visible[k] || series.kind === 'edges') return;
      const points = chart.rows.map((row) => ({ x: x(row[0]), spread: row[k + 1] })).filter(({ spread }) => spread[1] !== null)
        .map(({ x, spread }) => ({ x, y: y(spread[1]), low: y(spread[0]), high: y(spread[2]) }));
      const step = series.kind === 'step';
      const path = (of) => points.map((p, n) => n === 0 ? `M${place(p.x)} ${place(of(p))}`
        : step ? `H${place(p.x)}V${place(of(p))}` : `L${place(p.x)} ${place(of(p))}`).join('');
      if (series.band && points.length > 1) {
        const corners = (of) => points.flatMap((p, n) => [...(step && n ? [`${place(p.x)} ${place(of(points[n - 1]))}`] : []), `${place(p.x)} ${place(of(p))}`]);
        const up = corners((p) => p.high), down = corners((p) => p.low).reverse();
        marks.append(svg('path', { d: 'M' + [...up, ...down].join('L') + 'z', fill: colors[k], 'fill-opacity': 0.16 }));
      }
      if (series.kind === 'points' || series.kind === 'best') {
        const size = series.kind === 'best' ? 6 : 3.2;
        for (const p of points) marks.append(svg('circle', { cx: place(p.x), cy: place(p.y), r: size, fill: colors[k],
          ...(series.kind === 'best' ? { stroke: look.paper, 'stroke-width': 1.5 } : { 'fill-opacity': 0.75 }) }));
        return;
      }
      marks.append(svg('path', { d: path((p) => p.y), stroke: colors[k], 'stroke-width': series.kind === 'thick' ? 4 : series.thin ? 1 : 2 }));
      if (points.length === 1 || (series.kind === 'line' && points.length < 80))
        for (const p of points) marks.append(svg('circle', { cx: place(p.x), cy: place(p.y), r: 2.4, fill: colors[k] }));
    });
    picture.append(marks);
    return { picture, x, y, margin, seen };
  };

  // ---- tables of colours --------------------------------------------------------------
  // {"kind": "heat", "x", "y": titles, "columns", "lines": their names, from the top, or
  // "ends": [those of the columns, those of the lines], "cells": [[value or null]..],
  // "robots": [[id or null]..], "diverging", "value": what it is}

  const heatColor = (share, diverging) => {
    const ramp = diverging
      ? [[33, 102, 172], [146, 197, 222], [240, 240, 238], [244, 165, 100], [178, 64, 15]]
      : [[68, 30, 110], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
    const at = Math.min(0.9999, Math.max(0, share)) * (ramp.length - 1);
    const k = Math.floor(at);
    return `rgb(${ramp[k].map((from, c) => Math.round(from + (ramp[k + 1][c] - from) * (at - k))).join()})`;
  };

  // Black or white, whichever stands out more.
  const inkOn = (color) => {
    const light = color.match(/\d+/g).map((v) => v / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
      .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
    return light > 0.179 ? '#000' : '#fff';
  };

  // A scale for several tables of colours, as a gradient with its ends.
  const scale = (widest) => {
    const stops = [0, 0.25, 0.5, 0.75, 1].map((at) => `${heatColor(at, true)} ${100 * at}%`).join();
    const bar = element('span', { class: 'gradient' });
    bar.style.background = `linear-gradient(to right, ${stops})`;
    return [element('span', {}, '\u2212' + Number(widest.toPrecision(2))), bar, element('span', {}, '+' + Number(widest.toPrecision(2)))];
  };

  const heat = (chart, width, look) => {
    const lines = chart.cells.length, columns = chart.cells[0].length;
    // Titles of features are longer than a map of few bins is high.
    const left = 44, top = chart.ends ? 26 : 6, right = chart.widest ? 8 : 58, bottom = 38;
    const side = Math.min(44, (width - left - right) / columns);
    const tall = Math.min(side, 30);
    const height = top + bottom + tall * lines;
    const values = chart.cells.flat().filter((value) => value !== null);
    let low = Math.min(...values), high = Math.max(...values);
    if (chart.diverging) { high = (chart.widest ?? Math.max(Math.abs(low), Math.abs(high))) || 1; low = -high; }
    // A few that are far off have the colour at the end.
    const least = chart.diverging ? low : mostFrom([...values]);
    const beyond = low < least;
    low = Math.max(low, least);
    if (low === high) { low -= 0.5; high += 0.5; }
    const share = (value) => (value - low) / (high - low);
    const picture = svg('svg', { xmlns: NS, viewBox: `0 0 ${width} ${height}`, width, height, 'font-size': look.font,
      'font-family': 'system-ui, "DejaVu Sans", Verdana, sans-serif', role: 'img', 'aria-label': `${chart.value} by ${chart.x} and ${chart.y}` });
    const cells = [];
    const ends = chart.ends?.map((axis) => axis.map((end) => Number(end.toPrecision(4))));
    const range = (axis, k) => `${Math.min(axis[k], axis[k + 1])} to ${Math.max(axis[k], axis[k + 1])}`;
    chart.cells.forEach((row, r) => row.forEach((value, c) => {
      const box = svg('rect', { x: left + c * side, y: top + r * tall, width: side - 1.5, height: tall - 1.5, rx: 2,
        fill: value === null ? look.grid : heatColor(share(value), chart.diverging), 'fill-opacity': value === null ? 0.4 : 1 });
      const place = ends
        ? [[chart.x, c], [chart.y, r]].filter(([title]) => title).map(([title, k], axis) => `${title}: ${range(ends[axis], k)}`).join('; ')
        : `${chart.columns[c]} ${chart.x}, ${chart.lines[r]} ${chart.y}`;
      const count = chart.counts?.[r][c];
      const robots = count === undefined ? '' : ` (${count} robot${count === 1 ? '' : 's'})`;
      const said = `${place}: ${value === null ? count ? 'too few robots' : 'no robot' : number(value)}${value === null && !count ? '' : robots}`;
      box.append(svg('title', {}, said));
      cells.push({ box, id: chart.robots?.[r]?.[c], said });
      picture.append(box);
      if (count && side >= 17)
        picture.append(svg('text', { x: left + (c + 0.5) * side - 0.75, y: top + (r + 0.5) * tall + 3, 'text-anchor': 'middle', 'font-size': 9,
          fill: value === null ? look.text : inkOn(heatColor(share(value), chart.diverging)), 'pointer-events': 'none' }, count));
    }));
    // Names stand in the middle of a cell, the ends of ranges at its borders.
    const [across, down, middle] = ends ? [...ends, 0] : [chart.columns, chart.lines, 0.5];
    const every = Math.ceil((ends ? 36 : 22) / side);
    across.forEach((name, c) => { if (c % every === 0) picture.append(svg('text', { x: left + (c + middle) * side, y: height - bottom + 15, 'text-anchor': 'middle', fill: look.text }, name)); });
    down.forEach((name, r) => { if (r % Math.ceil(12 / tall) === 0) picture.append(svg('text', { x: left - 6, y: top + (r + middle) * tall + 4, 'text-anchor': 'end', fill: look.text }, name)); });
    picture.append(svg('text', { x: left + side * columns / 2, y: height - 4, 'text-anchor': 'middle', fill: look.text }, chart.x));
    const aside = { transform: `translate(11 ${top + tall * lines / 2}) rotate(-90)`, 'text-anchor': 'middle', fill: look.text };
    picture.append(svg('text', ends ? { x: 4, y: 12, fill: look.text } : aside, chart.y));
    if (chart.widest) return { picture, cells };  // one scale beside all of them
    const bar = { x: left + side * columns + 10, height: tall * lines - 2 };
    for (let k = 0; k < 24; ++k)
      picture.append(svg('rect', { x: bar.x, y: top + bar.height * (1 - (k + 1) / 24), width: 9, height: bar.height / 24 + 0.6, fill: heatColor((k + 0.5) / 24, chart.diverging) }));
    for (const [value, place, sign] of [[high, top + 9, ''], [low, top + bar.height, beyond ? '\u2264 ' : '']])
      picture.append(svg('text', { x: bar.x + 13, y: place, fill: look.text, 'font-size': look.font - 1 }, sign + (chart.diverging && value > 0 ? '+' : '') + Number(value.toPrecision(2))));
    return { picture, cells };
  };

  // ---- a chart in its place -------------------------------------------------------------

  const save = (name, type, text) => {
    const link = element('a', { download: name, href: URL.createObjectURL(new Blob([text], { type })) });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const svgFile = (chart) => new XMLSerializer().serializeToString(
    chart.kind === 'heat' ? heat(chart, 480, lookOfFile).picture : withLegend(chart, plot(chart, 720, 420, lookOfFile).picture));
  const withLegend = (chart, picture) => {
    let at = 60;
    chart.series.forEach((series, k) => {
      if (!chart.visible[k]) return;
      picture.append(svg('rect', { x: at, y: 2, width: 10, height: 4, fill: colorsOf(chart)[k] }));
      picture.append(svg('text', { x: at + 14, y: 9, fill: '#444', 'font-size': 11 }, chart.labels[k + 1]));
      at += 26 + 6.2 * chart.labels[k + 1].length;
    });
    return picture;
  };
  const csvFile = (chart) => {
    const quoted = (text) => `"${String(text).replaceAll('"', '""')}"`;
    if (chart.kind === 'heat')
      return [[chart.y + ' \\ ' + chart.x, ...chart.columns], ...chart.cells.map((row, r) => [chart.lines[r], ...row.map((v) => v ?? '')])]
        .map((row) => row.map(quoted).join()).join('\n') + '\n';
    const head = [chart.x];
    chart.series.forEach((series, k) => { head.push(chart.labels[k + 1]); if (series.band) head.push(`low (${series.band})`, `high (${series.band})`); });
    if (chart.robots) head.push('robot');
    const rows = chart.rows.map((row, n) => {
      const cells = [row[0]];
      chart.series.forEach((series, k) => { const [low, value, high] = row[k + 1]; cells.push(value ?? ''); if (series.band) cells.push(low ?? '', high ?? ''); });
      if (chart.robots) cells.push(chart.robots[n]);
      return cells;
    });
    return [head, ...rows].map((row) => row.map(quoted).join()).join('\n') + '\n';
  };

  const thumbnail = (id) => {
    const picture = svg('svg', { class: 'body', 'aria-hidden': 'true' });
    picture.append(svg('use', { href: '#b-' + id }));
    return picture;
  };

  const tools = (chart, name) => {
    const buttons = element('span', { class: 'tools' });
    for (const [label, type, make] of [['SVG', 'image/svg+xml', svgFile], ['CSV', 'text/csv', csvFile]]) {
      const button = element('button', { type: 'button', 'aria-label': `Save ${name} as ${label}` }, label);
      button.addEventListener('click', () => save(`${name}.${label.toLowerCase()}`, type, make(chart)));
      buttons.append(button);
    }
    return buttons;
  };

  const readout = (chart, row) => {
    const id = (chart.robots || [])[row];
    const parts = id ? [thumbnail(id), element('span', { class: 'id' }, id)] : [];
    const values = chart.rows[row];
    parts.push(element('span', {}, chart.x + ' ', element('b', {}, number(chart.whole ? Math.round(values[0]) : values[0]))));
    chart.series.forEach((series, k) => {
      const [low, value, high] = values[k + 1];
      if (value === null || !chart.visible[k] || series.kind === 'best') return;
      const name = ['points', 'edges'].includes(series.kind) ? chart.y : chart.labels[k + 1];
      const spread = series.band && low !== high ? ` (${number(low)} to ${number(high)})` : '';
      parts.push(element('span', {}, name + ' ', element('b', {}, number(value)), spread));
    });
    return parts;
  };

  const all = new Set();

  // Draws `chart` into `holder`; `open(id)` is called for a robot that is clicked on.
  const draw = (holder, chart, open, name) => {
    const small = holder.classList.contains('small');
    const says = element('div', { class: 'readout', 'aria-live': 'polite' });
    if (chart.kind === 'heat') {
      const place = element('div', { class: 'heat' });
      const redraw = (width = holder.clientWidth) => {
        const { picture, cells } = heat(chart, width, lookOfPage);
        for (const { box, id, said } of cells) {
          if (!id) continue;
          box.setAttribute('class', 'pick');
          box.addEventListener('mouseenter', () => says.replaceChildren(thumbnail(id), element('span', {}, said)));
          box.addEventListener('click', () => open(id));
        }
        place.replaceChildren(picture);
      };
      holder.append(place, says, tools(chart, name));
      all.add({ redraw, holder });
      redraw();
      return;
    }

    const hint = matchMedia('(hover: hover)').matches
      ? 'Hover for values, drag to zoom, double-click to see all.' : 'Tap for values.';
    // Outliers that are out of sight are spoken of, and there for the asking.
    const quiet = () => {
      const { below, bands } = drawn?.seen ?? {};
      const parts = bands ? ['bands go below what is shown'] : [];
      if (below) parts.push(`${below} point${below === 1 ? '' : 's'} below what is shown`);
      const all = element('button', { type: 'button', class: 'outliers' }, chart.all ? 'Without outliers' : 'Show them');
      all.addEventListener('click', () => { chart.all = !chart.all; redraw(); quiet(); holder.querySelector('.outliers')?.focus(); });
      says.replaceChildren(...(parts.length ? [element('span', {}, parts.join(', ')), all] : chart.all ? [all] : []), ...(small ? [] : [hint]));
    };
    chart.visible ??= chart.series.map((series) => !series.off);
    const box = element('div', { class: 'plot', tabindex: 0, role: 'group', 'aria-label': `${chart.y} against ${chart.x}; arrow keys read values` });
    let drawn, at = null;
    const cursor = svg('g', { class: 'cursor', 'pointer-events': 'none' });
    const redraw = (width = box.clientWidth) => {
      drawn = plot(chart, width, small ? 210 : 300, lookOfPage);
      drawn.picture.append(cursor);
      box.replaceChildren(drawn.picture);
    };
    const point = (row) => {
      at = row;
      const { x, y, margin } = drawn;
      cursor.replaceChildren();
      if (row === null) return quiet();
      const values = chart.rows[row];
      if (!chart.robots) cursor.append(svg('line', { x1: x(values[0]), x2: x(values[0]), y1: margin.top, y2: (small ? 210 : 300) - margin.bottom, stroke: 'var(--muted)', 'stroke-dasharray': '3 3' }));
      chart.series.forEach((series, k) => {
        if (values[k + 1][1] === null || !chart.visible[k]) return;
        cursor.append(svg('circle', { cx: x(values[0]), cy: y(values[k + 1][1]), r: 5, fill: 'none', stroke: 'var(--text)', 'stroke-width': 1.5 }));
      });
      says.replaceChildren(...readout(chart, row));
    };
    // The row nearest to the pointer: along x, and where rows are robots in both.
    const nearest = (event) => {
      const { left, top } = box.getBoundingClientRect();
      const px = event.clientX - left, py = event.clientY - top;
      let best = null, least = Infinity;
      chart.rows.forEach((row, n) => {
        if (row[0] < drawn.seen.x0 || row[0] > drawn.seen.x1) return;
        const dx = drawn.x(row[0]) - px;
        chart.series.forEach((series, k) => {
          if (row[k + 1][1] === null || !chart.visible[k]) return;
          const dy = chart.robots && ['points', 'edges'].includes(series.kind) ? drawn.y(row[k + 1][1]) - py : 0;
          const distance = dx * dx + dy * dy;
          if (distance < least) { least = distance; best = n; }
        });
      });
      return best;
    };
    let start = null, moved = false;
    const band = svg('rect', { y: 0, height: 1000, fill: 'var(--muted)', 'fill-opacity': 0.18 });
    const across = (event) => event.clientX - box.getBoundingClientRect().left;
    const value = (px) => {
      const [a, b] = [drawn.x(0), drawn.x(1)];
      return (px - a) / (b - a);
    };
    box.addEventListener('pointerdown', (event) => { if (event.pointerType === 'mouse') { start = across(event); moved = false; } });
    box.addEventListener('pointermove', (event) => {
      if (start !== null && Math.abs(across(event) - start) > 5) {
        moved = true;
        const [a, b] = [start, across(event)].sort((p, q) => p - q);
        band.setAttribute('x', a);
        band.setAttribute('width', b - a);
        drawn.picture.append(band);
      } else if (start === null) point(nearest(event));
    });
    box.addEventListener('pointerleave', () => { start = null; band.remove(); point(null); });
    box.addEventListener('pointerup', (event) => {
      band.remove();
      if (start !== null && moved) {
        const [a, b] = [value(start), value(across(event))].sort((p, q) => p - q);
        if (chart.rows.some((row) => row[0] >= a && row[0] <= b)) chart.zoom = [a, b];
        redraw();
      }
      start = null;
    });
    box.addEventListener('click', (event) => {
      const row = nearest(event);
      point(row);
      if (!moved && chart.robots && row !== null && matchMedia('(hover: hover)').matches) open(chart.robots[row]);
      moved = false;
    });
    const seeAll = () => { chart.zoom = undefined; redraw(); };
    box.addEventListener('dblclick', seeAll);
    box.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (step) {
        event.preventDefault();
        point(at === null ? (step > 0 ? 0 : chart.rows.length - 1) : Math.min(chart.rows.length - 1, Math.max(0, at + step)));
      } else if (event.key === 'Escape') seeAll();
      else if (event.key === 'Enter' && at !== null && chart.robots) open(chart.robots[at]);
    });

    const colors = colorsOf(chart);
    const toggles = element('div', { class: 'series' });
    chart.series.forEach((series, k) => {
      const tick = element('input', { type: 'checkbox' });
      tick.checked = chart.visible[k];
      const label = element('label', {}, tick, chart.labels[k + 1] + (series.band ? ` (${series.band})` : ''));
      label.style.setProperty('--series', colors[k]);
      label.classList.toggle('off', !tick.checked);
      tick.addEventListener('change', () => {
        chart.visible[k] = tick.checked;
        label.classList.toggle('off', !tick.checked);
        redraw();
      });
      toggles.append(label);
    });
    const last = tools(chart, name);
    if (!small) {
      const reset = element('button', { type: 'button' }, 'See all');
      reset.addEventListener('click', seeAll);
      last.prepend(reset);
    }
    if (!small) toggles.append(last);
    holder.append(...(small ? [] : [toggles]), box, says, ...(small ? [last] : []));
    redraw();
    quiet();
    all.add({ redraw, holder });
  };

  const redrawAll = (width) => { for (const { redraw, holder } of all) if (holder.isConnected && holder.offsetWidth > 0) redraw(width); };
  addEventListener('resize', () => redrawAll());
  return { draw, redrawAll, scale, element, svg, number, thumbnail, css };
})();

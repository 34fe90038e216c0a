// What charts say of their points: they are drawn by evo-report, their values are beside them
// (figures.h). And what every script of the page needs.
'use strict';
const Charts = (() => {
  const NS = 'http://www.w3.org/2000/svg';
  const made = (node, attributes, children) => {
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.append(...children);
    return node;
  };
  const svg = (name, attributes = {}, ...children) => made(document.createElementNS(NS, name), attributes, children);
  const element = (name, attributes = {}, ...children) => made(document.createElement(name), attributes, children);

  // With a true minus, thousands apart.
  const number = (value, decimals) => {
    const [whole, part] = Math.abs(value).toFixed(decimals).split('.');
    const text = whole.replace(/\B(?=(\d{3})+$)/g, whole.length > 4 ? '\u202f' : '') + (part ? '.' + part : '');
    return (value < 0 && Number(text.replaceAll('\u202f', '')) !== 0 ? '\u2212' : '') + text;
  };
  // Of an axis: as many digits as can be told apart on it.
  const onAxis = (value, low, high) => number(value, Number.isInteger(value) ? 0 : Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(high - low)))));

  // ---- bodies ---------------------------------------------------------------------------

  // Each once for the whole page, when it is needed; voxels of a kind are one path.
  const bodies = new Map(), drawn = new Map();
  const symbol = (id) => {
    const { body, open } = bodies.get(id);
    const rows = body.split('/'), columns = rows[0].length;
    const paths = ['R', 'S', 'H', 'V'].map((kind) => [kind, rows.flatMap((row, r) =>
      [...row.matchAll(new RegExp(kind + '+', 'g'))].map((run) => `M${run.index} ${r}.5h${run[0].length}`)).join('')]);
    const grid = rows.slice(1).map((_, r) => `M0 ${r + 1}h${columns}`).join('') + [...rows[0].slice(1)].map((_, c) => `M${c + 1} 0v${rows.length}`).join('');
    const viewBox = `0 0 ${columns} ${rows.length}`;
    document.querySelector('.symbols').append(svg('symbol', { id: 'b-' + id, viewBox }, ...[...paths, ['grid', grid], ['open', open]].filter(([, d]) => d).map(([kind, d]) => svg('path', { class: kind, d }))));
    drawn.set(id, viewBox);
    return viewBox;
  };
  const thumbnail = (id) => svg('svg', { class: 'body', 'aria-hidden': 'true', viewBox: drawn.get(id) ?? symbol(id) }, svg('use', { href: '#b-' + id }));

  // ---- values of a chart ----------------------------------------------------------------

  // `robots`: of its run, [id, what the page knows]; `link(id)`: to a card.
  const attach = (holder, chart, robots, link) => {
    const picture = holder.querySelector('svg');
    const [left, top, width, height] = chart.frame, [x0, x1, y0, y1] = chart.range;
    const points = chart.series.flatMap((series) => series.x.map((x, k) => {
      const [id, robot] = robots[series.robots?.[k]] ?? [];
      const y = series.y?.[k] ?? robot.fitness;
      return { series, k, x, y, id, left: left + (x - x0) / (x1 - x0) * width, top: top + Math.min(1, (y1 - y) / (y1 - y0)) * height };
    }));
    const byX = Map.groupBy(points, ({ x }) => x);
    const says = element('div', { class: 'readout', 'aria-live': 'polite' });
    const cursor = svg('g', { class: 'cursor' });
    picture.append(cursor);
    picture.setAttribute('tabindex', 0);
    holder.append(says);
    let at = null;
    const value = ({ series, k, x, y }) => {
      if (series.says) return [element('span', {}, series.says[k])];
      const spread = series.low && series.low[k] !== series.high[k] ? ` (${onAxis(series.low[k], y0, y1)} to ${onAxis(series.high[k], y0, y1)})` : '';
      return [element('span', {}, (series.robots || !series.name ? chart.y : series.name) + ' ', element('b', {}, onAxis(y, y0, y1)), spread)];
    };
    const point = (found) => {
      at = found;
      cursor.replaceChildren();
      says.replaceChildren();
      if (!found) return;
      // Beside a robot, curves at the same place.
      const shown = found.series.says ? [found] : [found, ...byX.get(found.x).filter(({ series }) => series !== found.series && !series.says && !(found.id && series.robots))];
      cursor.append(...shown.map((p) => svg('circle', { cx: p.left, cy: p.top, r: 5 })));
      says.append(...(found.id ? [link(found.id)] : []),
        ...(found.series.says ? [] : [element('span', {}, chart.x + ' ', element('b', {}, onAxis(found.x, x0, x1)))]), ...shown.flatMap(value));
    };
    const nearest = (event) => {
      const box = picture.getBoundingClientRect(), scale = picture.viewBox.baseVal.width / box.width;
      const px = (event.clientX - box.left) * scale, py = (event.clientY - box.top) * scale;
      let best = null, least = Infinity;
      for (const p of points) {
        const up = p.series.robots || p.series.says ? p.top - py : 0.2 * (p.top - py);  // of curves, along x
        const distance = (p.left - px) ** 2 + up ** 2;
        if (distance < least) { least = distance; best = p; }
      }
      return best;
    };
    picture.addEventListener('pointermove', (event) => point(nearest(event)));
    picture.addEventListener('pointerleave', () => point(null));
    picture.addEventListener('click', (event) => {
      point(nearest(event));
      if (at?.id && matchMedia('(hover: hover)').matches) link(at.id).click();
    });
    const along = [...points].sort((a, b) => a.x - b.x);
    picture.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (step) {
        event.preventDefault();
        point(along[Math.min(along.length - 1, Math.max(0, along.indexOf(at) + step))]);
      } else if (event.key === 'Enter' && at?.id) link(at.id).click();
    });
  };

  // A small curve of a robot's card, [[x, y]..], with its ends in numbers.
  const spark = (name, points, decimals) => {
    const xs = points.map(([x]) => x), ys = points.map(([, y]) => y).filter((y) => y !== null);
    const low = Math.min(...ys), high = Math.max(...ys), last = Math.max(...xs);
    const place = ([x, y]) => `${(4 + 232 * x / (last || 1)).toFixed(1)} ${(66 - 60 * (y - low) / (high - low || 1)).toFixed(1)}`;
    const line = svg('path', { class: 'spark', d: 'M' + points.filter(([, y]) => y !== null).map(place).join('L') + 'h0' });
    return element('figure', {}, element('figcaption', {}, element('b', {}, name), ` ${number(low, decimals)} to ${number(high, decimals)}, in ${number(last, 0)} steps`),
      svg('svg', { viewBox: '0 0 240 70', role: 'img', 'aria-label': `${name} against training steps` }, line));
  };

  return { attach, bodies, symbol, spark, element, svg, number, thumbnail };
})();

// What moves on the page: charts that can be hovered over and zoomed into, their
// series to choose from, tables that can be sorted.
'use strict';
(() => {
  const palette = ['#d9730d', '#2f86c9', '#2b9a66', '#9a63c9', '#d0456b', '#8a7a17', '#17989c', '#7f8894'];
  const faint = 'rgba(128, 138, 150, 0.28)';
  const charts = JSON.parse(document.getElementById('charts').textContent);
  const drawn = [];

  const element = (name, attributes = {}, ...children) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  };

  // Four significant digits, thousands as they are.
  const number = (value) =>
    Number.isInteger(value) ? value.toLocaleString('en').replaceAll(',', '\u202f') : String(Number(value.toPrecision(4)));

  const thumbnail = (id) => {
    const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    const use = document.createElementNS('http://www.w3.org/2000/svg', 'use');
    svg.setAttribute('class', 'body');
    use.setAttribute('href', '#b-' + id);
    svg.append(use);
    return svg;
  };

  // ---- charts ---------------------------------------------------------------------

  const looks = {
    line: { strokeWidth: 2, drawPoints: true, pointSize: 2.5 },
    thick: { strokeWidth: 5 },
    step: { strokeWidth: 2, stepPlot: true },
    points: { strokeWidth: 0, drawPoints: true, pointSize: 3 },
    best: { strokeWidth: 0, drawPoints: true, pointSize: 6 },
  };

  // Fingers scroll the page; two of them zoom.
  const touches = () => {
    const model = Object.assign({}, Dygraph.defaultInteractionModel);
    for (const name of ['touchstart', 'touchmove', 'touchend']) {
      const original = model[name];
      model[name] = (event, graph, context) => {
        const two = event.touches.length > 1;
        if (two || context.twoFingers) original(event, graph, context);
        context.twoFingers = two;
      };
    }
    return model;
  };

  const tick = (whole) => (value, granularity, options, graph) => {
    if (whole && !Number.isInteger(value)) return '';
    return Math.abs(value) >= 10000 ? number(value / 1000) + 'k' : number(Number(value.toPrecision(8)));
  };

  const readout = (chart, row) => {
    const id = (chart.robots || [])[row];
    const parts = id ? [thumbnail(id), element('span', { class: 'id' }, id)] : [];
    const values = chart.rows[row];
    parts.push(element('span', {}, chart.x + ' ', element('b', {}, number(values[0]))));
    chart.series.forEach((series, k) => {
      const [low, value, high] = values[k + 1];
      if (value === null || !chart.visible[k] || series.kind === 'best') return;
      const name = series.kind === 'points' ? chart.y : chart.labels[k + 1];
      const spread = series.band && low !== high ? ` (${number(low)} to ${number(high)})` : '';
      parts.push(element('span', {}, name + ' ', element('b', {}, number(value)), spread));
    });
    return parts;
  };

  const draw = (holder) => {
    const chart = charts[holder.dataset.chart];
    if (!chart || chart.rows.length === 0) return;
    const small = holder.classList.contains('small');
    const plot = element('div', { class: 'plot' });
    const says = element('div', { class: 'readout', 'aria-live': 'polite' });
    const hint = matchMedia('(hover: hover)').matches
      ? 'Hover for values, drag to zoom, double-click to see all.'
      : 'Tap for values, two fingers zoom.';
    const quiet = () => says.replaceChildren(small ? '' : hint);
    quiet();

    chart.visible = chart.series.map((series) => !series.off);
    const colors = chart.series.map((series, k) =>
      series.kind === 'points' ? '#2f86c9' : palette[k % palette.length]);
    if (chart.series.some((series) => series.kind === 'best')) colors[1] = palette[0];
    const options = {};
    chart.series.forEach((series, k) => { options[chart.labels[k + 1]] = looks[series.kind]; });
    const scattered = Boolean(chart.robots);
    const xs = chart.rows.map((row) => row[0]);

    const toggles = element('div', { class: 'series' });
    holder.append(...(small ? [] : [toggles]), plot, says);
    const graph = new Dygraph(plot, chart.rows, {
      labels: chart.labels, customBars: true, series: options, colors,
      visibility: chart.visible.slice(), legend: 'never', fillAlpha: 0.18,
      xlabel: chart.x, ylabel: chart.y, xLabelHeight: 18, yLabelWidth: 18,
      gridLineColor: faint, axisLineColor: faint, gridLineWidth: 1,
      xRangePad: 18, yRangePad: 14, animatedZooms: false, highlightCircleSize: 4,
      ...(scattered ? { highlightSeriesOpts: { highlightCircleSize: 6 }, highlightSeriesBackgroundAlpha: 1 } : {}),
      ...(xs[0] === xs[xs.length - 1] ? { dateWindow: [xs[0] - (xs[0] || 1), 2 * xs[0] + (xs[0] ? 0 : 1)] } : {}),
      axes: {
        x: { axisLabelFormatter: tick(chart.whole), pixelsPerLabel: small ? 44 : 60, axisLabelFontSize: 12 },
        y: { axisLabelFormatter: tick(false), axisLabelWidth: 46, axisLabelFontSize: 12, pixelsPerLabel: 34 },
      },
      interactionModel: touches(),
      highlightCallback: (event, x, points, row) => says.replaceChildren(...readout(chart, row)),
      unhighlightCallback: quiet,
      pointClickCallback: (event, point) => {
        if (scattered) location.hash = holder.dataset.run + '-' + chart.robots[point.idx];
      },
    });
    drawn.push(graph);

    chart.series.forEach((series, k) => {
      const box = element('input', { type: 'checkbox' });
      box.checked = chart.visible[k];
      const label = element('label', {}, box, chart.labels[k + 1] + (series.band ? ` (${series.band})` : ''));
      label.style.setProperty('--series', colors[k]);
      label.classList.toggle('off', !box.checked);
      box.addEventListener('change', () => {
        chart.visible[k] = box.checked;
        label.classList.toggle('off', !box.checked);
        graph.setVisibility(k, box.checked);
      });
      toggles.append(label);
    });
    const reset = element('button', { type: 'button' }, 'See all');
    reset.addEventListener('click', () => graph.resetZoom());
    toggles.append(reset);
  };

  // Paper is narrower than a screen, and what is drawn on a canvas now would not be
  // printed: pictures of the charts stand in for them.
  const beforePrint = () => {
    document.body.classList.add('printing');
    for (const graph of drawn) graph.resize();
    for (const canvas of document.querySelectorAll('.plot canvas')) {
      const image = element('img', { class: 'frozen', style: canvas.style.cssText, decoding: 'sync' });
      image.src = canvas.toDataURL();
      canvas.after(image);
    }
  };
  const afterPrint = () => {
    document.body.classList.remove('printing');
    for (const image of document.querySelectorAll('.frozen')) image.remove();
    for (const graph of drawn) graph.resize();
  };

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
      cell.replaceChildren(button);
      button.addEventListener('click', () => {
        const now = cell.getAttribute('aria-sort');
        const descending = now ? now === 'ascending' : cell.dataset.sort === 'descending';
        sort(table, column, descending);
      });
    });
  };

  // Runs of a comparison are folded; their charts are drawn when they have a size.
  const drawVisible = () => document.querySelectorAll('[data-chart]').forEach((holder) => {
    if (holder.offsetWidth > 0 && !holder.hasChildNodes()) draw(holder);
  });
  const unfold = () => {
    const target = document.getElementById(location.hash.slice(1));
    const fold = target && target.closest('details');
    if (!fold || fold.open) return;
    fold.open = true;
    target.scrollIntoView();
  };

  drawVisible();
  document.querySelectorAll('details').forEach((fold) => fold.addEventListener('toggle', drawVisible));
  addEventListener('hashchange', unfold);
  unfold();
  document.querySelectorAll('table.sortable').forEach(sortable);
  addEventListener('beforeprint', beforePrint);
  addEventListener('afterprint', afterPrint);
})();

// YAML as libevo asks for it (bindings/web/wasm/yaml.cpp): a tree in which every value
// has its place, from the events of js-yaml. What is not text, list or mapping stays text: the
// reader of the tools decides what a number is.
//   {"documents": [tree..]}, or {"error", "line", "column"}; lines and columns from 1
//   tree: ["null", line, column], ["scalar", line, column, text, without quotes or tag],
//         ["sequence", line, column, [tree..]], ["mapping", line, column, [[key, value]..]]
'use strict';
(typeof globalThis.Evo === 'object' ? globalThis.Evo : (globalThis.Evo = {})).readYaml = (text) => {
  const starts = [0];
  for (let at = text.indexOf('\n'); at >= 0; at = text.indexOf('\n', at + 1)) starts.push(at + 1);
  const place = (at) => {
    let low = 0, high = starts.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (starts[middle] <= at) low = middle; else high = middle - 1;
    }
    return [low + 1, at - starts[low] + 1];
  };
  // Where a value begins: after blanks, line ends and comments.
  const skip = (at) => {
    for (;;) {
      while (at < text.length && ' \t\r\n'.includes(text[at])) ++at;
      if (text[at] !== '#') return at;
      while (at < text.length && text[at] !== '\n') ++at;
    }
  };

  const documents = [];
  const open = [];
  const finish = (kind, node) => {
    const at = place(node.at);
    if (kind === 'sequence') return [kind, ...at, node.parts.map((part) => part.tree)];
    if (kind !== 'mapping') return kind === 'null' ? [kind, ...at] : [kind, ...at, node.text, node.plain];
    const entries = [];
    for (let k = 0; k < node.parts.length; ++k) {
      const key = node.parts[k];
      if (key.isKey && k + 1 < node.parts.length) entries.push([key.tree, node.parts[++k].tree]);
      else if (key.tree[0] !== 'null') entries.push([key.tree, ['null', ...place(key.end)]]);
    }
    return [kind, ...at, entries];
  };
  // [a: 1] is a list of one mapping, of which js-yaml tells the two values only.
  const pairsInList = (parts) => {
    const paired = [];
    for (let k = 0; k < parts.length; ++k) {
      if (!parts[k].isKey) { paired.push(parts[k]); continue; }
      const key = parts[k].tree, value = parts[k + 1]?.tree ?? ['null', ...place(parts[k].end)];
      paired.push({ tree: ['mapping', key[1], key[2], [[key, value]]] });
      ++k;
    }
    return paired;
  };
  const listener = (event, state) => {
    if (event === 'open') {
      open.push({ at: skip(state.position), parts: [] });
      return;
    }
    const node = open.pop();
    const after = skip(state.position);
    const end = state.position;
    if (text[node.at] === '*') throw new Problem('an alias is not read here; write its value out', node.at);
    const isKey = text[after] === ':';
    let part;
    if (node.parts.length === 1 && node.parts[0].at === node.at && node.parts[0].tree[0] !== 'null') {
      part = { ...node.parts[0], end, isKey };  // js-yaml looked for a mapping and found this
    } else {
      let kind = state.kind ?? 'null';
      if (kind === 'scalar') {
        node.text = String(state.result);
        node.plain = state.tag === '?';
        if (node.plain && ['~', 'null', 'Null', 'NULL', ''].includes(node.text)) kind = 'null';
      } else if (kind === 'sequence') {
        node.parts = pairsInList(node.parts);
        if (node.parts.length !== state.result.length) throw new Problem('an item of this list is empty', node.at);
      }
      part = { at: node.at, tree: finish(kind, node), end, isKey };
    }
    if (open.length) open[open.length - 1].parts.push(part);
    else documents.push(part.tree);
  };
  class Problem extends Error {
    constructor(reason, at) { super(reason); this.at = at; }
  }
  try {
    globalThis.jsyaml.loadAll(text, null, { schema: globalThis.jsyaml.FAILSAFE_SCHEMA, json: true, listener });
    return { documents };
  } catch (failure) {
    if (failure instanceof Problem) {
      const [line, column] = place(failure.at);
      return { error: failure.message, line, column };
    }
    if (failure.name !== 'YAMLException') throw failure;
    return { error: failure.reason, line: (failure.mark?.line ?? 0) + 1, column: (failure.mark?.column ?? 0) + 1 };
  }
};

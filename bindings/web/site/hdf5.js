// HDF5 as evo's tools write it (formats/io/hdf5.h), read in a page: what libhdf5 1.10 makes of
// groups and datasets whose creation order is tracked. After the HDF5 File Format Specification,
// version 3.0. Other layouts are refused in words, not guessed at.
//
// Evo.readHdf5(bytes): the root group. A group is {attributes: {name: text, number or array},
// children: Map of name to group or dataset}; a dataset {attributes, shape, read(): promise of
// a typed array, or an array of texts}. Integers of 64 bits become numbers, rounded beyond 2^53.
'use strict';
(() => {
  const Evo = typeof globalThis.Evo === 'object' ? globalThis.Evo : (globalThis.Evo = {});
  const refuse = (text) => { throw Object.assign(new Error(text), { name: 'Refusal' }); };
  const nowhere = 0xffffffffffffffffn;  // an address that is none
  const decoder = new TextDecoder();

  // A place in the file that moves on as it is read.
  class Cursor {
    constructor(bytes, at = 0) {
      if (!(at >= 0 && at <= bytes.length)) throw new RangeError('beyond the end');
      this.bytes = bytes;
      this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
      this.at = at;
    }
    skip(count) { this.at += count; return this; }
    u8() { return this.view.getUint8(this.at++); }
    u16() { this.at += 2; return this.view.getUint16(this.at - 2, true); }
    u32() { this.at += 4; return this.view.getUint32(this.at - 4, true); }
    u64() { this.at += 8; return Number(this.view.getBigUint64(this.at - 8, true)); }
    address() {
      this.at += 8;
      const value = this.view.getBigUint64(this.at - 8, true);
      return value === nowhere ? null : Number(value);
    }
    sized(count) {  // an integer of so many bytes
      let value = 0;
      for (let k = 0; k < count; ++k) value += this.u8() * 2 ** (8 * k);
      return value;
    }
    take(count) {
      if (!(count >= 0) || this.at + count > this.bytes.length) throw new RangeError('beyond the end');
      this.at += count;
      return this.bytes.subarray(this.at - count, this.at);
    }
    expect(signature) {
      const found = String.fromCharCode(...this.take(4));
      if (found !== signature) refuse(`where ${signature} should stand there is something else: it is damaged`);
      return this;
    }
  }
  const bytesFor = (value) => {  // of an integer as large as this
    let bytes = 1;
    while (value >= 256 ** bytes) ++bytes;
    return bytes;
  };

  class File {
    constructor(bytes) { this.bytes = bytes; }
    cursor(at) { return new Cursor(this.bytes, at); }

    rootAddress() {
      const version = this.bytes[8];
      if (version > 3) refuse(`its superblock has version ${version}, which this page does not read`);
      const widths = this.cursor(version < 2 ? 13 : 9);
      if (widths.u8() !== 8 || widths.u8() !== 8) refuse('its addresses are not of 64 bits');
      return this.cursor(version < 2 ? 64 : 36).u64();
    }

    // ---- object headers ------------------------------------------------------------------

    messages(at) {
      const start = this.cursor(at).expect('OHDR');
      if (start.u8() !== 2) refuse('its object headers are of an older version');
      const flags = start.u8();
      if (flags & 0x20) start.skip(16);  // times
      if (flags & 0x10) start.skip(4);   // when attributes leave the header
      const found = [];
      const room = start.sized(1 << (flags & 3));
      const blocks = [[start.at, room]];
      for (let block = 0; block < blocks.length && block < 4096; ++block) {
        const [from, length] = blocks[block];
        const cursor = this.cursor(from);
        while (cursor.at + 4 <= from + length) {
          const type = cursor.u8(), size = cursor.u16();
          cursor.skip(flags & 4 ? 3 : 1);
          const data = cursor.take(size);
          if (type === 0x10) {
            const next = new Cursor(data), to = next.u64(), size = next.u64();
            this.cursor(to).expect('OCHK');
            blocks.push([to + 4, size - 8]);  // without signature and checksum
          } else {
            found.push({ type, data });
          }
        }
      }
      return found;
    }

    object(at, depth = 0) {
      if (depth > 16) refuse('its groups lie in each other without end');
      const messages = this.messages(at);
      const of = (type) => messages.find((message) => message.type === type)?.data;
      const attributes = {};
      for (const data of [...messages.filter(({ type }) => type === 0x0c).map(({ data }) => data), ...this.dense(of(0x15), 2, 8)]) {
        const [name, value] = this.attribute(data);
        attributes[name] = value;
      }
      if (of(0x08)) return this.dataset(of, attributes);
      const children = new Map();
      for (const data of [...messages.filter(({ type }) => type === 0x06).map(({ data }) => data), ...this.dense(of(0x02), 8, 5)]) {
        const [name, to] = this.link(data);
        if (to !== null) children.set(name, this.object(to, depth + 1));
      }
      return { attributes, children };
    }

    link(data) {
      const cursor = new Cursor(data, 1);
      const flags = cursor.u8();
      const type = flags & 8 ? cursor.u8() : 0;
      if (flags & 4) cursor.skip(8);
      if (flags & 16) cursor.skip(1);
      const name = decoder.decode(cursor.take(cursor.sized(1 << (flags & 3))));
      return [name, type === 0 ? cursor.address() : null];  // soft and external ones lead nowhere
    }

    // ---- types and values -------------------------------------------------------------------

    type(data) {
      const cursor = new Cursor(data);
      const kind = cursor.u8() & 15, bits = cursor.u8(), more = cursor.skip(2).u32();
      const size = more;
      if (kind === 0) return { size, array: { 1: [Uint8Array, Int8Array], 2: [Uint16Array, Int16Array], 4: [Uint32Array, Int32Array], 8: [BigUint64Array, BigInt64Array] }[size]?.[bits & 8 ? 1 : 0] };
      if (kind === 1) return { size, array: { 4: Float32Array, 8: Float64Array }[size] };
      if (kind === 3) return { size, text: true };
      if (kind === 8) return { size, array: { 1: Uint8Array }[size] };  // true and false
      if (kind === 9 && (bits & 15) === 1) return { size, text: true, elsewhere: true };
      return { size };
    }
    shape(data) {
      const cursor = new Cursor(data);
      const version = cursor.u8(), rank = cursor.u8();
      cursor.skip(version === 1 ? 6 : 2);
      return Array.from({ length: rank }, () => cursor.u64());
    }
    values(type, bytes, count) {
      if (type.text) {
        return Array.from({ length: count }, (_, k) => {
          const own = bytes.subarray(k * type.size, (k + 1) * type.size);
          return decoder.decode(type.elsewhere ? this.heapObject(own) : own).replace(/\0.*$/s, '');
        });
      }
      if (!type.array) refuse('it holds a type of number that evo does not write');
      if (bytes.length < count * type.size) throw new RangeError('beyond the end');
      const values = new type.array(bytes.slice(0, count * type.size).buffer);
      return type.size === 8 && type.array !== Float64Array ? Float64Array.from(values, Number) : values;
    }
    // A text of any length, in a collection of them.
    heapObject(reference) {
      const cursor = new Cursor(reference);
      const length = cursor.u32(), at = cursor.address(), index = cursor.u32();
      if (at === null || length === 0) return new Uint8Array();
      const heap = this.cursor(at).expect('GCOL').skip(4);
      const end = at + heap.u64();
      while (heap.at + 16 <= end) {
        const found = heap.u16(), size = heap.skip(6).u64();
        if (found === index) return heap.take(size).subarray(0, length);
        if (found === 0) break;
        heap.skip(Math.ceil(size / 8) * 8);
      }
      return refuse('a text is missing: it is damaged');
    }
    attribute(data) {
      const cursor = new Cursor(data);
      const version = cursor.u8();
      cursor.skip(1);
      const [nameSize, typeSize, spaceSize] = [cursor.u16(), cursor.u16(), cursor.u16()];
      if (version === 3) cursor.skip(1);
      const take = (size) => {
        const part = cursor.take(size);
        if (version === 1) cursor.skip((8 - size % 8) % 8);
        return part;
      };
      const name = decoder.decode(take(nameSize)).replace(/\0.*$/s, '');
      const type = this.type(take(typeSize)), shape = this.shape(take(spaceSize));
      const values = this.values(type, data.subarray(cursor.at), shape.reduce((a, b) => a * b, 1));
      return [name, shape.length ? Array.from(values) : values[0]];
    }

    // ---- many attributes or links: a fractal heap, and a tree that says where they lie ------

    dense(info, indexBytes, record) {
      if (!info) return [];
      const cursor = new Cursor(info, 1);
      const flags = cursor.u8();
      if (flags & 1) cursor.skip(indexBytes);
      const heap = cursor.address(), tree = cursor.address();
      return heap === null || tree === null ? [] : this.tree(tree, record).map((entry) => this.managed(heap, entry));
    }
    // The heap's identifiers in a tree (version 2) of records of that kind.
    tree(at, kind) {
      const head = this.cursor(at).expect('BTHD').skip(1);
      if (head.u8() !== kind) refuse('it lists its parts in an order that evo does not write');
      const node = head.u32(), size = head.u16(), depth = head.u16(), root = head.skip(2).address(), count = head.u16();
      const most = [Math.floor((node - 10) / size)], below = [most[0]];
      const countBytes = bytesFor(most[0]);
      const pointer = (level) => 8 + countBytes + (level > 1 ? bytesFor(below[level - 1]) : 0);
      for (let level = 1; level <= depth; ++level) {
        most.push(Math.floor((node - 10 - pointer(level)) / (size + pointer(level))));
        below.push((most[level] + 1) * below[level - 1] + most[level]);
      }
      const found = [];
      const walk = (at, level, count) => {
        const cursor = this.cursor(at).expect(level ? 'BTIN' : 'BTLF').skip(2);
        for (let k = 0; k < count; ++k) {
          const record = cursor.take(size);
          found.push(kind === 5 ? record.subarray(4) : record);  // of a link after its hash
        }
        if (level === 0) return;
        for (let k = 0; k <= count; ++k) {
          const child = cursor.address(), records = cursor.sized(countBytes);
          if (level > 1) cursor.skip(pointer(level) - 8 - countBytes);
          walk(child, level - 1, records);
        }
      };
      if (root !== null) walk(root, depth, count);
      return found;
    }
    managed(at, identifier) {
      const head = this.cursor(at).expect('FRHP').skip(1);
      head.skip(2);
      if (head.u16() !== 0) refuse('its heaps are compressed, which evo does not do');
      head.skip(1);
      const largestObject = head.u32();
      const width = head.skip(96).u16(), first = head.u64(), largest = head.u64(), bits = head.u16();
      const root = head.skip(2).address(), rows = head.u16();
      const offsetBytes = Math.ceil(bits / 8);
      const cursor = new Cursor(identifier);
      if (cursor.u8() & 0x30) refuse('one of its attributes is larger than evo writes them');
      const offset = cursor.sized(offsetBytes);
      const length = cursor.sized(Math.min(bytesFor(largest), bytesFor(largestObject)));
      const sizeOf = (row) => first * 2 ** Math.max(0, row - 1);
      const directRows = Math.log2(largest / first) + 2;
      const direct = (block, start) => this.cursor(block).expect('FHDB').skip(offset - start - 4).take(length);
      const indirect = (block, rows, start) => {
        const entries = this.cursor(block).expect('FHIB').skip(1 + 8 + offsetBytes);
        for (let row = 0; row < rows; ++row)
          for (let column = 0; column < width; ++column) {
            const child = entries.address(), size = sizeOf(row);
            if (offset < start + size) {
              if (child === null) return refuse('an attribute is missing: it is damaged');
              return row < directRows ? direct(child, start) : indirect(child, Math.log2(size / first / width) + 1, start);
            }
            start += size;
          }
        return refuse('an attribute is missing: it is damaged');
      };
      return rows === 0 ? direct(root, 0) : indirect(root, rows, 0);
    }

    // ---- arrays --------------------------------------------------------------------------------

    dataset(of, attributes) {
      const type = this.type(of(0x03)), shape = this.shape(of(0x01));
      const count = shape.reduce((a, b) => a * b, 1);
      const layout = new Cursor(of(0x08));
      if (layout.u8() !== 3) refuse('its arrays are laid out in a way that evo does not write');
      const kind = layout.u8();
      const read = async () => {
        const cursor = new Cursor(layout.bytes, layout.at);
        if (kind === 0) return this.values(type, cursor.take(cursor.u16()), count);
        if (kind === 1) {
          const at = cursor.address(), size = cursor.u64();
          return this.values(type, at === null ? new Uint8Array(count * type.size) : this.cursor(at).take(size), count);
        }
        const rank = cursor.u8() - 1, tree = cursor.address();
        const chunk = Array.from({ length: rank }, () => cursor.u32());
        if (rank !== shape.length || chunk.some((size, k) => k > 0 && size !== shape[k])) refuse('its arrays are cut across their rows, which evo does not do');
        const row = shape.slice(1).reduce((a, b) => a * b, type.size);
        if (!(shape[0] * row < 2 ** 31)) refuse('an array is larger than a page bears');
        const bytes = new Uint8Array(shape[0] * row);
        for (const { at, size, first, mask } of tree === null ? [] : this.chunks(tree, rank)) {
          const data = await this.unpacked(this.cursor(at).take(size), of(0x0b), mask, type.size);
          bytes.set(data.subarray(0, Math.min(chunk[0], shape[0] - first) * row), first * row);
        }
        return this.values(type, bytes, count);
      };
      return { attributes, shape, read };
    }
    chunks(at, rank, depth = 0) {
      const node = this.cursor(at).expect('TREE').skip(1);
      const level = node.u8(), used = node.u16();
      if (depth > 8) refuse('its arrays have no end: it is damaged');
      node.skip(16);
      const found = [];
      for (let k = 0; k < used; ++k) {
        const size = node.u32(), mask = node.u32(), first = node.u64();
        const child = node.skip(8 * rank).address();
        if (level > 0) found.push(...this.chunks(child, rank, depth + 1));
        else found.push({ at: child, size, first, mask });
      }
      return found;
    }
    async unpacked(data, pipeline, mask, elementSize) {
      const filters = [];
      if (pipeline) {
        const cursor = new Cursor(pipeline);
        const version = cursor.u8(), count = cursor.u8();
        if (version === 1) cursor.skip(6);
        for (let k = 0; k < count; ++k) {
          const id = cursor.u16(), name = version === 1 || id >= 256 ? cursor.u16() : 0, values = cursor.skip(2).u16();
          cursor.skip((version === 1 ? Math.ceil(name / 8) * 8 : name) + 4 * values + (version === 1 && values % 2 ? 4 : 0));
          filters.push(id);
        }
      }
      for (const [k, id] of [...filters.entries()].reverse()) {
        if (mask >> k & 1) continue;
        if (id === 1) {
          const stream = new Blob([data]).stream().pipeThrough(new DecompressionStream('deflate'));
          data = new Uint8Array(await new Response(stream).arrayBuffer().catch(() => refuse('an array cannot be unpacked: it is damaged')));
        } else if (id === 2) {  // all first bytes, all second bytes, ..
          const count = Math.floor(data.length / elementSize), sorted = new Uint8Array(data.length);
          for (let b = 0; b < elementSize; ++b) for (let k = 0; k < count; ++k) sorted[k * elementSize + b] = data[b * count + k];
          data = sorted;
        } else {
          refuse(`its arrays are packed by filter ${id}, which evo does not use`);
        }
      }
      return data;
    }
  }

  Evo.isHdf5 = (bytes) => bytes.length > 8 && [0x89, 0x48, 0x44, 0x46, 0x0d, 0x0a, 0x1a, 0x0a].every((value, k) => bytes[k] === value);
  Evo.readHdf5 = (bytes) => {
    try {
      const file = new File(bytes);
      return file.object(file.rootAddress());
    } catch (failure) {
      if (failure instanceof RangeError) refuse('it is cut short or damaged');
      throw failure;
    }
  };
})();

// Containers on a server that sends parts of a file.
import {checkResponse} from './error.js';

/** Bytes of the first requests, of the file's head and its end: small files come whole. */
const FIRST = 64 << 10;
/** Bytes of its end that a file must keep to be the same where it grows. */
const OVERLAP = 64;

/**
 * Asks a server for the beginning and the end of a file. Where it sends parts, resolves to {size, read},
 * of which open() reads what it needs; else to its response, of which open() reads all.
 */
export async function fetchRanges(url, init = {}) {
  const ask = (range, more) => fetch(url, {...more, ...init, headers: {...init.headers, range: `bytes=${range}`}});
  // Browsers' caches let requests of one file wait for each other, so that these go past them.
  const apart = {cache: 'no-store'};
  const ending = ask(`-${FIRST}`, apart).catch(() => null);  // the index stands there
  const drop = () => ending.then((response) => response?.body?.cancel()).catch(() => {});
  const response = await ask(`0-${FIRST - 1}`).catch((error) => {
    drop();
    throw error;
  });
  let total = response.status === 206 ? sizeOf(response) : null;
  if (total === null) {
    drop();
    if (response.status !== 206) return response;
    response.body?.cancel().catch(() => {});  // it does not show another origin's pages how much there is
    return fetch(url, init);
  }
  let mark = markOf(response);
  const held = [{offset: 0, bytes: new Uint8Array(await response.arrayBuffer())}];
  const end = await ending;
  if (end && total > FIRST && end.status === 206 && sizeOf(end) === total && markOf(end) === mark) {
    const bytes = new Uint8Array(await end.arrayBuffer());
    held.push({offset: total - bytes.length, bytes});
  } else {
    drop();
  }
  const changed = () => new TypeError(`${response.url || url} changed while it was read: open it again`);
  /** Asks for bytes: {bytes, size, mark} of the file as it is now. */
  const part = async (first, last) => {
    const answer = await ask(`${first}-${last}`, apart);
    checkResponse(answer);
    if (answer.status !== 206) {
      answer.body?.cancel().catch(() => {});
      throw changed();
    }
    return {bytes: new Uint8Array(await answer.arrayBuffer()), size: sizeOf(answer), mark: markOf(answer)};
  };
  const there = (offset, size) => {
    const piece = held.find((one) => offset >= one.offset && offset + size <= one.offset + one.bytes.length);
    return piece?.bytes.subarray(offset - piece.offset, offset - piece.offset + size);
  };
  return {
    url: response.url, type: response.headers.get('content-type'),
    get size() {
      return total;
    },
    async read(offset, size) {
      const piece = there(offset, size);
      if (piece) return piece;
      const [totalBefore, markBefore] = [total, mark];
      const now = await part(offset, offset + size - 1);
      if (now.size === totalBefore && now.mark === markBefore) return now.bytes;
      if (!(now.size > totalBefore)) throw changed();
      if (now.size > total) await this.grow();  // or is it another file?
      return now.bytes;
    },
    /** Asks for what was appended; resolves to the size. Bytes that are known again: a file that has others is another. */
    async grow() {
      const {offset, bytes} = held.at(-1);
      const known = bytes.subarray(-OVERLAP), from = offset + bytes.length - known.length;
      const now = await part(from, from + known.length + FIRST - 1);
      const whole = now.bytes.length === Math.min(known.length + FIRST, now.size - from);
      if (!(now.size >= total) || !whole || known.some((byte, i) => byte !== now.bytes[i])) throw changed();
      held.push({offset: from, bytes: now.bytes});
      if (held.length > 4) held.splice(2, 1);
      [total, mark] = [now.size, now.mark];
      return total;
    },
  };
}

/** The file's size, of an answer that says it. */
function sizeOf(response) {
  const size = Number(/^bytes \d+-\d+\/(\d+)$/.exec(response.headers.get('content-range') ?? '')?.[1]);
  return Number.isSafeInteger(size) ? size : null;
}

/** What changes with the file. */
function markOf({headers}) {
  return headers.get('etag') ?? headers.get('last-modified') ?? '';
}

// Containers on a server that sends parts of a file.
import {checkResponse} from './error.js';

/** Bytes of the first requests, of the file's head and its end: small files come whole. */
const FIRST = 64 << 10;

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
  const total = response.status === 206 ? sizeOf(response) : null;
  if (total === null) {
    drop();
    if (response.status !== 206) return response;
    response.body?.cancel().catch(() => {});  // it does not show another origin's pages how much there is
    return fetch(url, init);
  }
  const mark = markOf(response);
  const held = [{offset: 0, bytes: new Uint8Array(await response.arrayBuffer())}];
  const end = await ending;
  if (end && total > FIRST && end.status === 206 && sizeOf(end) === total && markOf(end) === mark) {
    const bytes = new Uint8Array(await end.arrayBuffer());
    held.push({offset: total - bytes.length, bytes});
  } else {
    drop();
  }
  return {
    url: response.url, type: response.headers.get('content-type'), size: total,
    async read(offset, size) {
      const there = held.find((one) => offset >= one.offset && offset + size <= one.offset + one.bytes.length);
      if (there) return there.bytes.subarray(offset - there.offset, offset - there.offset + size);
      const part = await ask(`${offset}-${offset + size - 1}`, apart);
      checkResponse(part);
      if (part.status !== 206 || sizeOf(part) !== total || markOf(part) !== mark) {
        throw new TypeError(`${response.url || url} changed while it was read: open it again`);
      }
      return new Uint8Array(await part.arrayBuffer());
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

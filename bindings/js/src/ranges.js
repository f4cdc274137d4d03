// Containers on a server that sends parts of a file.
import {checkResponse} from './error.js';

/** Bytes of the first request, in which small files come whole. */
const FIRST = 64 << 10;

/**
 * Asks a server for the beginning of a file. Where it sends parts, resolves to {size, read}, of which
 * open() reads what it needs; else to its response, of which open() reads all.
 */
export async function fetchRanges(url, init = {}) {
  const ask = (first, last) => fetch(url, {...init, headers: {...init.headers, range: `bytes=${first}-${last}`}});
  const response = await ask(0, FIRST - 1);
  if (response.status !== 206) return response;
  const total = sizeOf(response);
  if (total === null) {  // it does not show another origin's pages how much there is
    response.body?.cancel().catch(() => {});
    return fetch(url, init);
  }
  const mark = markOf(response);
  const head = new Uint8Array(await response.arrayBuffer());
  return {
    url: response.url, type: response.headers.get('content-type'), size: total,
    async read(offset, size) {
      if (offset + size <= head.length) return head.subarray(offset, offset + size);
      const part = await ask(offset, offset + size - 1);
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

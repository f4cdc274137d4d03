import {STATUS_NAMES} from './interface.js';

/** Throws for a response that does not bring what was asked for. */
export function checkResponse({ok, status, statusText, url}) {
  if (!ok) throw new TypeError(`the server answers ${status} ${statusText} for ${url || 'the request'}`);
}

/** A name from a file or a server in quotes, safe for a terminal. */
export function quoted(name) {
  return JSON.stringify(name).replace(/[\u007f-\u009f\u200e\u200f\u2028-\u202e\u2066-\u2069]/g,
      (one) => `\\u${one.charCodeAt(0).toString(16).padStart(4, '0')}`);
}

/** Throws for an option that does not exist. */
export function checkOptions(options, names) {
  for (const name of Object.keys(options)) {
    if (!names.includes(name)) throw new TypeError(`there is no option ${name}: there are ${names.join(', ')}`);
  }
}

/** What a call of the library, or damaged bytes, lead to. */
export class GicodecError extends Error {
  /**
   * @param {number} status one of the library's statuses, e.g. 301
   * @param {string} text
   * @param {ErrorOptions} [options]
   */
  constructor(status, text, options) {
    super(text, options);
    this.name = 'GicodecError';
    this.status = status;
    /** The status by name, e.g. "corrupt". */
    this.code = STATUS_NAMES[status] ?? 'unknown';
  }
}

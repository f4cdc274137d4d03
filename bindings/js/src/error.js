import {STATUS_NAMES} from './interface.js';

/** Throws for a response that does not bring what was asked for. */
export function checkResponse({ok, status, statusText, url}) {
  if (!ok) throw new TypeError(`the server answers ${status} ${statusText} for ${url || 'the request'}`);
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

// The states of a container: frames with times and names, decoded when they are asked for.

/** Frames that stay decoded for each object: two are blended. */
const KEPT = 2;

/** What metadata says of a container's frames (FORMAT.md, "Keys"), by ascending frame. */
export function statesOf({metadata}, frames) {
  const said = (metadata['gicodec:states'] ?? '').split('\n').map((line) => /^(\d+) (\S+) (.*)$/.exec(line));
  const named = new Map(said.filter(Boolean).map(([, frame, time, name]) => [Number(frame), {time: Number(time), name}]));
  const [start, fps] = [Number(metadata.start), Number(metadata.fps)];
  const known = Number.isFinite(start) && fps > 0;
  return frames.map((frame) => {
    const {time = NaN, name = ''} = named.get(frame) ?? {};
    const usual = known && Number.isFinite(start + frame / fps) ? start + frame / fps : frame;
    return {frame, time: Number.isFinite(time) ? time : named.size > 0 ? null : usual, name};
  });
}

/** Between which states a time lies, or which one a name has: {first, second, part} of frames. */
export function placeOfState(states, wanted) {
  if (typeof wanted === 'string') {
    const found = states.find(({name}) => name === wanted);
    if (found) return {first: found.frame, second: found.frame, part: 0};
    const names = states.map(({name}) => name).filter(Boolean);
    throw new RangeError(`there is no state ${JSON.stringify(wanted)}; ` +
                         `${names.length ? `there are ${names.map((name) => JSON.stringify(name)).join(', ')}` : 'none has a name'}`);
  }
  const timed = states.filter(({time}) => time !== null).sort((a, b) => a.time - b.time);
  if (!Number.isFinite(wanted) || timed.length === 0) {
    throw new RangeError(`a state is a name or a time, not ${wanted}${timed.length ? '' : ': these states have names alone'}`);
  }
  const after = timed.findIndex(({time}) => time >= wanted);
  if (after <= 0) {
    const {frame} = timed.at(after);  // before the first, or after the last
    return {first: frame, second: frame, part: 0};
  }
  const [a, b] = [timed[after - 1], timed[after]];
  const part = (wanted - a.time) / (b.time - a.time);
  return part === 1 ? {first: b.frame, second: b.frame, part: 0} : {first: a.frame, second: b.frame, part};
}

/** Decodes frames of a player, which several objects share. */
export class States {
  #player;
  #textures;
  #frames;
  #last = null;
  #kept = new Map();
  #turn = Promise.resolve();
  #users = 0;

  /** `textures`: the numbers of those that are read. */
  constructor(player, frames, textures) {
    this.#player = player;
    this.#frames = frames;
    this.#textures = textures;
    this.all = statesOf(player, frames);
  }

  /** The textures of a frame by number, as typed arrays that nobody changes. */
  frame(frame) {
    let kept = this.#kept.get(frame);
    this.#kept.delete(frame);
    if (!kept) {
      // What nobody waits for any more is not decoded.
      kept = this.#turn.then(() => {
        if (this.#kept.get(frame) !== kept) throw new Error('another state was asked for');
        return this.#decode(frame);
      });
      this.#turn = kept.catch(() => { if (this.#kept.get(frame) === kept) this.#kept.delete(frame); });
    }
    this.#kept.set(frame, kept);  // behind those that were asked for earlier
    for (const old of this.#kept.keys()) {
      if (this.#kept.size > KEPT * Math.max(1, this.#users)) this.#kept.delete(old);
    }
    return kept;
  }

  async #decode(frame) {
    const next = this.#frames[this.#frames.indexOf(this.#last) + 1];
    if (this.#last === null || next !== frame) await this.#player.seek(frame);
    this.#last = null;
    await this.#player.next();
    this.#last = frame;
    const textures = new Map();
    for (const texture of this.#textures) textures.set(texture, await this.#player.read(texture));
    return textures;
  }

  /** Says that an object uses this; the call that it returns says that it no longer does. */
  use() {
    ++this.#users;
    return () => {
      if (--this.#users === 0) this.#player.close();
    };
  }
}

/**
 * Gives an object that shows a volume (shown.js) `states`, `state`, which may be set to a time or a name, and
 * setState(), which resolves once it is shown. Resolves once the first state is.
 */
export async function addStates(object, states) {
  const release = states.use();
  let state = null, asked = 0, ended = false;
  const go = async ({first, second, part}, wanted) => {
    const turn = ++asked;
    state = wanted;
    try {
      const [a, b] = await Promise.all([states.frame(first), states.frame(object.blends ? second : first)]);
      if (turn === asked) object.setTexels(a, b, part);
    } catch (error) {
      if (turn === asked) throw error;
    }
    if (turn !== asked) return;  // another one was asked for, or dispose() called
    object.dispatchEvent({type: 'state', state: wanted});
  };
  const setState = async (wanted) => {
    if (ended) throw new TypeError('the object was disposed of: load it again');
    return go(placeOfState(states.all, wanted), wanted);
  };
  const dispose = object.dispose.bind(object);
  Object.defineProperties(object, {
    states: {value: states.all, enumerable: true},
    state: {enumerable: true, get: () => state, set: (wanted) => {
      setState(wanted).catch((error) => {
        console.error(`GILoader: state ${wanted} of ${JSON.stringify(object.name)}:`, error);
        object.dispatchEvent({type: 'error', error});
      });
    }},
    setState: {value: setState},
    dispose: {configurable: true, value() {
      if (ended) return;
      ended = true;
      ++asked;
      release();
      dispose();
    }},
  });
  const [{frame, time, name}] = states.all;
  try {
    await go({first: frame, second: frame, part: 0}, time ?? name);
  } catch (error) {
    object.dispose();
    throw error;
  }
}

// The states of what is open: a slider, and play.
const find = (id) => document.getElementById(id);

export class Timeline {
  #objects = [];
  #states = [];
  #playing = null;
  #slider = find('time');
  #shown;
  #failed;

  /** `shown` is called once a state is shown, `failed` with what kept one from being shown. */
  constructor(shown, failed) {
    this.#shown = shown;
    this.#failed = failed;
    this.#slider.oninput = () => this.#show(Number(this.#slider.value));
    find('play').onclick = () => this.toggle();
  }

  /** Follows these objects, which have `states`. */
  follow(objects) {
    this.stop();
    this.#objects = objects;
    const longest = objects.map(({states}) => states).sort((a, b) => b.length - a.length)[0] ?? [];
    // States without a time are one unit apart, in their order.
    this.#states = longest.map((state, place) => ({...state, at: state.time ?? place}));
    find('timeline').hidden = this.#states.length < 2;
    if (this.#states.length < 2) return;
    const [{at}] = this.#states;
    const [min, max] = this.#ends();
    Object.assign(this.#slider, {min, max, value: at});
    this.#say(at);
  }

  #ends() {
    return this.#states.reduce(([least, most], {at}) => [Math.min(least, at), Math.max(most, at)], [Infinity, -Infinity]);
  }

  /** The state at or before a time. */
  #at(time) {
    return this.#states.reduce((best, one) => (one.at <= time && (best === null || one.at >= best.at) ? one : best), null) ?? this.#states[0];
  }

  #say(time) {
    const {name, at} = this.#at(time);
    find('state').textContent = name && at === time ? name : `${Math.round(time * 100) / 100}${name ? ` (${name})` : ''}`;
  }

  async #show(time) {
    this.#say(time);
    const state = this.#at(time);
    const wanted = state.time === null ? state.name : time;
    try {
      await Promise.all(this.#objects.map((object) => object.setState(wanted)));
      this.#shown();
    } catch (error) {
      this.stop();
      this.#failed(error);
    }
  }

  toggle() {
    if (this.#playing) return this.stop();
    if (this.#states.length < 2) return;
    find('play').textContent = '⏸';
    const playing = (this.#playing = {});
    const [first, last] = this.#ends();
    // A day passes in half a minute, a recording as it was.
    const speed = last - first > 30 ? (last - first) / 30 : 1;
    let before = performance.now();
    const step = async () => {
      if (this.#playing !== playing) return;
      const now = performance.now();
      let time = Number(this.#slider.value) + (now - before) * 1e-3 * speed;
      before = now;
      if (time > last) time = first;
      this.#slider.value = time;
      await this.#show(time);
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  stop() {
    this.#playing = null;
    find('play').textContent = '▶';
  }

  /** A step of `count` states. */
  step(count) {
    if (this.#states.length < 2) return;
    this.stop();
    const times = this.#states.map(({at}) => at).sort((a, b) => a - b);
    const at = times.indexOf(this.#at(Number(this.#slider.value)).at);
    this.#slider.value = times[Math.min(times.length - 1, Math.max(0, at + count))];
    this.#show(Number(this.#slider.value));
  }
}

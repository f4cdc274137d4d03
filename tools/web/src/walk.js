// A camera that walks: drag to look, W A S D and arrows to move, the wheel or two fingers to go ahead.
import {Euler, EventDispatcher, Vector3} from 'three';

const KEYS = {KeyW: [0, 0, -1], KeyS: [0, 0, 1], KeyA: [-1, 0, 0], KeyD: [1, 0, 0], KeyQ: [0, -1, 0], KeyE: [0, 1, 0],
              ArrowUp: [0, 0, -1], ArrowDown: [0, 0, 1], ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0]};

export class WalkControls extends EventDispatcher {
  enabled = false;
  speed = 2;
  #camera;
  #down = new Set();
  #pointers = new Map();
  #angles = new Euler(0, 0, 0, 'YXZ');

  constructor(camera, element) {
    super();
    this.#camera = camera;
    element.addEventListener('keydown', ({code}) => KEYS[code] && this.#down.add(code));
    addEventListener('keyup', ({code}) => this.#down.delete(code));
    addEventListener('blur', () => this.#down.clear());
    element.addEventListener('pointerdown', (event) => {
      element.setPointerCapture(event.pointerId);
      this.#pointers.set(event.pointerId, event);
    });
    for (const type of ['pointerup', 'pointercancel']) element.addEventListener(type, ({pointerId}) => this.#pointers.delete(pointerId));
    element.addEventListener('pointermove', (event) => this.#drag(event));
    element.addEventListener('wheel', ({deltaY}) => this.enabled && this.#ahead(-deltaY * 0.002 * this.speed), {passive: true});
  }

  #drag(event) {
    const before = this.#pointers.get(event.pointerId);
    if (!this.enabled || !before) return;
    const [x, y] = [event.clientX - before.clientX, event.clientY - before.clientY];
    this.#pointers.set(event.pointerId, event);
    if (this.#pointers.size > 1) return this.#ahead(-y * 0.01 * this.speed);
    this.#angles.setFromQuaternion(this.#camera.quaternion);
    this.#angles.y += x * 0.004;
    this.#angles.x = Math.min(1.5, Math.max(-1.5, this.#angles.x + y * 0.004));
    this.#angles.z = 0;
    this.#camera.quaternion.setFromEuler(this.#angles);
  }

  #ahead(distance) {
    this.#camera.position.addScaledVector(this.#camera.getWorldDirection(new Vector3()), distance);
  }

  update(seconds) {
    if (!this.enabled) return;
    for (const code of this.#down) {
      const way = new Vector3(...KEYS[code]).applyQuaternion(this.#camera.quaternion);
      this.#camera.position.addScaledVector(way, this.speed * seconds);
    }
  }
}

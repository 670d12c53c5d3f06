// Mouse, touch and keyboard.

const STEP = 5 * Math.PI / 180;  // of a press of an arrow key
const STILL = 6;                 // pixels that a click may move
const TWICE = 350;               // milliseconds between two clicks that are one double click

class Pointers {
  // view: the View of main.js
  constructor(canvas, view) {
    this.canvas = canvas;
    this.view = view;
    this.down = new Map();  // pointers by id: {x, y}
    this.clicked = 0;
    canvas.addEventListener('pointerdown', event => this.begin(event));
    canvas.addEventListener('pointermove', event => this.move(event));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, event => this.end(event));
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('wheel', event => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 30 : event.deltaMode === 2 ? 400 : 1;
      view.camera.zoom(Math.exp(clamp(event.deltaY * lines, -400, 400) * (event.ctrlKey ? 0.008 : 0.0014)));
      view.changed(true);
    }, {passive: false});
  }

  begin(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.focus({preventScroll: true, focusVisible: false});
    if (this.down.size === 0) this.moved = 0;
    this.down.set(event.pointerId, {x: event.clientX, y: event.clientY});
    if (this.down.size > 1) this.moved = Infinity;  // no click
  }

  move(event) {
    const before = this.down.get(event.pointerId);
    if (!before) return;
    const height = this.canvas.clientHeight, {camera} = this.view;
    const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
    const pair = [...this.down.values()];
    const apart = () => Math.hypot(pair[0].x - pair[1].x, pair[0].y - pair[1].y);
    const width = pair.length === 2 ? apart() : 0;
    [before.x, before.y] = [event.clientX, event.clientY];
    this.moved += Math.hypot(dx, dy);
    if (this.moved < STILL) return;
    if (pair.length === 2) {
      camera.pan(dx / 2 / height, dy / 2 / height);
      camera.zoom(width / Math.max(apart(), 1));
    } else if (pair.length === 1) {
      if (event.buttons & 6 || event.shiftKey) camera.pan(dx / height, dy / height);
      else camera.rotate(dx * 2 * Math.PI / Math.max(height, 600), dy * 2 * Math.PI / Math.max(height, 600));
    }
    this.view.changed(true);
  }

  end(event) {
    if (!this.down.delete(event.pointerId) || event.type === 'pointercancel' || event.button > 0 || this.moved >= STILL) return;
    const box = this.canvas.getBoundingClientRect();
    const isSecond = event.timeStamp - this.clicked < TWICE;
    this.clicked = isSecond ? 0 : event.timeStamp;
    this.view.clicked(event.clientX - box.left, event.clientY - box.top, isSecond);
  }
}

// What each key does, by KeyboardEvent.key in lower case.
const KEYS = {
  arrowleft: view => view.camera.rotate(STEP, 0), arrowright: view => view.camera.rotate(-STEP, 0),
  arrowup: view => view.camera.rotate(0, -STEP), arrowdown: view => view.camera.rotate(0, STEP),
  'shift+arrowleft': view => view.camera.pan(-0.05, 0), 'shift+arrowright': view => view.camera.pan(0.05, 0),
  'shift+arrowup': view => view.camera.pan(0, -0.05), 'shift+arrowdown': view => view.camera.pan(0, 0.05),
  '+': view => view.camera.zoom(0.9), '=': view => view.camera.zoom(0.9), '-': view => view.camera.zoom(1 / 0.9),
  ']': view => view.setExplode(view.explode + 0.1), '[': view => view.setExplode(view.explode - 0.1),
  n: view => view.selectNext(1), p: view => view.selectNext(-1), escape: view => view.select(-1),
  1: view => view.setMode('piece'), 2: view => view.setMode('neighbor'), 3: view => view.setMode('side'),
  4: view => view.setMode('level'), 5: view => view.setMode('source'),
  ',': view => view.setLevel(view.level - 1), '.': view => view.setLevel(view.level + 1),
  f: view => view.focus(), i: view => view.setIsolated(!view.isIsolated), e: view => view.toggle('lines'), g: view => view.toggle('ghosts'),
  t: view => view.switchTheme(), 0: view => view.home(), home: view => view.home(), '?': view => view.showKeys(),
};

function listenToKeys(view) {
  addEventListener('keydown', event => {
    if (event.ctrlKey || event.altKey || event.metaKey || document.querySelector('dialog[open]')) return;
    const key = event.key.toLowerCase(), {target} = event;
    const isField = target instanceof HTMLInputElement;
    if (isField && (target.type === 'number' ? key !== 'escape' : key.startsWith('arrow') || key === 'home')) return;
    const act = KEYS[event.shiftKey && key.startsWith('arrow') ? `shift+${key}` : key];
    if (!act) return;
    event.preventDefault();
    act(view);
    view.changed(true);
  });
}

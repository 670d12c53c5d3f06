// The view: what is selected and how it is shown, and when it is drawn.

const MODES = {piece: 0, neighbor: 1, side: 2, level: 0, source: 3};
const MANY_PIECES = 5000;
const SIDES = [[178, 92, 60], [240, 226, 200]];  // of the original surface and of cracks, sRGB

const isNarrow = () => matchMedia('(max-width: 700px) and (min-height: 461px)').matches;  // as in viewer.css

class View {
  constructor(scene, canvas) {
    this.scene = scene;
    this.drawing = new Drawing(canvas, scene);
    this.camera = new Camera();
    this.paths = splitPaths(scene);
    this.levels = this.paths.reduce((most, path) => Math.max(most, path.length), 0);
    Object.assign(this, {selected: -1, explode: 0.25, mode: 'piece', level: Math.min(1, this.levels), isIsolated: false, isDrawn: false, lastFrame: 0, rise: 0});
    this.shown = {lines: scene.pieces.length <= MANY_PIECES, ghosts: true};  // edges of more would cover them
    $('lines').setAttribute('aria-pressed', String(this.shown.lines));
    this.accent = [0, 0, 0, 1];
    this.panel = new Panel(scene, this);
  }

  load(arrays, images) {
    this.drawing.load(arrays, images);
    this.isLoaded = true;
    this.centers = this.scene.pieces.map(piece =>
      piece.centroid.every(x => x !== null) ? this.drawing.unitOf(piece.centroid) : [0, 0, 0]);
    this.updateTheme();
    this.arrange();
    this.home(false);
  }

  // ---- What is selected

  select(index) {
    this.selected = index;
    if (index < 0) this.isIsolated = false;
    this.panel.show(index);
    this.arrange();
  }

  selectNext(step) {
    const count = this.scene.pieces.length;
    this.select(this.selected < 0 ? (step > 0 ? 0 : count - 1) : (this.selected + step + count) % count);
  }

  clicked(x, y, isSecond) {
    const index = this.drawing.pick(this.look(), x, y);
    if (isSecond && index >= 0) {
      this.select(index);
      this.focus();
    } else {
      this.select(index === this.selected && !isSecond ? -1 : index);
    }
  }

  // ---- How it is shown

  setExplode(value) {
    this.explode = clamp(value, 0, 2);
    this.arrange();
    if (this.camera.isFitted) this.fit();
  }

  setMode(mode) {
    const input = document.querySelector(`#modes input[value=${mode}]`);
    if (input.parentElement.hidden) return;
    input.checked = true;
    this.mode = mode;
    this.arrange();
    if (this.camera.isFitted) this.fit();
  }

  setLevel(level) {
    this.level = clamp(Math.round(level), 0, this.levels);
    this.arrange();
    if (this.camera.isFitted) this.fit();
  }

  setIsolated(isIsolated) {
    this.isIsolated = isIsolated && this.selected >= 0;
    $('isolate')?.setAttribute('aria-pressed', String(this.isIsolated));
    this.arrange();
  }

  toggle(name) {
    this.shown[name] = !this.shown[name];
    $(name).setAttribute('aria-pressed', String(this.shown[name]));
    this.changed();
  }

  // The split at the current level that a piece comes from, or the piece itself after its last split.
  groupOf(index) {
    const path = this.paths[index];
    return this.level < path.length ? `split ${path[this.level]}` : index;
  }

  // Sets each piece's color and position.  Pieces of one split move together where colors are those of a level.
  arrange() {
    const {scene} = this, groups = new Map();
    const isByLevel = this.mode === 'level';
    scene.pieces.forEach((piece, i) => {
      const key = isByLevel ? this.groupOf(i) : i;
      if (!groups.has(key)) groups.set(key, {first: i, weight: 0, sum: [0, 0, 0]});
      const group = groups.get(key), weight = Math.max(piece.volume ?? 0, 1e-30);
      group.weight += weight;
      group.sum = add(group.sum, scale(this.centers?.[i] ?? [0, 0, 0], weight));
    });
    const near = new Set(this.selected < 0 ? [] : [this.selected, ...scene.pieces[this.selected].contacts.map(([id]) => scene.indexOfId.get(id))]);
    let farthest = 0, lowest = 0;
    const half = scene.size.map(x => x / 2 / this.drawing.unit), up = {x: 0, y: 1, z: 2}[scene.up];
    this.offsets = [];
    const state = scene.pieces.map((piece, i) => {
      const group = groups.get(isByLevel ? this.groupOf(i) : i);
      const offset = scale(group.sum, this.explode / group.weight);
      this.offsets.push(offset);
      farthest = Math.max(farthest, length(offset));
      lowest = Math.min(lowest, offset[1]);
      const color = isByLevel ? pieceColor(scene.pieces[group.first].id - 1) : piece.color;
      return {offset, color: color.map(linearFromByte), hidden: this.isIsolated && !near.has(i), faded: this.selected >= 0 && !near.has(i) ? 0.5 : 0};
    });
    this.groupCount = groups.size;
    this.radius = length(half) + farthest;
    this.lowest = -half[up] + lowest;
    if (this.isLoaded) this.drawing.update(state);
    this.updateControls();
    this.changed();
  }

  updateControls() {
    $('explode').value = this.explode;
    $('explode-value').textContent = `${Math.round(100 * this.explode)} %`;
    $('level-row').hidden = this.mode !== 'level';
    $('level').value = this.level;
    $('level-value').textContent = `${this.level} of ${this.levels}`;
    const counted = `${countText(this.groupCount)} ${this.groupCount === 1 ? 'part' : 'parts'} after ${this.level} ${this.level === 1 ? 'split' : 'levels of splits'}`;
    this.panel.legend({
      piece: [], level: [[null, counted]], source: [],
      neighbor: [[[214, 214, 212], 'original surface'], [null, 'cracks have the neighbor’s color']],
      side: [[SIDES[0], 'original surface'], [SIDES[1], 'cracks']],
    }[this.mode]);
  }

  // ---- Camera

  // The view fills what the panels leave free.
  fit() {
    const {clientWidth, clientHeight} = this.drawing.canvas, above = 56;
    const below = clientHeight - Math.min($('controls').offsetTop, isNarrow() ? $('panel').offsetTop : clientHeight);
    const free = Math.max(clientHeight - below - above, clientHeight / 3);
    this.rise = (below - above) / clientHeight;
    this.camera.fit(0.92 * this.radius * clientHeight / free, clientWidth / free);
  }

  // To be called when panels have another size.
  refit() {
    const below = innerHeight - (isNarrow() ? $('panel') : $('controls')).offsetTop;
    document.documentElement.style.setProperty('--controls-height', `${$('controls').offsetHeight}px`);
    document.documentElement.style.setProperty('--covered', `${below}px`);
    if (this.camera.isFitted && this.isLoaded) this.fit();
    this.changed();
  }

  home(isMoving = true) {
    this.moveTo(() => {
      this.camera.home();
      this.fit();
    }, isMoving);
  }

  focus() {
    if (this.selected < 0) return this.home();
    const piece = this.scene.pieces[this.selected];
    const size = Math.cbrt(Math.max(piece.volume ?? 0, 1e-12)) / this.drawing.unit;
    this.moveTo(() => {
      this.camera.target = add(this.centers[this.selected], this.offsets[this.selected]);
      this.camera.distance = clamp(Math.max(size * 6, 0.5), 0.1, this.camera.distance);
      this.camera.isFitted = false;
    });
  }

  // Moves the camera to where `change` puts it, in a quarter of a second.
  moveTo(change, isMoving = true) {
    const {camera} = this, from = {azimuth: camera.azimuth, elevation: camera.elevation, distance: camera.distance, target: camera.target};
    change();
    this.changed();
    if (!isMoving || matchMedia('(prefers-reduced-motion: reduce)').matches) return;
    const to = {azimuth: camera.azimuth, elevation: camera.elevation, distance: camera.distance, target: camera.target};
    from.azimuth += 2 * Math.PI * Math.round((to.azimuth - from.azimuth) / (2 * Math.PI));
    const begin = performance.now(), id = this.motion = {};
    const step = now => {
      if (this.motion !== id || this.isTouched) return;
      const t = clamp((now - begin) / 260, 0, 1), s = t * t * (3 - 2 * t);
      for (const key of ['azimuth', 'elevation', 'distance']) camera[key] = from[key] + s * (to[key] - from[key]);
      camera.target = add(scale(from.target, 1 - s), scale(to.target, s));
      this.changed(true, true);
      if (t < 1) requestAnimationFrame(step);
    };
    this.isTouched = false;
    step(begin);
  }

  // ---- Drawing

  look() {
    return {
      camera: this.camera, radius: this.radius, rise: this.rise, mode: MODES[this.mode], showLines: this.shown.lines, showGhosts: this.shown.ghosts,
      selected: this.selected, isDark: this.isDark, accent: this.accent, lowest: this.lowest, sides: SIDES.map(side => side.map(linearFromByte)),
    };
  }

  // Draws soon.  isMoving: more will follow, so a coarser image does; isOurs: by moveTo
  changed(isMoving = false, isOurs = false) {
    if (isMoving && !isOurs) this.isTouched = true;
    if (!this.isLoaded) return;
    clearTimeout(this.rest);
    if (isMoving) this.rest = setTimeout(() => this.changed(), 160);
    this.isMoving = isMoving;
    if (this.isDrawn) return;
    this.isDrawn = true;
    requestAnimationFrame(now => {
      this.isDrawn = false;
      this.adapt(now);
      this.drawNow();
    });
  }

  drawNow() {
    this.drawing.draw(this.look(), this.isMoving);
    this.panel.drawScale(this.camera.unitsPerPixel(this.drawing.canvas.clientHeight) * this.drawing.unit);
  }

  // While the view moves, the image has as many pixels as the machine draws in time.
  adapt(now) {
    const took = now - this.lastFrame, {drawing} = this;
    this.lastFrame = now;
    if (!this.isMoving || took > 1000) return;
    this.took = this.took ? 0.6 * this.took + 0.4 * took : took;
    if (this.took > SLOW && drawing.coarseness > 0.4) drawing.coarseness *= 0.8;
    else if (this.took < FAST && drawing.coarseness < 1) drawing.coarseness = Math.min(1, drawing.coarseness * 1.1);
    else return;
    this.took = 0;
  }

  // ---- Light and dark

  switchTheme() {
    document.documentElement.dataset.theme = this.isDark ? 'light' : 'dark';
    this.updateTheme();
  }

  updateTheme() {
    const {theme} = document.documentElement.dataset;
    this.isDark = theme === 'auto' ? matchMedia('(prefers-color-scheme: dark)').matches : theme === 'dark';
    this.accent = this.isDark ? [0.56, 0.75, 1, 1] : [0.11, 0.37, 0.82, 1];
    this.changed();
  }

  showKeys() { $('keys').showModal(); }
}

function connect(view) {
  const {scene} = view;
  new Pointers(view.drawing.canvas, view);
  listenToKeys(view);
  $('explode').addEventListener('input', event => {
    view.setExplode(Number(event.target.value));
    view.changed(true);
  });
  $('level').max = view.levels;
  $('level').addEventListener('input', event => view.setLevel(Number(event.target.value)));
  $('modes').addEventListener('change', event => view.setMode(event.target.value));
  $('controls').addEventListener('submit', event => event.preventDefault());
  $('number').addEventListener('change', event => view.select(scene.indexOfId.get(Number(event.target.value)) ?? -1));
  $('reset').addEventListener('click', () => view.home());
  for (const name of ['lines', 'ghosts']) $(name).addEventListener('click', () => view.toggle(name));
  $('theme').addEventListener('click', () => view.switchTheme());
  $('help').addEventListener('click', () => view.showKeys());
  $('previous').addEventListener('click', () => view.selectNext(-1));
  $('next').addEventListener('click', () => view.selectNext(1));
  $('close').addEventListener('click', () => view.select(-1));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => view.updateTheme());
  addEventListener('resize', () => view.refit());
  const sizes = new ResizeObserver(() => view.refit());
  for (const name of ['controls', 'panel']) sizes.observe($(name));
  listenToPrinting(view);
  $('ghosts').hidden = scene.present === scene.pieces.length;
  const offers = {level: view.levels > 0, source: scene.colors || scene.materials.some(own => own.texture >= 0 || !own.inside && own.color.some(c => c < 255))};
  for (const [mode, isOffered] of Object.entries(offers)) document.querySelector(`#modes input[value=${mode}]`).parentElement.hidden = !isOffered;
  if (offers.source) view.mode = 'source';
  document.querySelector(`#modes input[value=${view.mode}]`).checked = true;
}

// Instead of the view: a sentence, and the table.
function fail(sentence, panel) {
  document.documentElement.classList.add('no-webgl');
  document.body.classList.add('no-webgl');
  $('failure').textContent = sentence;
  $('failure').hidden = false;
  fillTable(panel.scene, panel);
}

async function start() {
  const scene = readScene(), canvas = $('view');
  let view;
  try {
    view = new View(scene, canvas);
  } catch {
    fail('This browser has no WebGL 2, which the pieces are drawn with: here is a table of them. Another browser, or one with hardware acceleration on, shows them.',
         new Panel(scene, {paths: splitPaths(scene)}));
    return;
  }
  canvas.addEventListener('webglcontextlost', event => {
    event.preventDefault();
    fail('The graphics card dropped the pieces. Load the page again to see them.', view.panel);
  });
  connect(view);
  const bytes = await readBytes(scene, share => { $('loading').textContent = `Reading the meshes: ${Math.round(100 * share)} %`; });
  view.load(meshArrays(scene, bytes), await readTextures(scene));
  $('loading').hidden = true;
  if (!scene.hasShape) {
    fail('The fracture has no meshes: here is a table of its pieces.', view.panel);
    return;
  }
  // For scripts and tests.
  window.viewer = view;
  document.documentElement.dataset.state = 'ready';
}

start();

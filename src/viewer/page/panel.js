// What is written beside the view: figures, neighbors, scale, legend.

const $ = id => document.getElementById(id);

// An element with text or children; names from files are only ever set as text.
function element(name, content = [], attributes = {}) {
  const node = document.createElement(name);
  node.append(...[content].flat());
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  return node;
}

// Four digits, without zeros at the end: 0.1234, 1.234e-7, 12 340.
function numberText(value) {
  if (value === null || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e7) return value.toExponential(3).replace(/\.?0+e/, 'e').replace('e+', 'e').replaceAll('-', '−');
  return spaced(String(Number(value.toPrecision(size >= 1e4 ? Math.ceil(Math.log10(size) + 1e-9) : 4)))).replace('-', '−');
}

// 12 340 with thin spaces.
const spaced = digits => digits.replace(/^(-?\d{5,})/, whole => whole.replace(/\B(?=(\d{3})+$)/g, '\u202f'));
const countText = count => spaced(String(count));
const percentText = share => share === null ? '–' : `${Number((100 * share).toPrecision(3))}\u00a0%`;
const shortText = value => numberText(value === null ? null : Number(value.toPrecision(3)));

const listOf = rows => element('dl', rows.map(([name, value]) => [element('dt', name), element('dd', value)]).flat(), {class: 'figures'});

// The longest bar of 1, 2 or 5 times a power of ten that has at most so many pixels.
function scaleBar(unitsPerPixel, mostPixels, unit) {
  const most = mostPixels * unitsPerPixel, power = 10 ** Math.floor(Math.log10(most));
  const value = [5, 2, 1].map(step => step * power).find(step => step <= most) ?? power;
  return {pixels: value / unitsPerPixel, text: `${numberText(value)} ${unit || (value === 1 ? 'unit' : 'units')}`};
}

class Panel {
  constructor(scene, view) {
    this.scene = scene;
    this.view = view;
    const faces = scene.pieces.reduce((sum, piece) => sum + (piece.missing ? 0 : piece.faces), 0);
    const missing = scene.pieces.length - scene.present;
    this.summary = `${countText(scene.present)} ${scene.present === 1 ? 'piece' : 'pieces'}` +
      (missing ? `, ${countText(missing)} missing` : '') + ` · ${countText(faces)} faces`;
    $('summary').textContent = this.summary;
    $('of').textContent = scene.pieces.length < 10000 ? `of ${scene.pieces.length}` : '';
    $('number').max = scene.pieces.at(-1).id;
    const notes = [];
    if (scene.simplified) notes.push(`The meshes are simplified to cells of 1/${scene.simplified} of the object, so that the page stays small; figures are those of the whole meshes.`);
    notes.push('Figures are those of manifest.json. The scale holds at the center of the view.');
    $('notes').textContent = notes.join(' ');
    if (scene.simplified) $('summary').textContent += ', simplified';
    this.show(-1);
  }

  // A length, area (2) or volume (3) with its unit.
  measure(value, power) {
    const {unit} = this.scene, text = numberText(value);
    if (!unit && power === 1) return text;
    return unit ? `${text} ${unit}${['', '', '²', '³'][power]}` : text;
  }

  figures(piece) {
    const {density} = this.scene, fracture = piece.fracture_area, rows = [
      ['Volume', this.measure(piece.volume, 3)],
      ['Share', percentText(piece.share)],
      ['Area', this.measure(piece.area, 2)],
      ['Fracture area', this.measure(fracture, 2) + (piece.area > 0 && fracture !== null ? ` (${percentText(fracture / piece.area)})` : '')],
    ];
    if (piece.voxels) rows.push(['Voxels', countText(piece.voxels)]);
    if (piece.faces && !piece.missing) rows.push(['Faces', countText(piece.faces) + (this.scene.simplified ? ' here' : '')]);
    if (density !== 1 && piece.volume !== null) rows.push(['Mass', numberText(density * piece.volume)]);
    const path = this.view.paths[this.scene.indexOfId.get(piece.id)];
    if (path.length) rows.push(['Level', String(path.length)]);
    return listOf(rows);
  }

  massProperties(piece) {
    const {density} = this.scene, rows = [], three = values => values.map(shortText).join(',  ');
    if (piece.centroid.every(x => x !== null)) rows.push(['Center', three(piece.centroid)]);
    if (piece.inertia.every(x => x !== null)) {
      const inertia = piece.inertia.map(x => density * x);
      rows.push(['xx, yy, zz', three(inertia.slice(0, 3))], ['xy, xz, yz', three(inertia.slice(3))]);
    }
    return rows.length ? [element('details', [element('summary', 'Center of mass and inertia'), listOf(rows)])] : [];
  }

  neighbors(piece) {
    const most = Math.max(...piece.contacts.map(([, area]) => area ?? 0), 0);
    const items = piece.contacts.map(([id, area]) => {
      const index = this.scene.indexOfId.get(id), swatch = element('i'), bar = element('b');
      if (index !== undefined) swatch.style.background = cssColor(this.scene.pieces[index].color);
      bar.style.width = `${most > 0 ? Math.max(1, 100 * (area ?? 0) / most) : 0}%`;
      const button = element('button', [swatch, element('span', `Piece ${id}${this.scene.pieces[index]?.missing ? ', missing' : ''}`),
        element('span', this.measure(area, 2)), element('span', bar, {class: 'bar'})], {type: 'button'});
      button.disabled = index === undefined;
      button.addEventListener('click', () => this.view.select(index));
      return element('li', button);
    });
    return element('ul', items, {class: 'neighbors'});
  }

  // index: of the selected piece; -1: none
  show(index) {
    const piece = this.scene.pieces[index], details = $('details');
    $('panel').classList.toggle('selected', index >= 0);
    $('close').hidden = index < 0;
    $('number').value = piece ? piece.id : '';
    $('swatch').style.background = piece ? cssColor(piece.color) : '';
    $('said').textContent = piece ? `Piece ${piece.id}, share ${percentText(piece.share)}, ${piece.contacts.length} neighbors` : '';
    if (!piece) {
      details.replaceChildren(element('p', 'Click or tap a piece to see its figures and neighbors.', {class: 'hint'}));
      return;
    }
    const focus = element('button', 'Center', {type: 'button'}), isolate = element('button', 'Isolate', {type: 'button', id: 'isolate', 'aria-pressed': String(this.view.isIsolated)});
    focus.addEventListener('click', () => this.view.focus());
    isolate.addEventListener('click', () => this.view.setIsolated(!this.view.isIsolated));
    details.replaceChildren(...(piece.missing ? [element('span', 'missing', {class: 'badge'})] : []), this.figures(piece), ...this.massProperties(piece),
      element('div', [focus, isolate], {class: 'actions'}),
      element('h3', piece.contacts.length ? `${piece.contacts.length} ${piece.contacts.length === 1 ? 'neighbor' : 'neighbors'}, by contact area` : 'No neighbors'),
      this.neighbors(piece));
    details.scrollTop = 0;
  }

  legend(entries) {
    $('legend').replaceChildren(...entries.map(([color, text]) => {
      if (!color) return element('span', text);
      const swatch = element('i');
      swatch.style.background = cssColor(color);
      return element('span', [swatch, text]);
    }));
  }

  // unitsPerPixel: world units of a CSS pixel
  drawScale(unitsPerPixel) {
    const bar = scaleBar(unitsPerPixel, 150, this.scene.unit);
    $('scale-bar').style.width = `${bar.pixels}px`;
    $('scale-text').textContent = bar.text;
  }
}

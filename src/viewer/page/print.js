// What is printed: a picture on white with its scale, and a table of all pieces.

const MOST_ROWS = 1000;  // of the table
const PAPER = [1800, 1200];  // pixels of the picture

// The table, also for browsers without WebGL.
function fillTable(scene, panel) {
  const heads = ['Piece', 'Share', 'Volume', 'Area', 'Fracture area', 'Neighbors'];
  const rows = scene.pieces.slice(0, MOST_ROWS).map(piece => element('tr', [
    `${piece.id}${piece.missing ? ' (missing)' : ''}`, percentText(piece.share), panel.measure(piece.volume, 3), panel.measure(piece.area, 2),
    panel.measure(piece.fracture_area, 2), String(piece.contacts.length)].map(text => element('td', text))));
  const left = scene.pieces.length - rows.length;
  $('table').replaceChildren(
    element('table', [element('thead', element('tr', heads.map(text => element('th', text, {scope: 'col'})))), element('tbody', rows)]),
    ...(left > 0 ? [element('p', `and ${countText(left)} more`)] : []));
}

// Copies the view to a canvas without WebGL, which printing shows in every browser.
function fillPicture(view) {
  const {drawing, panel, camera} = view, canvas = $('paper'), [width, height] = PAPER;
  const {distance} = camera, aspect = drawing.canvas.clientWidth / drawing.canvas.clientHeight;
  camera.distance *= Math.max(1, Math.min(1, aspect) / (width / height));
  drawing.draw({...view.look(), isDark: false, rise: 0, accent: [0.11, 0.37, 0.82, 1]}, false, PAPER);
  Object.assign(canvas, {width, height});
  const to = canvas.getContext('2d');
  to.drawImage(drawing.canvas, 0, 0);
  const bar = scaleBar(camera.unitsPerPixel(height) * drawing.unit, 300, view.scene.unit);
  to.lineWidth = 3;
  to.strokeStyle = to.fillStyle = '#222';
  to.font = '28px system-ui, sans-serif';
  to.textAlign = 'center';
  to.beginPath();
  for (const [x, y] of [[0, -12], [0, 0], [bar.pixels, 0], [bar.pixels, -12]]) to.lineTo(30 + x, height - 30 + y);
  to.stroke();
  to.fillText(bar.text, 30 + bar.pixels / 2, height - 46);
  camera.distance = distance;
  view.drawNow();
}

function listenToPrinting(view) {
  addEventListener('beforeprint', () => {
    fillPicture(view);
    fillTable(view.scene, view.panel);
  });
}

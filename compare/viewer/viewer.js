// The view in space of report.html: both deformed bodies with the tool, coloured by displacement or error, the instant
// chosen by a slider that the force curve follows. Without WebGL it leaves the page's still picture as it is.
import '@kitware/vtk.js/Rendering/OpenGL/Actor';
import '@kitware/vtk.js/Rendering/OpenGL/Camera';
import '@kitware/vtk.js/Rendering/OpenGL/PolyDataMapper';
import '@kitware/vtk.js/Rendering/OpenGL/Renderer';
import vtkDataArray from '@kitware/vtk.js/Common/Core/DataArray';
import vtkPolyData from '@kitware/vtk.js/Common/DataModel/PolyData';
import vtkInteractorStyleTrackballCamera from '@kitware/vtk.js/Interaction/Style/InteractorStyleTrackballCamera';
import vtkActor from '@kitware/vtk.js/Rendering/Core/Actor';
import vtkMapper from '@kitware/vtk.js/Rendering/Core/Mapper';
import vtkRenderer from '@kitware/vtk.js/Rendering/Core/Renderer';
import vtkRenderWindow from '@kitware/vtk.js/Rendering/Core/RenderWindow';
import vtkRenderWindowInteractor from '@kitware/vtk.js/Rendering/Core/RenderWindowInteractor';
import vtkOpenGLRenderWindow from '@kitware/vtk.js/Rendering/OpenGL/RenderWindow';

const millimetres = 1e3;

/** Little-endian base64 as typed numbers. */
function numbers(base64, Type) {
  return new Type(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer);
}

/** VTK's cell array, "3 a b c" per triangle. */
function cells(triangles) {
  const out = new Uint32Array((triangles.length / 3) * 4);
  for (let t = 0; 3 * t < triangles.length; ++t) {
    out[4 * t] = 3;
    out.set(triangles.subarray(3 * t, 3 * t + 3), 4 * t + 1);
  }
  return out;
}

/** Colour of a share of the full scale, between the table's even steps; what is not finite takes the last. */
function colourAt(table, share) {
  if (!Number.isFinite(share)) return table[table.length - 1];
  const at = Math.min(Math.max(share, 0), 1) * (table.length - 1);
  const low = Math.min(Math.floor(at), table.length - 2);
  return table[low].map((value, i) => Math.round(value + (at - low) * (table[low + 1][i] - value)));
}

/** Length of each vector of a flat array, of its difference to another where one is given. */
function lengths(a, b) {
  const out = new Float32Array(a.length / 3);
  for (let i = 0; i < out.length; ++i) {
    const d = [0, 1, 2].map((axis) => a[3 * i + axis] - (b ? b[3 * i + axis] : 0));
    out[i] = Math.hypot(...d);
  }
  return out;
}

/** Unit normals at the vertices, of the adjacent triangles weighted by their area. */
function vertexNormals(points, triangles) {
  const out = new Float32Array(points.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]];
    const e = [0, 1, 2].map((axis) => points[3 * b + axis] - points[3 * a + axis]);
    const f = [0, 1, 2].map((axis) => points[3 * c + axis] - points[3 * a + axis]);
    const n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    for (const corner of [a, b, c]) for (let axis = 0; axis < 3; ++axis) out[3 * corner + axis] += n[axis];
  }
  for (let i = 0; i < out.length; i += 3) {
    const length = Math.hypot(out[i], out[i + 1], out[i + 2]) || 1;
    for (let axis = 0; axis < 3; ++axis) out[i + axis] /= length;
  }
  return out;
}

/** Column-major 4 x 4 matrix of a place and a quaternion x, y, z, w. */
function poseMatrix([px, py, pz], [x, y, z, w]) {
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
    px, py, pz, 1,
  ];
}

function actorOf(polyData) {
  const mapper = vtkMapper.newInstance();
  mapper.setInputData(polyData);
  mapper.setColorModeToDirectScalars();
  const actor = vtkActor.newInstance();
  actor.setMapper(mapper);
  actor.getProperty().set({ ambient: 0.3, diffuse: 0.7 });
  return actor;
}

/** One deformed body with the tool in its own part of the picture. */
class Side {
  constructor(data, name) {
    this.name = name;
    this.rest = numbers(data.points_m, Float32Array);
    this.triangles = numbers(data.triangles, Uint32Array);
    this.moves = data.instants.map((instant) => numbers(instant[name], Float32Array));
    this.body = vtkPolyData.newInstance();
    this.body.getPoints().setData(this.rest.slice(), 3);
    this.body.getPolys().setData(cells(this.triangles));
    this.renderer = vtkRenderer.newInstance();
    this.renderer.addActor(actorOf(this.body));

    const tool = vtkPolyData.newInstance();
    tool.getPoints().setData(numbers(data.tool.points_m, Float32Array), 3);
    tool.getPolys().setData(cells(numbers(data.tool.triangles, Uint32Array)));
    this.tool = actorOf(tool);
    this.tool.getProperty().set({ color: [0.55, 0.55, 0.58], opacity: 0.35 });
    this.renderer.addActor(this.tool);
  }

  show(at, instant, values, fullScale, table) {
    const points = this.rest.map((value, i) => value + this.moves[at][i]);
    const colours = new Uint8Array(points.length);
    values.forEach((value, i) => colours.set(colourAt(table, fullScale > 0 ? value / fullScale : 0), 3 * i));
    this.body.getPoints().setData(points, 3);
    const data = this.body.getPointData();
    const array = (name, content) => vtkDataArray.newInstance({ name, numberOfComponents: 3, values: content });
    data.setNormals(array('normal', vertexNormals(points, this.triangles)));
    data.setScalars(array('colour', colours));
    this.body.modified();
    this.tool.setUserMatrix(poseMatrix(instant.tool_m, instant.tool_xyzw));
  }
}

class Viewer {
  constructor(root, data) {
    this.data = data;
    this.root = root;
    this.part = (name) => root.querySelector(`[data-part="${name}"]`);
    this.sides = { reference: new Side(data, 'reference'), fast: new Side(data, 'fast') };
    root.bodies = { reference: this.sides.reference.body, fast: this.sides.fast.body };  // vtkPolyData, for scripts
    // Scales over all instants, so that colours mean the same along the slider.
    const { reference, fast } = this.sides;
    this.values = {
      displacement: {
        reference: reference.moves.map((m) => lengths(m)),
        fast: fast.moves.map((m) => lengths(m)),
      },
      error: data.instants.map((_, i) => lengths(fast.moves[i], reference.moves[i])),
    };
    const larger = (a, b) => (Number.isFinite(b) ? Math.max(a, b) : a);
    const largest = (lists) => lists.reduce((most, list) => list.reduce(larger, most), 0);
    const scale = largest(this.values.displacement.reference) || largest(this.values.displacement.fast);
    this.fullScale = { displacement: scale, error: largest(this.values.error) };
    this.clipped = { displacement: largest(this.values.displacement.fast) > 1.001 * scale, error: false };
    this.makeWindow();
    this.connect();
    this.layOut();
    this.resize();
    this.resetCamera();
    this.update();
  }

  makeWindow() {
    this.window = vtkRenderWindow.newInstance();
    this.view = vtkOpenGLRenderWindow.newInstance();
    this.view.setContainer(this.part('canvas'));
    this.window.addView(this.view);
    const background = getComputedStyle(this.root).getPropertyValue('background-color').match(/[\d.]+/g);
    for (const { renderer } of Object.values(this.sides)) {
      renderer.setBackground(...background.slice(0, 3).map((value) => value / 255));
      this.window.addRenderer(renderer);
    }
    this.camera = this.sides.reference.renderer.getActiveCamera();
    this.camera.setParallelProjection(true);
    this.sides.fast.renderer.setActiveCamera(this.camera);
    const interactor = vtkRenderWindowInteractor.newInstance();
    interactor.setView(this.view);
    interactor.initialize();
    interactor.bindEvents(this.part('canvas'));
    interactor.setInteractorStyle(vtkInteractorStyleTrackballCamera.newInstance());
  }

  connect() {
    const slider = this.part('instant');
    slider.max = this.data.instants.length - 1;
    slider.value = this.data.deepest;
    slider.addEventListener('input', () => this.update());
    this.part('colour').addEventListener('change', () => this.update());
    this.part('side').addEventListener('change', () => {
      this.layOut();
      this.update();
    });
    this.part('tool').addEventListener('change', () => this.update());
    this.part('reset').addEventListener('click', () => {
      this.resetCamera();
      this.window.render();
    });
    const chart = this.part('chart');
    const choose = (event) => {
      const box = chart.querySelector('svg').getBoundingClientRect();
      slider.value = this.nearestInstant(((event.clientX - box.left) / box.width) * this.data.chart.width_px);
      this.update();
    };
    chart.addEventListener('pointerdown', choose);
    chart.addEventListener('pointermove', (event) => event.buttons && choose(event));
    new ResizeObserver(() => {
      this.resize();
      this.window.render();
    }).observe(this.part('canvas'));
  }

  chartPx(time_s) {
    const { from_s, to_s, left_px, right_px } = this.data.chart;
    return left_px + ((time_s - from_s) / (to_s - from_s || 1)) * (right_px - left_px);
  }

  nearestInstant(x_px) {
    const away = this.data.instants.map((instant) => Math.abs(this.chartPx(instant.time_s) - x_px));
    return away.indexOf(Math.min(...away));
  }

  /** Both side by side, or one alone over the whole width. */
  layOut() {
    const shown = this.part('side').value;
    for (const [name, { renderer }] of Object.entries(this.sides)) {
      const alone = shown === name;
      const left = name === 'fast' && !alone ? 0.5 : 0;
      renderer.setViewport(left, 0, alone ? 1 : left + 0.5, 1);
      renderer.setDraw(alone || shown === 'both');
      const label = this.part(`name-${name}`);
      label.hidden = !alone && shown !== 'both';
      label.style.left = left ? '51%' : '1%';
    }
  }

  resize() {
    const box = this.part('canvas').getBoundingClientRect();
    this.view.setSize(Math.round(box.width * devicePixelRatio), Math.round(box.height * devicePixelRatio));
  }

  /** From in front, above and a little to the right, as in the page's still picture; fits the rest body. */
  resetCamera() {
    const points = this.sides.reference.rest;
    const bounds = [0, 1, 2].flatMap((axis) => {
      let [low, high] = [Infinity, -Infinity];
      for (let i = axis; i < points.length; i += 3) [low, high] = [Math.min(low, points[i]), Math.max(high, points[i])];
      return [low, high];
    });
    const middle = [0, 2, 4].map((i) => 0.5 * (bounds[i] + bounds[i + 1]));
    const [azimuth, elevation] = [24, 30].map((degrees) => (degrees * Math.PI) / 180);
    this.camera.setFocalPoint(...middle);
    this.camera.setPosition(
      middle[0] + Math.sin(azimuth) * Math.cos(elevation),
      middle[1] - Math.cos(azimuth) * Math.cos(elevation),
      middle[2] + Math.sin(elevation),
    );
    this.camera.setViewUp(0, 0, 1);
    this.sides.reference.renderer.resetCamera(bounds);
    this.camera.zoom(1.15);
    this.sides.fast.renderer.resetCameraClippingRange();
  }

  update() {
    const at = Number(this.part('instant').value);
    const colour = this.part('colour').value;
    const instant = this.data.instants[at];
    for (const [name, side] of Object.entries(this.sides)) {
      const values = colour === 'error' ? this.values.error[at] : this.values.displacement[name][at];
      side.show(at, instant, values, this.fullScale[colour], this.data.colours[colour]);
      side.tool.setVisibility(this.part('tool').checked);
      side.renderer.resetCameraClippingRange();
    }
    this.part('words').textContent = instant.words;
    this.part('instant').setAttribute('aria-valuetext', instant.words);
    const cursor = this.part('chart').querySelector('line.cursor');
    for (const end of ['x1', 'x2']) cursor.setAttribute(end, this.chartPx(instant.time_s));
    this.showBar(colour);
    this.window.render();
  }

  showBar(colour) {
    const table = this.data.colours[colour].map((rgb) => `rgb(${rgb.join(',')})`);
    this.part('bar').style.background = `linear-gradient(to right, ${table.join(', ')})`;
    const full = this.fullScale[colour] * millimetres;
    const more = this.clipped[colour] ? '; the last colour also stands for more' : '';
    this.part('bar-name').textContent = `${this.data.meanings[colour]} [mm]${more}`;
    [...this.part('bar-numbers').children].forEach((number, i, all) => {
      number.textContent = String(Number(((full * i) / (all.length - 1)).toPrecision(3)));
    });
  }
}

function hasWebGl() {
  return Boolean(document.createElement('canvas').getContext('webgl2'));
}

const root = document.getElementById('viewer');
if (hasWebGl()) {
  root.hidden = false;
  document.getElementById('viewer-still').hidden = true;
  new Viewer(root, JSON.parse(document.getElementById('viewer-data').textContent));
}

// The view in space of report.html: both deformed bodies with the tool, coloured by displacement or error, the instant
// chosen by a slider, played, or picked on the force curve. Without WebGL it leaves the page's still picture as it is.
import css from './viewer.css';
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
  actor.getProperty().set({ ambient: 0.4, diffuse: 0.6 });
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

/** Contrast ratio of two colours (red, green, blue, 0 to 255) as WCAG defines it: 1 to 21. */
function contrast(a, b) {
  const luminance = (rgb) => {
    const [r, g, b] = rgb.map((v) => (v <= 10.3 ? v / 3294.6 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((value) => value / Math.hypot(...a));

/** The largest of 1, 2 and 5 times a power of ten that is not above a limit. */
function roundBelow(limit) {
  const power = 10 ** Math.floor(Math.log10(limit));
  return [5, 2, 1].find((digit) => digit * power <= limit) * power;
}

class Viewer {
  constructor(root, data) {
    this.data = data;
    this.root = root;
    this.part = (name) => root.querySelector(`[data-part="${name}"]`);
    this.sides = { reference: new Side(data, 'reference'), fast: new Side(data, 'fast') };
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
    this.frame = this.pointsToFrame();
    this.makeWindow();
    this.connect();
    root.bodies = { reference: reference.body, fast: fast.body };  // vtkPolyData, for scripts
    root.camera = this.camera;
    this.resize();
    this.firstView();
    this.update();
  }

  makeWindow() {
    this.window = vtkRenderWindow.newInstance();
    this.view = vtkOpenGLRenderWindow.newInstance();
    this.view.setContainer(this.part('canvas'));
    this.window.addView(this.view);
    for (const { renderer } of Object.values(this.sides)) this.window.addRenderer(renderer);
    // One camera for both, so that they turn together.
    this.camera = this.sides.reference.renderer.getActiveCamera();
    this.camera.setParallelProjection(true);
    this.sides.fast.renderer.setActiveCamera(this.camera);
    const interactor = vtkRenderWindowInteractor.newInstance();
    interactor.setView(this.view);
    interactor.initialize();
    interactor.bindEvents(this.part('canvas'));
    // fit() sets a range that holds for both sides, which turning does not change.
    const style = vtkInteractorStyleTrackballCamera.newInstance({ autoAdjustCameraClippingRange: 0 });
    interactor.setInteractorStyle(style);
    this.paintBackground();
  }

  paintBackground() {
    this.background = this.colour(this.part('stage'), 'background-color');
    for (const { renderer } of Object.values(this.sides)) renderer.setBackground(...this.background.map((v) => v / 255));
  }

  /** A colour as the page has it now: red, green, blue, 0 to 255. */
  colour(element, property) {
    return getComputedStyle(element).getPropertyValue(property).match(/[\d.]+/g).slice(0, 3).map(Number);
  }

  connect() {
    const slider = this.part('instant');
    slider.max = this.data.instants.length - 1;
    slider.value = this.data.deepest;
    slider.addEventListener('input', () => {
      this.pause();
      this.update();
    });
    this.part('play').addEventListener('click', () => this.playOrPause());
    this.part('colour').addEventListener('change', () => this.update());
    this.part('side').addEventListener('change', () => {
      this.resize();
      this.update();
    });
    this.part('tool').addEventListener('change', () => this.update());
    this.part('reset').addEventListener('click', () => {
      this.firstView();
      this.window.render();
    });
    this.part('save').addEventListener('click', () => this.savePng());
    this.connectStage();
    const chart = this.part('chart');
    const choose = (event) => {
      const box = chart.querySelector('svg').getBoundingClientRect();
      slider.value = this.nearestInstant(((event.clientX - box.left) / box.width) * this.data.chart.width_px);
      this.pause();
      this.update();
    };
    chart.addEventListener('pointerdown', choose);
    chart.addEventListener('pointermove', (event) => event.buttons && choose(event));
    // In the next frame, since the layout changes the height of what is observed.
    const resized = () => requestAnimationFrame(() => {
      this.resize();
      this.window.render();
    });
    new ResizeObserver(resized).observe(this.part('stage'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
      this.paintBackground();
      this.window.render();
      this.drawMarks();
    });
    this.camera.onModified(() => this.drawMarks());
  }

  /** Keys and the wheel are the picture's only while it has the focus; otherwise they are the page's. */
  connectStage() {
    const canvas = this.part('canvas');
    const stage = this.part('stage');
    canvas.setAttribute('role', 'application');
    canvas.setAttribute('aria-label', 'Both deformed bodies in space');
    canvas.setAttribute('aria-describedby', this.part('keys').id);
    const keepFromPicture = (event) => document.activeElement !== canvas && event.stopPropagation();
    stage.addEventListener('wheel', keepFromPicture, { capture: true, passive: true });
    // vtk.js has letters of its own.
    stage.addEventListener('keypress', (event) => event.stopPropagation(), { capture: true });
    const step_degrees = 5;
    const actions = {
      ArrowLeft: () => this.turn(step_degrees, 0),
      ArrowRight: () => this.turn(-step_degrees, 0),
      ArrowUp: () => this.turn(0, -step_degrees),
      ArrowDown: () => this.turn(0, step_degrees),
      '+': () => this.camera.zoom(1.1),
      '-': () => this.camera.zoom(1 / 1.1),
      ' ': () => this.playOrPause(),
      Home: () => this.firstView(),
      Escape: () => canvas.blur(),
    };
    canvas.addEventListener('keydown', (event) => {
      const action = actions[event.key];
      if (!action || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      action();
      this.window.render();
    });
  }

  turn(azimuth_degrees, elevation_degrees) {
    this.camera.azimuth(azimuth_degrees);
    this.camera.elevation(elevation_degrees);
    this.camera.orthogonalizeViewUp();
  }

  /** From the instant shown to the last, or from the first where that is shown, in about five seconds. */
  playOrPause() {
    if (this.playing) return this.pause();
    const slider = this.part('instant');
    const last = this.data.instants.length - 1;
    const show = (at) => {
      slider.value = at;
      this.update();
      if (at >= last) this.pause();
    };
    this.playing = setInterval(() => show(Number(slider.value) + 1), Math.min(Math.max(5000 / (last + 1), 60), 500));
    this.part('play').textContent = 'Pause';
    show(Number(slider.value) >= last ? 0 : Number(slider.value));
  }

  pause() {
    clearInterval(this.playing);
    this.playing = undefined;
    this.part('play').textContent = 'Play';
  }

  chartPx(time_s) {
    const { from_s, to_s, left_px, right_px } = this.data.chart;
    return left_px + ((time_s - from_s) / (to_s - from_s || 1)) * (right_px - left_px);
  }

  nearestInstant(x_px) {
    const away = this.data.instants.map((instant) => Math.abs(this.chartPx(instant.time_s) - x_px));
    return away.indexOf(Math.min(...away));
  }

  /** Both side by side, one above the other where the page is narrow, or one alone. */
  layOut() {
    const shown = this.part('side').value;
    const stage = this.part('stage');
    const narrow = stage.getBoundingClientRect().width < 480;
    stage.classList.toggle('narrow', narrow);
    stage.classList.toggle('both', shown === 'both');
    for (const [name, { renderer }] of Object.entries(this.sides)) {
      const [left, bottom, right, top] =
        shown !== 'both' ? [0, 0, 1, 1]
        : narrow ? (name === 'fast' ? [0, 0, 1, 0.5] : [0, 0.5, 1, 1])
        : name === 'fast' ? [0.5, 0, 1, 1] : [0, 0, 0.5, 1];
      renderer.setViewport(left, bottom, right, top);
      renderer.setDraw(shown === 'both' || shown === name);
      const label = this.part(`name-${name}`);
      label.hidden = shown !== 'both' && shown !== name;
      Object.assign(label.style, { left: `${100 * left}%`, top: `${100 * (1 - top)}%` });
    }
    this.share = { width: shown === 'both' && !narrow ? 0.5 : 1, height: shown === 'both' && narrow ? 0.5 : 1 };
  }

  resize() {
    this.layOut();
    const box = this.part('canvas').getBoundingClientRect();
    if (!box.width || !box.height) return;
    this.size = { width: box.width, height: box.height };
    this.view.setSize(Math.round(box.width * devicePixelRatio), Math.round(box.height * devicePixelRatio));
    if (this.isFitted()) this.fit();
    this.drawMarks();
  }

  /** What the first view must hold: both bodies, at rest and at the deepest instant, and the tool near them. */
  pointsToFrame() {
    const { data } = this;
    const { rest } = this.sides.reference;
    const instant = data.instants[data.deepest];
    const low = [0, 1, 2].map((axis) => rest.reduce((a, v, i) => (i % 3 === axis ? Math.min(a, v) : a), Infinity));
    const high = [0, 1, 2].map((axis) => rest.reduce((a, v, i) => (i % 3 === axis ? Math.max(a, v) : a), -Infinity));
    this.middle = low.map((value, axis) => 0.5 * (value + high[axis]));
    this.size_m = Math.max(...high.map((value, axis) => value - low[axis]));
    const m = poseMatrix(instant.tool_m, instant.tool_xyzw);
    const tool = numbers(data.tool.points_m, Float32Array);
    const points = Array.from(rest);
    for (const { moves } of Object.values(this.sides)) {
      moves[data.deepest].forEach((value, i) => points.push(rest[i] + (Number.isFinite(value) ? value : 0)));
    }
    for (let i = 0; i < tool.length; i += 3) {
      for (let axis = 0; axis < 3; ++axis) {
        points.push(m[axis] * tool[i] + m[4 + axis] * tool[i + 1] + m[8 + axis] * tool[i + 2] + m[12 + axis]);
      }
    }
    // A long handle or a diverged shape must not make the bodies small.
    const beyond = 0.25 * this.size_m;
    return points.map((value, i) => Math.min(Math.max(value, low[i % 3] - beyond), high[i % 3] + beyond));
  }

  /** From in front, above and a little to the right, as in the page's still picture. */
  firstView() {
    const [azimuth, elevation] = [24, 30].map((degrees) => (degrees * Math.PI) / 180);
    this.towards = [
      Math.sin(azimuth) * Math.cos(elevation),
      -Math.cos(azimuth) * Math.cos(elevation),
      Math.sin(elevation),
    ];
    this.camera.setPosition(...this.middle.map((value, axis) => value + this.towards[axis]));
    this.camera.setFocalPoint(...this.middle);
    this.camera.setViewUp(0, 0, 1);
    this.camera.orthogonalizeViewUp();
    this.fit();
  }

  /** The camera's directions in the world. */
  directions() {
    const away = this.camera.getDirectionOfProjection();
    const right = unit(cross(away, this.camera.getViewUp()));
    return { away, right, up: cross(right, away) };
  }

  /** Moves and scales the camera so that what pointsToFrame() says is within each picture, clear of names and marks. */
  fit() {
    if (!this.size) return;
    const { away, right, up } = this.directions();
    const extent = [right, up].map((axis) => {
      let [low, high] = [Infinity, -Infinity];
      for (let i = 0; i < this.frame.length; i += 3) {
        const at = axis[0] * this.frame[i] + axis[1] * this.frame[i + 1] + axis[2] * this.frame[i + 2];
        [low, high] = [Math.min(low, at), Math.max(high, at)];
      }
      return [low, high];
    });
    const [side_px, above_px, below_px] = [10, 36, 30];
    const width_px = this.size.width * this.share.width - 2 * side_px;
    const whole_px = this.size.height * this.share.height;
    const [width_m, height_m] = extent.map(([low, high]) => high - low);
    const m_per_px = Math.max(width_m / width_px, height_m / (whole_px - above_px - below_px));
    const x_m = 0.5 * (extent[0][0] + extent[0][1]);
    const y_m = 0.5 * (extent[1][0] + extent[1][1]) + 0.5 * (above_px - below_px) * m_per_px;
    const depth_m = dot(this.middle, away);
    const focal = [0, 1, 2].map((axis) => x_m * right[axis] + y_m * up[axis] + depth_m * away[axis]);
    const distance_m = 50 * this.size_m;
    this.fitted = [...focal, 0.5 * whole_px * m_per_px];
    this.camera.setParallelScale(this.fitted[3]);
    this.camera.setFocalPoint(...focal);
    this.camera.setPosition(...focal.map((value, axis) => value - distance_m * away[axis]));
    this.camera.setClippingRange(0.5 * distance_m, 1.5 * distance_m);
  }

  /** Whether the picture was neither zoomed nor moved since; it may have been rotated. */
  isFitted() {
    const now = [...this.camera.getFocalPoint(), this.camera.getParallelScale()];
    return !this.fitted || now.every((value, i) => Math.abs(value - this.fitted[i]) < 1e-6 * this.size_m);
  }

  update() {
    const at = Number(this.part('instant').value);
    const colour = this.part('colour').value;
    const instant = this.data.instants[at];
    for (const [name, side] of Object.entries(this.sides)) {
      const values = colour === 'error' ? this.values.error[at] : this.values.displacement[name][at];
      side.show(at, instant, values, this.fullScale[colour], this.data.colours[colour]);
      side.tool.setVisibility(this.part('tool').checked);
    }
    this.part('words').textContent = instant.words;
    this.part('instant').setAttribute('aria-valuetext', instant.words);
    const cursor = this.part('chart').querySelector('line.cursor');
    for (const end of ['x1', 'x2']) cursor.setAttribute(end, this.chartPx(instant.time_s));
    this.showBar(colour);
    this.window.render();
  }

  /** Five numbers along the colour bar, and what they are. */
  barText(colour) {
    const full = this.fullScale[colour] * millimetres;
    const more = this.clipped[colour] ? '; larger values have the last colour' : '';
    return {
      name: `${this.data.meanings[colour]} [mm]${more}`,
      numbers: [0, 1, 2, 3, 4].map((i) => String(Number(((full * i) / 4).toPrecision(3)))),
    };
  }

  showBar(colour) {
    const table = this.data.colours[colour].map((rgb) => `rgb(${rgb.join(',')})`);
    const { name, numbers: texts } = this.barText(colour);
    this.part('bar').style.background = `linear-gradient(to right, ${table.join(', ')})`;
    this.part('bar-name').textContent = name;
    [...this.part('bar-numbers').children].forEach((number, i) => (number.textContent = texts[i]));
  }

  /** Directions x, y, z and a length in millimetres, at the lower edge, for the size and the turn in force. */
  drawMarks() {
    if (!this.size) return;
    const canvas = this.part('marks');
    const { width, height } = this.size;
    canvas.width = Math.round(width * devicePixelRatio);
    canvas.height = Math.round(height * devicePixelRatio);
    Object.assign(canvas.style, { width: `${width}px`, height: `${height}px` });
    const context = canvas.getContext('2d');
    context.scale(devicePixelRatio, devicePixelRatio);
    this.drawMarksOn(context);
  }

  drawMarksOn(context) {
    const { width, height } = this.size;
    const dark = [28, 30, 33];
    const ink = contrast(this.background, dark) >= contrast(this.background, [255, 255, 255]) ? dark : [255, 255, 255];
    context.strokeStyle = context.fillStyle = `rgb(${ink.join(',')})`;
    context.lineWidth = 2;
    context.font = '600 13px system-ui, "Segoe UI", Roboto, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    const { right, up } = this.directions();
    const [x, y, arm] = [38, height - 38, 24];
    ['x', 'y', 'z'].forEach((name, axis) => {
      const [dx, dy] = [arm * right[axis], -arm * up[axis]];
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + dx, y + dy);
      context.stroke();
      const length = Math.hypot(dx, dy) || 1;
      context.fillText(name, x + dx + (9 * dx) / length, y + dy + (9 * dy) / length);
    });
    const m_per_px = (2 * this.camera.getParallelScale()) / (height * this.share.height);
    const length_mm = roundBelow(Math.min(130, 0.3 * width) * m_per_px * millimetres);
    const length_px = length_mm / millimetres / m_per_px;
    const [to, foot] = [width - 14, height - 12];
    context.beginPath();
    context.moveTo(to - length_px, foot - 5);
    context.lineTo(to - length_px, foot);
    context.lineTo(to, foot);
    context.lineTo(to, foot - 5);
    context.stroke();
    const length = `${Number(length_mm.toPrecision(1))} mm`;
    context.fillText(length, to - 0.5 * length_px, foot - 12);
    this.part('marks').setAttribute('aria-label', `directions x, y, z; a length of ${length}`);
  }

  /** The picture with its marks, names, colour bar and numbers, at twice the screen's resolution or more. */
  savePng() {
    const { width, height } = this.size;
    const ratio = Math.max(2, devicePixelRatio);
    const below_px = 92;
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round((height + below_px) * ratio)];
    const context = canvas.getContext('2d');
    const rgb = (element, property) => `rgb(${this.colour(element, property).join(',')})`;
    context.fillStyle = rgb(this.root, 'background-color');
    context.fillRect(0, 0, canvas.width, canvas.height);
    this.view.setSize(Math.round(width * ratio), Math.round(height * ratio));
    this.view.traverseAllPasses();  // now, where render() may wait for the next frame
    context.drawImage(this.part('canvas').querySelector('canvas'), 0, 0);
    context.scale(ratio, ratio);
    this.drawMarksOn(context);
    for (const name of Object.keys(this.sides)) this.drawName(context, this.part(`name-${name}`), rgb);
    this.drawBar(context, height, rgb);
    this.resize();
    this.window.render();
    const instant = this.data.instants[Number(this.part('instant').value)];
    const link = document.createElement('a');
    link.href = canvas.toDataURL('image/png');
    link.download = `bodies-at-${Number(instant.time_s.toPrecision(4))}s.png`;
    link.click();
  }

  drawName(context, label, rgb) {
    if (label.hidden) return;
    const stage = this.part('stage').getBoundingClientRect();
    const box = label.getBoundingClientRect();
    context.fillStyle = rgb(this.root, 'background-color');
    context.fillRect(box.left - stage.left, box.top - stage.top, box.width, box.height);
    context.fillStyle = rgb(label, 'color');
    context.fillText(label.textContent, box.left - stage.left + 0.5 * box.width, box.top - stage.top + 0.5 * box.height);
  }

  drawBar(context, top, rgb) {
    const { width } = this.size;
    const colour = this.part('colour').value;
    const table = this.data.colours[colour];
    const { name, numbers: texts } = this.barText(colour);
    const [length, left] = [Math.min(420, width - 80), 0.5 * (width - Math.min(420, width - 80))];
    const gradient = context.createLinearGradient(left, 0, left + length, 0);
    table.forEach((value, i) => gradient.addColorStop(i / (table.length - 1), `rgb(${value.join(',')})`));
    context.fillStyle = gradient;
    context.fillRect(left, top + 12, length, 12);
    context.fillStyle = context.strokeStyle = rgb(this.root, 'color');
    context.lineWidth = 1;
    context.strokeRect(left, top + 12, length, 12);
    context.font = '13px system-ui, "Segoe UI", Roboto, sans-serif';
    texts.forEach((text, i) => context.fillText(text, left + (length * i) / 4, top + 36));
    context.fillText(name, 0.5 * width, top + 56, width - 16);
    context.fillText(this.part('words').textContent, 0.5 * width, top + 78, width - 16);
  }
}

function hasWebGl() {
  return Boolean(document.createElement('canvas').getContext('webgl2'));
}

const root = document.getElementById('viewer');
if (hasWebGl()) {
  const style = document.createElement('style');
  style.textContent = css;
  document.head.append(style);
  root.hidden = false;
  document.getElementById('viewer-still').hidden = true;
  new Viewer(root, JSON.parse(document.getElementById('viewer-data').textContent));
}

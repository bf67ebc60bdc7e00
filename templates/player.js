// The player: what is shown when, and its controls.

// The parser knows the name of SVG.
const SVG = byId('bars')?.firstElementChild.namespaceURI;
const WIDE = 1000; // units of a bar

function svg(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

function play(data) {
  const drawing = new Drawing(byId('scene'));
  const traces = data.traces.map(() => null);
  const range = byId('time');
  let entry = data.entries[0];
  let trace = null;
  let scene = null;
  let time = 0;
  let last = null; // time stamp of the last picture while it plays
  let cursors = [];

  const end = () => Math.max(trace.end, trace.spacing * Math.max(trace.frames - 1, 0));
  const step = () => (trace.frames > 1 ? trace.spacing : end() / 100);
  // Steps have no length: ten of them are shown in a second.
  const rate = () => Number(byId('speed').value) * (scene.unit === 'steps' ? 10 : 1);
  const said = (t) => (scene.unit === 'steps' ? `step ${Math.round(t)}` : `${t.toFixed(2)} s`);

  function draw() {
    const frame = Math.min(time / trace.spacing, trace.frames - 1);
    if (trace.frames > 0) {
      const [names, trails] = [byId('names').checked, byId('trails').checked];
      drawing.draw({ scene, trace, frame, time, deciders: new Set(entry.agents), names, trails });
    }
    range.value = time;
    range.setAttribute('aria-valuetext', said(time));
    byId('now').textContent = `${said(time)} of ${said(end())}`;
    const x = (WIDE * time) / (end() || 1);
    cursors.forEach((cursor) => { cursor.setAttribute('x1', x); cursor.setAttribute('x2', x); });
  }

  function go(to) {
    time = Math.min(Math.max(to, 0), end());
    draw();
  }

  function stop() {
    last = null;
    byId('play').textContent = 'Play';
  }

  function tick(stamp) {
    if (last === null) return;
    go(time + (rate() * Math.max(stamp - last, 0)) / 1000);
    last = stamp;
    if (time >= end()) stop();
    else requestAnimationFrame(tick);
  }

  function toggle() {
    if (last !== null) { stop(); return; }
    if (time >= end()) go(0);
    byId('play').textContent = 'Pause';
    last = performance.now();
    requestAnimationFrame(tick);
  }

  // Goes to the next state, or back.
  function move(states) {
    stop();
    go((Math.round(time / step()) + states) * step());
  }

  function bar({ text, changes }) {
    const row = document.createElement('div');
    row.className = 'bar';
    const name = document.createElement('code');
    name.textContent = text;
    const strip = svg('svg', { viewBox: `0 0 ${WIDE} 10`, preserveAspectRatio: 'none', role: 'img' });
    const x = (t) => (WIDE * Math.min(t, end())) / (end() || 1);
    const spans = [];
    for (let k = 0; k < changes.length; k += 2) {
      const until = k + 1 < changes.length ? changes[k + 1] : end();
      strip.append(svg('rect', { class: 'true', x: x(changes[k]), width: Math.max(x(until) - x(changes[k]), 1), y: 0, height: 10 }));
      if (spans.length < 5) spans.push(`from ${said(changes[k])} to ${said(until)}`);
    }
    const more = changes.length > 10 ? ', …' : '';
    strip.setAttribute('aria-label', spans.length ? `true ${spans.join(', ')}${more}` : 'never true');
    if (entry.decided !== null) {
      strip.append(svg('line', { class: 'decided', x1: x(entry.decided), x2: x(entry.decided), y1: 0, y2: 10 }));
    }
    const cursor = svg('line', { class: 'cursor', x1: 0, x2: 0, y1: 0, y2: 10 });
    strip.append(cursor);
    cursors.push(cursor);
    row.append(name, strip);
    return row;
  }

  // Shows one level or flight of stairs alone.
  function tab({ name, box }) {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = name;
    const [left, low, right, high] = box.map((part) => part / 1000);
    button.addEventListener('click', () => {
      drawing.fit({ left: left - 1, low: low - 1, right: right + 1, high: high + 1 });
      drawing.isWhole = false;
      draw();
    });
    return button;
  }

  function show(number) {
    stop();
    entry = data.entries[number];
    byId('entry').value = String(number);
    traces[entry.trace] = traces[entry.trace] || decodedTrace(data.traces[entry.trace]);
    trace = traces[entry.trace];
    scene = data.scenes[trace.scene];
    const what = byId('what');
    what.replaceChildren();
    if (entry.moment !== null) {
      const reason = document.createElement('code');
      reason.textContent = entry.what;
      what.append(`Decided at ${entry.moment}${entry.what ? ': ' : '.'}`, reason);
    }
    byId('command').textContent = entry.command;
    byId('command').parentElement.hidden = entry.command === '';
    byId('decision').disabled = entry.decided === null;
    byId('scene').parentElement.hidden = trace.frames === 0 || scene.agents + trace.tracks.length === 0;
    byId('view').hidden = byId('scene').parentElement.hidden;
    range.max = end();
    byId('levels').replaceChildren(...scene.islands.map(tab));
    cursors = [];
    byId('bars').replaceChildren(...entry.bars.map(bar));
    if (trace.frames > 0) {
      const box = bounds(scene, trace);
      drawing.shapeTo(box);
      drawing.fit(box);
    }
    go(0);
  }

  const redraw = (change) => () => { change(); draw(); };
  const click = (id, act) => byId(id).addEventListener('click', act);
  click('play', toggle);
  click('back', () => move(-1));
  click('forth', () => move(1));
  click('start', () => { stop(); go(0); });
  click('decision', () => { stop(); go(entry.decided); });
  click('closer', redraw(() => drawing.zoom(1.5)));
  click('farther', redraw(() => drawing.zoom(1 / 1.5)));
  click('whole', redraw(() => drawing.fit(bounds(scene, trace))));
  click('names', draw);
  click('trails', draw);
  range.addEventListener('input', () => { stop(); go(Number(range.value)); });
  byId('entry').addEventListener('change', () => show(Number(byId('entry').value)));
  for (const button of document.querySelectorAll('button.show')) {
    button.addEventListener('click', () => {
      show(Number(button.dataset.entry));
      byId('player').scrollIntoView();
      if (entry.decided !== null) go(entry.decided);
      byId('play').focus({ preventScroll: true });
    });
  }

  const keys = {
    ' ': toggle,
    ArrowLeft: () => move(-1),
    ArrowRight: () => move(1),
    Home: () => { stop(); go(0); },
    End: () => { stop(); go(end()); },
    d: () => { if (entry.decided !== null) { stop(); go(entry.decided); } },
    '+': redraw(() => drawing.zoom(1.5)),
    '=': redraw(() => drawing.zoom(1.5)),
    '-': redraw(() => drawing.zoom(1 / 1.5)),
    0: redraw(() => drawing.fit(bounds(scene, trace))),
  };
  const pans = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] };
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // These elements have their own keys.
    const own = event.target.closest('select, button, summary, input[type=checkbox], pre');
    if (own && !(own.tagName === 'BUTTON' && event.key !== ' ')) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const act = event.shiftKey && pans[key] ? redraw(() => drawing.pan(...pans[key])) : keys[key];
    if (act === undefined) return;
    event.preventDefault();
    act();
  });

  pointers(byId('scene'), drawing, draw);
  new ResizeObserver(() => {
    if (byId('scene').parentElement.hidden) return;
    drawing.resize();
    // A plan that nobody has moved stays whole.
    if (drawing.isWhole && trace.frames > 0) drawing.fit(bounds(scene, trace));
    draw();
  }).observe(byId('scene'));
  themed.push(() => { drawing.readInks(); draw(); });
  show(0);
}

// One pointer moves the plan, two zoom it; so does the wheel with Control, or while the plan has the focus.
function pointers(canvas, drawing, draw) {
  const down = new Map();
  const local = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, local(event));
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const now = local(event);
    const other = [...down].find(([id]) => id !== event.pointerId);
    if (other) {
      const apart = (point) => Math.hypot(point.x - other[1].x, point.y - other[1].y);
      drawing.zoom(apart(now) / Math.max(apart(before), 1), other[1]);
    } else {
      drawing.pan(now.x - before.x, now.y - before.y);
    }
    down.set(event.pointerId, now);
    draw();
  });
  for (const kind of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(kind, (event) => down.delete(event.pointerId));
  }
  canvas.addEventListener('wheel', (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return;
    event.preventDefault();
    drawing.zoom(Math.exp(-event.deltaY / 400), local(event));
    draw();
  }, { passive: false });
}

if (byId('data')) play(JSON.parse(byId('data').textContent));

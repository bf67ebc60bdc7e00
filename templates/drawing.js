// The plan with the agents, on a canvas.

const TRAIL = 3; // s
const MOST_NAMES = 12;
const MOST_TRAILS = 400;

class Drawing {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext('2d');
    this.centre = { x: 0, y: 0 };
    this.scale = 1; // CSS pixels per metre
    this.inks = {};
    this.readInks();
  }

  readInks() {
    const style = getComputedStyle(root);
    for (const name of ['ink', 'soft', 'line', 'region', 'barrier', 'agent', 'deciding', 'plan', 'stage']) {
      this.inks[name] = style.getPropertyValue(`--${name}`).trim();
    }
    this.inks.groups = [1, 2, 3, 4, 5, 6].map((k) => style.getPropertyValue(`--group-${k}`).trim());
  }

  // As high as a rectangle of the plane wants, within the limits of the style.
  shapeTo(box) {
    const { width } = this.canvas.getBoundingClientRect();
    this.canvas.style.height = `${Math.max(width * (box.high - box.low) / (box.right - box.left), 160)}px`;
    this.resize();
  }

  // The size in CSS pixels; the canvas gets as many pixels as the screen has there.
  resize() {
    const { width, height } = this.canvas.getBoundingClientRect();
    const ratio = devicePixelRatio || 1;
    this.canvas.width = Math.max(Math.round(width * ratio), 1);
    this.canvas.height = Math.max(Math.round(height * ratio), 1);
    this.size = { width, height };
    this.ratio = ratio;
  }

  fit(box) {
    const { width, height } = this.size;
    this.scale = Math.max(Math.min(width / (box.right - box.left), height / (box.high - box.low)), 1e-3);
    this.isWhole = true;
    this.centre = { x: (box.left + box.right) / 2, y: (box.low + box.high) / 2 };
  }

  // Zooms about a point of the canvas, CSS pixels; its centre without one.
  zoom(factor, at) {
    const { width, height } = this.size;
    this.isWhole = false;
    const [dx, dy] = at ? [at.x - width / 2, at.y - height / 2] : [0, 0];
    const scale = Math.min(Math.max(this.scale * factor, 0.05), 2000);
    this.centre.x += dx / this.scale - dx / scale;
    this.centre.y -= dy / this.scale - dy / scale;
    this.scale = scale;
  }

  // Moves the plan by CSS pixels.
  pan(dx, dy) {
    this.isWhole = false;
    this.centre.x -= dx / this.scale;
    this.centre.y += dy / this.scale;
  }

  at(x, y) {
    const { width, height } = this.size;
    return [width / 2 + (x - this.centre.x) * this.scale, height / 2 - (y - this.centre.y) * this.scale];
  }

  shape(shape) {
    const { pen } = this;
    pen.beginPath();
    if (shape.circle) {
      const [x, y, r] = shape.circle.map((part) => part / 1000);
      pen.arc(...this.at(x, y), r * this.scale, 0, 2 * Math.PI);
    } else {
      for (const ring of shape.rings) {
        for (let k = 0; k < ring.length; k += 2) pen.lineTo(...this.at(ring[k] / 1000, ring[k + 1] / 1000));
        pen.closePath();
        pen.moveTo(0, 0);
      }
    }
  }

  label(text, x, y, ink) {
    const { pen } = this;
    const shown = text.length > 40 ? `${text.slice(0, 39)}…` : text;
    pen.lineWidth = 3;
    pen.strokeStyle = this.inks.stage;
    pen.strokeText(shown, x, y);
    pen.fillStyle = ink;
    pen.fillText(shown, x, y);
  }

  scene(scene) {
    const { pen, inks } = this;
    for (const region of scene.regions) {
      this.shape(region.shape);
      pen.fillStyle = inks.region;
      pen.fill('evenodd');
    }
    pen.fillStyle = inks.barrier;
    for (const solid of scene.solids) {
      this.shape(solid);
      pen.fill('evenodd');
    }
    pen.strokeStyle = inks.barrier;
    pen.lineWidth = 2;
    pen.beginPath();
    for (const [a, b, c, d] of scene.walls) {
      pen.moveTo(...this.at(a / 1000, b / 1000));
      pen.lineTo(...this.at(c / 1000, d / 1000));
    }
    pen.stroke();
    pen.textAlign = 'center';
    for (const region of scene.regions) {
      this.label(region.name, ...this.at(...middle(region.shape)), inks.soft);
    }
    // Stairs are regions, and have their labels.
    for (const { name, box } of scene.islands.filter((one) => scene.regions.every((other) => other.name !== one.name))) {
      this.label(name, ...this.at((box[0] + box[2]) / 2000, box[3] / 1000 + 1), inks.ink);
    }
    for (const point of scene.points) {
      const [x, y] = this.at(point.at[0] / 1000, point.at[1] / 1000);
      pen.fillStyle = inks.soft;
      pen.fillRect(x - 2, y - 2, 4, 4);
      this.label(point.name, x, y - 6, inks.soft);
    }
  }

  // The options of a ranking: named routes all the time, headings from the start while they hold; that of the trial is solid.
  options(scene, trace, time) {
    const { pen, inks } = this;
    for (const { agent, seconds, routes, headings } of scene.options) {
      const track = trace.tracks.find((one) => one.agent === agent && one.first === 0);
      if (!track) continue;
      const [x, y] = [track.x[0], track.y[0]];
      const drawn = (label, points) => {
        pen.strokeStyle = inks.plan;
        pen.lineWidth = trace.option === label ? 3 : 1.2;
        pen.setLineDash(trace.option === label ? [] : [5, 4]);
        this.line(points);
        pen.setLineDash([]);
      };
      for (const { label, points } of routes) {
        const way = [[x, y]];
        for (let k = 0; k < points.length; k += 2) way.push([points[k] / 1000, points[k + 1] / 1000]);
        drawn(label, way);
        // Its name stands on its first piece.
        const [mx, my] = [0, 1].map((k) => 0.4 * way[0][k] + 0.6 * way[1][k]);
        this.label(label.replace('route ', ''), ...this.at(mx, my), inks.plan);
      }
      if (time > seconds) continue;
      for (const { label, toward, turn } of headings) {
        const angle = Math.atan2(toward[1] / 1000 - y, toward[0] / 1000 - x) + turn;
        drawn(label, [[x, y], [x + 1.2 * Math.cos(angle), y + 1.2 * Math.sin(angle)]]);
      }
    }
  }

  line(points) {
    this.pen.beginPath();
    points.forEach(([x, y]) => this.pen.lineTo(...this.at(x, y)));
    this.pen.stroke();
  }

  // A view: scene, trace, frame and its time, who decided, and whether names and trails are shown.
  draw({ scene, trace, frame, time, deciders, names, trails }) {
    const { pen, inks } = this;
    // All pixels: the size in CSS pixels need not be whole.
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.fillStyle = inks.stage;
    pen.fillRect(0, 0, this.canvas.width, this.canvas.height);
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.font = '12px system-ui, sans-serif';
    pen.lineJoin = 'round';
    this.scene(scene);
    this.options(scene, trace, time);
    const present = trace.tracks.filter((track) => placeAt(track, frame));
    const groups = groupsAt(scene, trace, frame);
    const ink = (track) => {
      const group = groups.get(track.agent);
      return group === undefined ? inks.agent : inks.groups[group % inks.groups.length];
    };
    this.ties(groups, present, frame);
    this.planned(plansAt(trace, frame), new Set(present.map((track) => track.agent)));
    const many = present.length > MOST_TRAILS;
    for (const track of present) {
      const decides = deciders.has(track.name);
      if (trails && (decides || !many)) this.trail(track, frame, TRAIL / trace.spacing, decides ? inks.deciding : ink(track));
    }
    present.forEach((track) => this.agent(track, frame, ink(track)));
    for (const track of present.filter((one) => deciders.has(one.name))) this.decider(track, frame);
    pen.textAlign = 'center';
    const named = [];
    const singles = present.filter((track) => !track.name.endsWith(']')).length;
    for (const track of present) {
      const decides = deciders.has(track.name);
      const isSingle = !track.name.endsWith(']') && singles <= MOST_NAMES;
      if (!decides && !isSingle && !(names && (present.length <= MOST_NAMES || this.scale > 60))) continue;
      const place = placeAt(track, frame);
      const [x, y] = this.at(place.x, place.y);
      const away = Math.max(track.radius * this.scale, 3) + 8;
      // A name above another one's would hide it.
      const isTaken = named.some((one) => Math.abs(one.x - x) < 60 && Math.abs(one.y - y) < 16);
      named.push({ x, y });
      this.label(track.name, x, isTaken ? y + away + 8 : y - away, decides ? inks.deciding : inks.ink);
    }
    this.ruler();
  }

  trail(track, frame, length, ink) {
    const { pen } = this;
    const from = Math.max(Math.ceil(frame - length), track.first);
    const points = [];
    for (let k = from; k <= frame; k += 1) points.push([track.x[k - track.first], track.y[k - track.first]]);
    const now = placeAt(track, frame);
    points.push([now.x, now.y]);
    pen.strokeStyle = ink;
    pen.globalAlpha = 0.5;
    pen.lineWidth = 2;
    this.line(points);
    pen.globalAlpha = 1;
  }

  agent(track, frame, ink) {
    const { pen, inks } = this;
    const place = placeAt(track, frame);
    const [x, y] = this.at(place.x, place.y);
    const radius = Math.max(track.radius * this.scale, 2);
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.fillStyle = ink;
    pen.fill();
    const heading = headingAt(track, frame);
    if (heading !== null && radius > 3) {
      pen.strokeStyle = inks.stage;
      pen.lineWidth = 2;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(x + radius * Math.cos(heading), y - radius * Math.sin(heading));
      pen.stroke();
    }
  }

  decider(track, frame) {
    const { pen, inks } = this;
    const place = placeAt(track, frame);
    pen.beginPath();
    pen.arc(...this.at(place.x, place.y), Math.max(track.radius * this.scale, 2) + 4, 0, 2 * Math.PI);
    pen.strokeStyle = inks.deciding;
    pen.lineWidth = 3;
    pen.stroke();
  }

  // Members of a group are tied to their centre.
  ties(groups, present, frame) {
    const { pen, inks } = this;
    const met = new Map();
    for (const track of present) {
      const group = groups.get(track.agent);
      if (group !== undefined) met.set(group, [...(met.get(group) || []), placeAt(track, frame)]);
    }
    met.forEach((places, k) => {
      if (places.length < 2) return;
      const mean = (axis) => places.reduce((sum, place) => sum + place[axis], 0) / places.length;
      const centre = [mean('x'), mean('y')];
      pen.strokeStyle = inks.groups[k % inks.groups.length];
      pen.lineWidth = 1;
      places.forEach((place) => this.line([centre, [place.x, place.y]]));
    });
  }

  planned(plans, present) {
    const { pen, inks } = this;
    pen.strokeStyle = inks.plan;
    pen.lineWidth = 1.5;
    pen.setLineDash([5, 4]);
    for (const [agent, plan] of plans) {
      if (present.has(agent)) this.line(Array.from(plan.x, (x, k) => [x, plan.y[k]]));
    }
    pen.setLineDash([]);
  }

  ruler() {
    const { pen, inks } = this;
    const powers = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
    const length = powers.find((one) => one * this.scale >= 50) || 1000;
    const [x, y] = [12, this.size.height - 14];
    pen.strokeStyle = inks.ink;
    pen.lineWidth = 3;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + length * this.scale, y);
    pen.stroke();
    pen.textAlign = 'left';
    this.label(`${length} m`, x, y - 6, inks.ink);
  }
}

// The middle of a shape, m.
function middle(shape) {
  if (shape.circle) return [shape.circle[0] / 1000, shape.circle[1] / 1000];
  const ring = shape.rings[0];
  const xs = ring.filter((_, k) => k % 2 === 0);
  const ys = ring.filter((_, k) => k % 2 === 1);
  const half = (list) => (Math.min(...list) + Math.max(...list)) / 2000;
  return [half(xs), half(ys)];
}

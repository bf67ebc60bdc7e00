// Where agents are on the plan, by its pixels alone, beside where the data say that they are.

// Runs in the page. `null` where the scene has no walls, by whose pixels the plan is measured.
function compare(most) {
  const data = JSON.parse(document.getElementById('data').textContent);
  const trace = data.traces[data.entries[Number(document.getElementById('entry').value)].trace];
  const scene = data.scenes[trace.scene];
  const canvas = document.getElementById('scene');
  const { width, height } = canvas;
  const style = getComputedStyle(document.documentElement);
  const pixels = canvas.getContext('2d').getImageData(0, 0, width, height).data;
  const ink = (name) => {
    const digits = style.getPropertyValue(`--${name}`).trim().slice(1);
    return [0, 2, 4].map((at) => parseInt(digits.slice(at, at + 2), 16));
  };
  // The middle and the size of what has a colour within a rectangle, in pixels.
  const found = (name, left, low, right, high) => {
    const [r, g, b] = ink(name);
    const box = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
    for (let y = Math.max(Math.floor(low), 0); y < Math.min(high, height); y += 1) {
      for (let x = Math.max(Math.floor(left), 0); x < Math.min(right, width); x += 1) {
        const at = 4 * (y * width + x);
        if (pixels[at] !== r || pixels[at + 1] !== g || pixels[at + 2] !== b) continue;
        box.left = Math.min(box.left, x);
        box.right = Math.max(box.right, x + 1);
        box.low = Math.min(box.low, y);
        box.high = Math.max(box.high, y + 1);
      }
    }
    return box;
  };
  const ends = scene.walls.flatMap(([a, b, c, d]) => [[a, b], [c, d]]);
  const range = (axis) => [Math.min(...ends.map((end) => end[axis])), Math.max(...ends.map((end) => end[axis]))];
  if (ends.length === 0) return null;
  const [[west, east], [south, north]] = [range(0), range(1)];
  const plan = found('barrier', 0, 0, width, height);
  // A wall along a side of the plan is 2 pixels thick, and half of them are outside.
  const isAlong = (axis, value) => scene.walls.some((wall) => wall[axis] === value && wall[axis + 2] === value);
  plan.left += isAlong(0, west);
  plan.right -= isAlong(0, east);
  plan.low += isAlong(1, north);
  plan.high -= isAlong(1, south);
  const scale = (plan.right - plan.left) / (east - west); // pixels of a millimetre
  const middle = (box) => [(box.left + box.right) / 2, (box.low + box.high) / 2];
  const [x0, y0] = middle(plan);
  const at = (x, y) => [x0 + scale * (x - (west + east) / 2), y0 - scale * (y - (south + north) / 2)];

  const frame = Math.min(Number(document.getElementById('time').value) / trace.spacing, trace.frames - 1);
  const sum = (list, count) => list.slice(0, count + 1).reduce((all, one) => all + one, 0);
  const between = (track, axis) => {
    const from = Math.min(Math.floor(frame + 1e-9) - track.first, track[axis].length - 1);
    const to = Math.min(from + 1, track[axis].length - 1);
    const [a, b] = [sum(track[axis], from), sum(track[axis], to)];
    return a + (b - a) * Math.max(frame - track.first - from, 0);
  };
  const present = trace.tracks.filter((one) => one.first <= frame && frame <= one.first + one.x.length - 1);
  const places = present.map((track) => ({
    name: track.name, at: at(between(track, 'x'), between(track, 'y')), radius: scale * track.radius,
  }));
  // Rings and names of neighbours hide a part of a disc.
  const alone = places.filter((one) => places.every((other) => other === one
    || Math.hypot(one.at[0] - other.at[0], one.at[1] - other.at[1]) > one.radius + other.radius + 30));
  const wrong = [];
  for (const { name, at: [x, y], radius } of alone) {
    const reach = radius + 2 * most + 1;
    const box = found('agent', x - reach, y - reach, x + reach + 1, y + reach + 1);
    const [cx, cy] = middle(box);
    const off = Math.hypot(cx - x, cy - y);
    if (!(off <= most)) wrong.push(`${name} is off by ${off} pixels`);
  }
  return { compared: alone.length, wrong };
}

// Scrubs through the trial of a page and compares. A disc is drawn to a part of a pixel: its middle is within one.
export async function places(page) {
  await page.value("document.getElementById('trails').checked && document.getElementById('trails').click()");
  const [wrong, all] = [[], { compared: 0 }];
  for (const share of [0, 0.23, 0.5, 0.77, 1]) {
    const time = await page.value(`(() => {
      const range = document.getElementById('time');
      range.value = Number(range.max) * ${share};
      range.dispatchEvent(new Event('input'));
      return Number(range.value);
    })()`);
    const answer = await page.value(`(${compare})(1)`);
    if (answer === null) return { compared: null, wrong };
    all.compared += answer.compared;
    wrong.push(...answer.wrong.map((one) => `at ${time} s ${one}`));
  }
  return { ...all, wrong };
}

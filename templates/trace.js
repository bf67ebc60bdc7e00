// Traces: numbers of the data as places in metres.

// The sums of differences in millimetres, in metres.
function sums(differences) {
  let last = 0;
  return Float64Array.from(differences, (change) => { last += change; return last / 1000; });
}

function decodedTrace(trace) {
  const tracks = trace.tracks.map((track) => ({
    agent: track.agent,
    name: track.name,
    radius: track.radius / 1000,
    first: track.first,
    last: track.first + track.x.length - 1,
    x: sums(track.x),
    y: sums(track.y),
  }));
  const plans = trace.plans.map((plan) => ({ ...plan, x: sums(plan.x), y: sums(plan.y) }));
  return { ...trace, tracks, plans };
}

// Where a track is at a frame, which need not be whole; null where the agent is absent.
function placeAt(track, frame) {
  const from = Math.floor(frame + 1e-9);
  if (from < track.first || from > track.last) return null;
  const k = from - track.first;
  const share = from < track.last ? Math.max(frame - from, 0) : 0;
  const next = Math.min(k + 1, track.x.length - 1);
  return {
    x: track.x[k] + share * (track.x[next] - track.x[k]),
    y: track.y[k] + share * (track.y[next] - track.y[k]),
  };
}

// The direction in which a track moves at a frame, or moved last, or will move first, rad; null where it never moves.
function headingAt(track, frame) {
  const now = Math.min(Math.floor(frame + 1e-9), track.last - 1) - track.first;
  for (let k = Math.max(now, 0); k >= 0 && k + 1 < track.x.length; k -= 1) {
    const [dx, dy] = [track.x[k + 1] - track.x[k], track.y[k + 1] - track.y[k]];
    if (dx * dx + dy * dy > 1e-5) return Math.atan2(dy, dx);
  }
  // Somebody who has not moved yet looks to where the first steps lead.
  for (let k = Math.max(now, 0); k + 1 < track.x.length; k += 1) {
    const [dx, dy] = [track.x[k + 1] - track.x[0], track.y[k + 1] - track.y[0]];
    if (dx * dx + dy * dy > 1e-2) return Math.atan2(dy, dx);
  }
  return null;
}

// What each agent plans at a frame, by its number.
function plansAt(trace, frame) {
  const plans = new Map();
  for (const plan of trace.plans) {
    if (plan.first > frame + 1e-9) break;
    if (plan.x.length > 1) plans.set(plan.agent, plan);
    else plans.delete(plan.agent);
  }
  return plans;
}

// The number of the group of each agent at a frame, by its number.
function groupsAt(scene, trace, frame) {
  const groups = new Map(scene.groups.flatMap((group, k) => group.members.map((id) => [id, k])));
  for (const [first, agent, group] of trace.memberships) {
    if (first > frame + 1e-9) break;
    groups.set(agent, group === null ? undefined : group);
  }
  return groups;
}

// The rectangle around a scene and a trace, m.
function bounds(scene, trace) {
  const box = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
  const add = (x, y) => {
    box.left = Math.min(box.left, x);
    box.right = Math.max(box.right, x);
    box.low = Math.min(box.low, y);
    box.high = Math.max(box.high, y);
  };
  const addShape = (shape) => {
    if (shape.circle) {
      const [x, y, r] = shape.circle.map((part) => part / 1000);
      add(x - r, y - r);
      add(x + r, y + r);
    } else {
      for (const ring of shape.rings) {
        for (let k = 0; k < ring.length; k += 2) add(ring[k] / 1000, ring[k + 1] / 1000);
      }
    }
  };
  scene.walls.forEach(([a, b, c, d]) => { add(a / 1000, b / 1000); add(c / 1000, d / 1000); });
  scene.solids.forEach(addShape);
  scene.regions.forEach((region) => addShape(region.shape));
  scene.points.forEach((point) => add(point.at[0] / 1000, point.at[1] / 1000));
  for (const track of trace.tracks) {
    for (let k = 0; k < track.x.length; k += 1) add(track.x[k], track.y[k]);
  }
  if (box.left > box.right) return { left: 0, right: 1, low: 0, high: 1 };
  const room = 0.03 * Math.max(box.right - box.left, box.high - box.low, 1);
  return { left: box.left - room, right: box.right + room, low: box.low - room, high: box.high + room };
}

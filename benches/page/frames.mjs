// The time to the first frame of a page, and the frames while it plays: `node frames.mjs BROWSER PAGE.html [TIMES]`.
// A window of 1000 x 900 pixels without a screen; the browser draws at most 60 frames a second.

import { open } from '../../tests/browser/browser.mjs';

const [browser, file, times = '5'] = process.argv.slice(2);
const median = (list) => list.sort((a, b) => a - b)[Math.floor(list.length / 2)];
const runs = [];
for (let k = 0; k < Number(times); k += 1) {
  const page = await open(browser, file);
  // From the start of the navigation to the first picture with content, which already has the agents: they are drawn
  // by the script at the end of the page.
  const first = await page.value(`new Promise((done) => {
    const observer = new PerformanceObserver((list) => {
      for (const entry of list.getEntriesByName('first-contentful-paint')) done(entry.startTime);
    });
    observer.observe({ type: 'paint', buffered: true });
  })`);
  const atStart = await page.value("Number(document.getElementById('time').value)");
  await page.press(' ');
  const { frames, seconds } = await page.value(`new Promise((done) => {
    const stamps = [];
    const count = (stamp) => {
      stamps.push(stamp);
      const seconds = (stamp - stamps[0]) / 1000;
      if (seconds < 4) requestAnimationFrame(count);
      else done({ frames: stamps.length - 1, seconds });
    };
    requestAnimationFrame(count);
  })`);
  const played = await page.value("Number(document.getElementById('time').value)") - atStart;
  if (played < 3) throw new Error(`the page played ${played} s in 4 s`);
  // What the script alone needs for a frame, without the browser's own drawing.
  const script = await page.value(`(() => {
    const range = document.getElementById('time');
    const from = performance.now();
    for (let k = 0; k < 100; k += 1) {
      range.value = (Number(range.max) * k) / 100;
      range.dispatchEvent(new Event('input'));
    }
    return (performance.now() - from) / 100;
  })()`);
  runs.push({ first, rate: frames / seconds, script });
  await page.close();
}
const of = (name) => median(runs.map((run) => run[name])).toFixed(name === 'script' ? 2 : 0);
console.log(`first frame ${of('first')} ms, ${of('rate')} frames per second while playing, script ${of('script')} ms per frame`);

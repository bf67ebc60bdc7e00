// Checks a page of `--report` in a browser: `node page.mjs BROWSER PAGE.html`. Ends with 1 where something is wrong.

import { open } from './browser.mjs';
import { places } from './places.mjs';

const [browser, file] = process.argv.slice(2);
const wrong = [];
function check(holds, rule) {
  if (!holds) wrong.push(rule);
}

// The pixels of the plan, as one number.
const PLAN = `(() => {
  const canvas = document.getElementById('scene');
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  return data.reduce((sum, value, k) => (sum * 31 + value * (k % 97 + 1)) % 1000000007, 7);
})()`;
const TIME = "Number(document.getElementById('time').value)";

async function plays(page) {
  const entry = await page.value("JSON.parse(document.getElementById('data').textContent).entries[0]");
  check(await page.value("document.getElementById('entry').value === '0'"), 'a page opens with the first trial of its list');
  check(await page.value(TIME) === 0, 'a page opens at the start of the trial');
  await page.press('Home');
  check(await page.value(TIME) === 0, 'Home goes to the start');
  const first = await page.value(PLAN);
  await page.press('ArrowRight');
  const second = await page.value(PLAN);
  check(await page.value(TIME) > 0 && second !== first, 'an arrow key steps and moves agents');
  await page.press('ArrowLeft');
  check(await page.value(PLAN) === first, 'a step back shows the same picture again');
  await page.press(' ');
  // A busy machine draws its first frame late.
  let played = 0;
  for (let k = 0; k < 50 && played <= 0.1; k += 1) {
    await page.wait(200);
    played = await page.value(TIME);
  }
  check(played > 0.1, 'space plays');
  await page.press(' ');
  const paused = await page.value(TIME);
  await page.wait(200);
  check(await page.value(TIME) === paused, 'space pauses');
  await page.value(`(() => {
    const range = document.getElementById('time');
    range.value = Number(range.max) / 2;
    range.dispatchEvent(new Event('input'));
  })()`);
  check(await page.value(PLAN) !== first, 'scrubbing moves agents');
  await page.press('End');
  check(await page.value("document.getElementById('time').value === document.getElementById('time').max"), 'End goes to the end');
  if (entry.decided !== null) {
    await page.press('d');
    check(Math.abs(await page.value(TIME) - entry.decided) < 1e-6, 'D goes to the deciding moment');
  }
  const before = await page.value(PLAN);
  await page.press('+');
  check(await page.value(PLAN) !== before, 'plus zooms');
  await page.press('0');
  check(await page.value(PLAN) === before, 'zero shows the whole plan');
  await page.press('ArrowRight', 8);
  check(await page.value(PLAN) !== before, 'a shifted arrow key moves the plan');
}

// The first trial of the list is the one that fails, and so is that of the button beside it.
async function opensFailing(page) {
  const open = () => page.value(`({
    chosen: document.getElementById('entry').selectedOptions[0].textContent,
    command: document.getElementById('command').textContent,
    trial: (() => {
      const data = JSON.parse(document.getElementById('data').textContent);
      return data.traces[data.entries[Number(document.getElementById('entry').value)].trace].trial;
    })(),
  })`);
  const failing = await page.value("/fails in trial (\\d+)/.exec(document.querySelector('main').innerText)?.[1] ?? null");
  if (failing === null) return;
  const isIt = ({ chosen, command, trial }) => trial === Number(failing) && chosen === `trial ${failing} fails`
    && command.endsWith(`--trial ${failing}`);
  const choose = (number) => page.value(`(() => {
    const entry = document.getElementById('entry');
    entry.value = String(${number});
    entry.dispatchEvent(new Event('change'));
  })()`);
  await choose(0);
  const first = await open();
  check(isIt(first), `the first trial is ${JSON.stringify(first)}, not the failing one, ${failing}`);
  await choose("document.getElementById('entry').options.length - 1");
  await page.value("document.querySelector('button.show').click()");
  check(isIt(await open()), 'the button beside the failing trial opens another one');
}

// Tab reaches all that can be focused, in the order of the page.
async function tabs(page) {
  const all = await page.value(`(() => {
    const list = [...document.querySelectorAll('a[href], button, select, input, summary, [tabindex]')];
    const seen = list.filter((one) => !one.disabled && one.checkVisibility());
    seen.forEach((one, k) => { one.dataset.order = k; });
    document.activeElement.blur();
    return seen.length;
  })()`);
  const met = [];
  for (let k = 0; k < all; k += 1) {
    await page.press('Tab');
    met.push(Number(await page.value('document.activeElement.dataset.order ?? -1')));
  }
  check(met.every((order, k) => order === k), `Tab reaches everything in order: ${met}`);
}

for (const dark of [false, true]) {
  const page = await open(browser, file, { width: 360, height: 740, dark });
  for (const state of ['closed', 'open']) {
    const wide = await page.value('document.documentElement.scrollWidth');
    check(wide <= 360, `a page of 360 px with ${state} details is ${wide} px wide`);
    await page.value("document.querySelectorAll('details').forEach((one) => { one.open = true; })");
  }
  const contrast = await page.value(`(() => {
    const light = (color) => {
      const parts = color.match(/[\\d.]+/g).slice(0, 3).map((part) => part / 255);
      const [r, g, b] = parts.map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const paper = (element) => {
      for (let one = element; one; one = one.parentElement) {
        const color = getComputedStyle(one).backgroundColor;
        if (color !== 'rgba(0, 0, 0, 0)') return color;
      }
      return 'rgb(255, 255, 255)';
    };
    const own = (one) => [...one.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim() !== '');
    const texts = [...document.body.querySelectorAll('*')].filter((one) => own(one) && !one.closest('script, noscript'));
    const low = texts.filter((one) => !one.disabled && one.checkVisibility()).map((one) => {
      const style = getComputedStyle(one);
      const [a, b] = [light(one instanceof SVGElement ? style.fill : style.color), light(paper(one))];
      return { ratio: (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), text: one.tagName + '.' + one.className };
    }).filter(({ ratio }) => ratio < 4.5);
    // Names on the plan have a rim in the colour of the stage.
    const root = document.documentElement;
    const stage = document.createElement('span');
    root.append(stage);
    const named = (ink) => { stage.style.color = 'var(--' + ink + ')'; return light(getComputedStyle(stage).color); };
    for (const ink of ['ink', 'soft', 'deciding']) {
      const [a, b] = [named(ink), named('stage')];
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      if (ratio < 4.5) low.push({ ratio, text: 'plan.' + ink });
    }
    stage.remove();
    return [...new Set(low.map(({ ratio, text }) => text + ' ' + ratio.toFixed(1)))];
  })()`);
  check(contrast.length === 0, `contrast below 4.5: ${contrast.join(', ')}`);
  check(page.errors.length === 0, `errors: ${page.errors.join('; ')}`);
  await page.close();
}
const page = await open(browser, file);
await plays(page);
await page.press('0');
const { compared, wrong: misplaced } = await places(page);
check(misplaced.length === 0, `agents are not where the data say: ${misplaced.join(', ')}`);
check(compared === null || compared > 0, 'no agent was found on the plan');
await tabs(page);
await opensFailing(page);
check(await page.value("document.querySelectorAll('script[src], link, img, iframe').length") === 0, 'nothing is loaded');
check(page.requests.length === 0, `requests: ${page.requests.join(', ')}`);
check(page.errors.length === 0, `errors: ${page.errors.join('; ')}`);
await page.close();
for (const rule of wrong) console.log(rule);
process.exit(wrong.length > 0 ? 1 : 0);

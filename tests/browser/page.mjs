// Checks a page of `--report` in a browser: `node page.mjs BROWSER PAGE.html`. Ends with 1 where something is wrong.

import { open } from './browser.mjs';

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
  const start = entry.decided === null ? 0 : entry.decided;
  check(Math.abs(await page.value(TIME) - start) < 1e-6, 'a page opens at the deciding moment');
  await page.press('Home');
  check(await page.value(TIME) === 0, 'Home goes to the start');
  const first = await page.value(PLAN);
  await page.press('ArrowRight');
  const second = await page.value(PLAN);
  check(await page.value(TIME) > 0 && second !== first, 'an arrow key steps and moves agents');
  await page.press('ArrowLeft');
  check(await page.value(PLAN) === first, 'a step back shows the same picture again');
  await page.press(' ');
  await page.wait(600);
  const played = await page.value(TIME);
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
  const before = await page.value(PLAN);
  await page.press('+');
  check(await page.value(PLAN) !== before, 'plus zooms');
  await page.press('0');
  check(await page.value(PLAN) === before, 'zero shows the whole plan');
  await page.press('ArrowRight', 8);
  check(await page.value(PLAN) !== before, 'a shifted arrow key moves the plan');
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
  const wide = await page.value('document.documentElement.scrollWidth');
  check(wide <= 360, `a page of 360 px is ${wide} px wide`);
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
    const texts = [...document.querySelectorAll('h1, h2, p, code, pre, span, button, select, label, summary, small')];
    const low = texts.filter((one) => !one.disabled && one.checkVisibility()).map((one) => {
      const [a, b] = [light(getComputedStyle(one).color), light(paper(one))];
      return { ratio: (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), text: one.tagName + '.' + one.className };
    }).filter(({ ratio }) => ratio < 4.5);
    return [...new Set(low.map(({ ratio, text }) => text + ' ' + ratio.toFixed(1)))];
  })()`);
  check(contrast.length === 0, `contrast below 4.5: ${contrast.join(', ')}`);
  check(page.errors.length === 0, `errors: ${page.errors.join('; ')}`);
  await page.close();
}
const page = await open(browser, file);
await plays(page);
await tabs(page);
check(await page.value("document.querySelectorAll('script[src], link, img, iframe').length") === 0, 'nothing is loaded');
check(page.requests.length === 0, `requests: ${page.requests.join(', ')}`);
check(page.errors.length === 0, `errors: ${page.errors.join('; ')}`);
await page.close();
for (const rule of wrong) console.log(rule);
process.exit(wrong.length > 0 ? 1 : 0);

// A browser without a window, spoken to through a pipe.

import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

// Opens a page of the disk. `errors` collects what goes wrong in it, `requests` what it asks for besides itself.
export async function open(browser, file, { width = 1000, height = 900, dark = false } = {}) {
  const profile = mkdtempSync(join(tmpdir(), 'smc-browser-'));
  const child = spawn(browser, [
    '--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--no-first-run',
    '--disable-background-networking', '--force-color-profile=srgb', '--remote-debugging-pipe',
    `--user-data-dir=${profile}`, 'about:blank',
  ], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
  const [to, from] = [child.stdio[3], child.stdio[4]];
  const waiting = new Map();
  const listeners = new Map();
  let [number, buffer] = [0, ''];
  from.on('data', (chunk) => {
    buffer += chunk;
    const messages = buffer.split('\0');
    buffer = messages.pop();
    for (const message of messages.map((one) => JSON.parse(one))) {
      if (message.id === undefined) (listeners.get(message.method) || []).forEach((act) => act(message.params));
      const { done, fail } = waiting.get(message.id) || {};
      waiting.delete(message.id);
      if (message.error) fail?.(new Error(message.error.message));
      else done?.(message.result);
    }
  });
  const send = (method, params = {}, sessionId = undefined) => new Promise((done, fail) => {
    number += 1;
    waiting.set(number, { done, fail });
    to.write(`${JSON.stringify({ id: number, method, params, sessionId })}\0`);
  });
  const on = (method, act) => listeners.set(method, [...(listeners.get(method) || []), act]);
  const { targetId } = await send('Target.createTarget', { url: 'about:blank' });
  const { sessionId } = await send('Target.attachToTarget', { targetId, flatten: true });
  const call = (method, params) => send(method, params, sessionId);
  const [errors, requests] = [[], []];
  const url = pathToFileURL(file).href;
  on('Runtime.exceptionThrown', ({ exceptionDetails: e }) => errors.push(e.exception?.description || e.text));
  on('Runtime.consoleAPICalled', ({ type, args }) => {
    if (type === 'error') errors.push(args.map((one) => one.value).join(' '));
  });
  on('Log.entryAdded', ({ entry }) => { if (entry.level === 'error') errors.push(entry.text); });
  on('Network.requestWillBeSent', ({ request }) => { if (request.url !== url) requests.push(request.url); });
  const loaded = new Promise((done) => { on('Page.loadEventFired', done); });
  for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await call(`${domain}.enable`);
  await call('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: width < 600 });
  const scheme = { name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' };
  await call('Emulation.setEmulatedMedia', { features: [scheme] });
  await call('Page.navigate', { url });
  await loaded;
  const page = {
    errors,
    requests,
    async value(expression) {
      const answer = await call('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
      if (answer.exceptionDetails) throw new Error(answer.exceptionDetails.exception?.description);
      return answer.result.value;
    },
    async press(key, modifiers = 0) {
      const text = key.length === 1 ? key : undefined;
      const code = { ' ': 32, Tab: 9, ArrowLeft: 37, ArrowRight: 39, Home: 36, End: 35 }[key] || 0;
      const event = { key, text, modifiers, windowsVirtualKeyCode: code };
      await call('Input.dispatchKeyEvent', { type: 'keyDown', ...event });
      await call('Input.dispatchKeyEvent', { type: 'keyUp', key, modifiers });
    },
    wait: (milliseconds) => new Promise((done) => { setTimeout(done, milliseconds); }),
    // A picture of an element, or of what is seen.
    async picture(selector) {
      const box = selector && await page.value(`(() => {
        const b = document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect();
        return { x: b.x + scrollX, y: b.y + scrollY, width: b.width, height: b.height, scale: 1 };
      })()`);
      const parameters = box ? { clip: box, captureBeyondViewport: true } : {};
      const { data } = await call('Page.captureScreenshot', { format: 'png', ...parameters });
      return Buffer.from(data, 'base64');
    },
    async close() {
      const ended = new Promise((done) => { child.on('exit', done); });
      await send('Browser.close').catch(() => {});
      await ended;
      rmSync(profile, { recursive: true, force: true, maxRetries: 5, retryDelay: 100 });
    },
  };
  return page;
}

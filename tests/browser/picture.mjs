// A picture of the player: `node picture.mjs BROWSER PAGE.html PICTURE.png [SELECTOR [WIDTH [dark]]]`.

import { writeFileSync } from 'node:fs';
import { open } from './browser.mjs';

const [browser, file, picture, selector = '#player', width = '900', scheme = 'light'] = process.argv.slice(2);
const page = await open(browser, file, { width: Number(width), dark: scheme === 'dark' });
writeFileSync(picture, await page.picture(selector));
await page.close();

// What every page has: its colours and its copy buttons.

const themes = ['system', 'light', 'dark'];
const root = document.documentElement;
const themed = []; // called when colours change

function byId(id) {
  return document.getElementById(id);
}

function setTheme(theme) {
  root.dataset.theme = theme;
  byId('theme').textContent = `Colours: ${theme === 'system' ? 'as the system' : theme}`;
  themed.forEach((changed) => changed());
}

byId('theme').addEventListener('click', () => {
  const now = themes.indexOf(root.dataset.theme || 'system');
  setTheme(themes[(now + 1) % themes.length]);
});
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => themed.forEach((changed) => changed()));

function select(element) {
  const range = document.createRange();
  range.selectNodeContents(element);
  getSelection().removeAllRanges();
  getSelection().addRange(range);
}

async function copy(button) {
  const text = button.parentElement.querySelector('pre');
  try {
    await navigator.clipboard.writeText(text.textContent);
    button.textContent = 'Copied';
  } catch {
    // A page from a disk may not be allowed to use the clipboard.
    select(text);
    button.textContent = document.execCommand('copy') ? 'Copied' : 'Selected';
  }
  setTimeout(() => { button.textContent = 'Copy'; }, 1500);
}

for (const button of document.querySelectorAll('button.copy')) {
  button.addEventListener('click', () => copy(button));
}

// A link may lead into a text that is folded up.
function unfold() {
  const target = location.hash.length > 1 && byId(location.hash.slice(1));
  const folded = target && target.closest('details');
  if (!folded) return;
  folded.open = true;
  target.scrollIntoView({ block: 'center' });
}
addEventListener('hashchange', unfold);
unfold();

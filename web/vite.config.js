// One page out of all: script and style go into page.html in place of its marks; the program puts the data in later.
import { defineConfig } from 'vite';
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync } from 'node:fs';

// What the bundle was made of, so that a test without Node can tell whether it is that of these sources
// (tests/rules/web_bundle_test.py).
function fingerprint() {
  const files = ['package-lock.json', 'tsconfig.json', 'vite.config.js', ...readdirSync('src').map((name) => `src/${name}`)];
  const hash = createHash('sha256');
  for (const file of files.sort()) hash.update(`${file}\n`).update(readFileSync(file)).update('\n');
  return hash.digest('hex');
}

const onePage = {
  name: 'one-page',
  enforce: 'post',
  generateBundle(_options, bundle) {
    let script = '';
    let style = '';
    for (const [name, part] of Object.entries(bundle)) {
      if (part.type === 'chunk') script += part.code;
      else if (name.endsWith('.css')) style += part.source;
      delete bundle[name];
    }
    const licences = readFileSync('src/licences.txt', 'utf8').trim();
    const page = readFileSync('src/page.html', 'utf8')
      .replace('/*style*/', () => style.trim())
      .replace('/*script*/', () => script.trim().replaceAll('</script', '<\\/script'))
      .replace('/*licences*/', () => `${licences}\nBundled from web/ as of ${fingerprint()}`);
    this.emitFile({ type: 'asset', fileName: 'report.html', source: page });
  },
};

export default defineConfig({
  plugins: [onePage],
  build: {
    target: 'es2022',
    outDir: 'dist',
    emptyOutDir: true,
    cssCodeSplit: false,
    lib: { entry: 'src/main.ts', formats: ['iife'], name: 'moiregaugeReport', fileName: () => 'report.js' },
  },
});

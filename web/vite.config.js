// Two pages. `vite build` makes report.html: script and style replace the marks of page.html, and the program puts the data in later.
// `vite build --mode serve` makes the page of `moiregauge serve`: serve.html, app.js and app.css, without inline script or style.
import { defineConfig } from 'vite';
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync } from 'node:fs';

// Hash of the bundle's sources, so that a test without Node detects a stale bundle (tests/rules/web_bundle_test.py). The report
// uses the files of src only, serve also those of src/serve.
function fingerprint(folders) {
  const files = folders.flatMap((folder) => readdirSync(folder, { withFileTypes: true }).filter((entry) => entry.isFile()).map(({ name }) => `${folder}/${name}`));
  const hash = createHash('sha256');
  for (const file of ['package-lock.json', 'tsconfig.json', 'vite.config.js', ...files].sort()) hash.update(`${file}\n`).update(readFileSync(file)).update('\n');
  return hash.digest('hex');
}

const kReportFolders = ['src'];
const kServeFolders = ['src', 'src/serve', 'src/serve/parts', 'src/serve/setup', 'src/serve/results'];

// Removes all parts from the bundle and returns their script and style.
function taken(bundle) {
  let script = '';
  let style = '';
  for (const [name, part] of Object.entries(bundle)) {
    if (part.type === 'chunk') script += part.code;
    else if (name.endsWith('.css')) style += part.source;
    delete bundle[name];
  }
  return { script: script.trim(), style: style.trim() };
}

const licences = () => readFileSync('src/licences.txt', 'utf8').trim();

const onePage = {
  name: 'one-page',
  enforce: 'post',
  generateBundle(_options, bundle) {
    const { script, style } = taken(bundle);
    const page = readFileSync('src/page.html', 'utf8')
      .replace('/*style*/', () => style)
      .replace('/*script*/', () => script.replaceAll('</script', '<\\/script'))
      .replace('/*licences*/', () => `${licences()}\nBundled from web/ as of ${fingerprint(kReportFolders)}`);
    this.emitFile({ type: 'asset', fileName: 'report.html', source: page });
  },
};

const threeFiles = {
  name: 'three-files',
  enforce: 'post',
  generateBundle(_options, bundle) {
    const { script, style } = taken(bundle);
    const note = `/*\n${licences()}\nBundled from web/ as of ${fingerprint(kServeFolders)}\n*/\n`;
    this.emitFile({ type: 'asset', fileName: 'serve.html', source: readFileSync('src/serve/page.html', 'utf8') });
    this.emitFile({ type: 'asset', fileName: 'app.js', source: `${note}${script}\n` });
    this.emitFile({ type: 'asset', fileName: 'app.css', source: `${style}\n` });
  },
};

export default defineConfig(({ mode }) => {
  const isServe = mode === 'serve';
  return {
    mode: 'production',
    plugins: [isServe ? threeFiles : onePage],
    define: { 'process.env.NODE_ENV': '"production"' },
    build: {
      target: 'es2022',
      outDir: 'dist',
      emptyOutDir: false,
      cssCodeSplit: false,
      lib: {
        entry: isServe ? 'src/serve/main.ts' : 'src/main.ts', formats: ['iife'],
        name: isServe ? 'moiregaugeServe' : 'moiregaugeReport', fileName: () => (isServe ? 'app.js' : 'report.js'),
      },
    },
  };
});

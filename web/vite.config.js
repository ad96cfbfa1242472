// One page out of all: script and style go into page.html in place of its marks; the program puts the data in later.
import { defineConfig } from 'vite';
import { readFileSync } from 'node:fs';

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
      .replace('/*licences*/', () => licences);
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

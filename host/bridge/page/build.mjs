// Bundles the page: node build.mjs MODULES OUT COUNTERS
//   MODULES   folder with node_modules (toolchains/install_packages view)
//   OUT       folder for index.html, page.css, page.js, worker.js, licences.txt and report_view.js, which is part of
//             reports of octoskin-lab
//   COUNTERS  docs/counters.md, which says what each counter means
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const [modules, out, countersFile] = process.argv.slice(2);
if (!countersFile) {
  console.error('usage: node build.mjs MODULES OUT COUNTERS');
  process.exit(64);
}
const here = path.dirname(fileURLToPath(import.meta.url));
const esbuild = createRequire(path.resolve(modules, 'package.json'))('esbuild');

/** Meaning and remedy of each counter, by input: from the tables of the document. */
function countersOf(text) {
  const counters = {};
  for (const [, input, table] of text.matchAll(
    /<!-- table: counters of (.*?) -->\n([^]*?)<!-- end of table -->/g,
  )) {
    counters[input] = {};
    for (const [, name, meaning, , remedy] of table.matchAll(/^\| `(\w+)` \| (.*?) \| (\w+) \| (.*?) ?\|$/gm))
      counters[input][name] = { meaning: plain(meaning), remedy: plain(remedy) };
  }
  if (Object.keys(counters).length === 0) throw new Error(`${countersFile}: no table of counters`);
  return counters;
}

const plain = (text) =>
  text
    .replace(/`/g, '')
    .replace(/\\([<>|])/g, '$1')
    .trim();

const counters = {
  name: 'counters',
  setup(build) {
    build.onResolve({ filter: /^octoskin:counters$/ }, () => ({ path: 'counters', namespace: 'counters' }));
    build.onLoad({ filter: /.*/, namespace: 'counters' }, () => ({
      contents: JSON.stringify(countersOf(fs.readFileSync(countersFile, 'utf8'))),
      loader: 'json',
    }));
  },
};

/** The licence of a package: its own file, or the one that is kept here for packages without. */
function licenceOf(name) {
  const folder = path.join(modules, 'node_modules', name);
  const { version, license } = JSON.parse(fs.readFileSync(path.join(folder, 'package.json'), 'utf8'));
  const own = path.join(folder, 'LICENSE');
  const text = fs.readFileSync(fs.existsSync(own) ? own : path.join(here, 'licences', `${license}.txt`), 'utf8');
  return `${name} ${version} (${license})\n\n${text.trim()}\n`;
}

const { dependencies } = JSON.parse(fs.readFileSync(path.join(here, 'package.json'), 'utf8'));
const licences = [
  'The page of octoskin view contains these packages.\n',
  ...Object.keys(dependencies).map(licenceOf),
].join(`\n${'-'.repeat(78)}\n\n`);

fs.mkdirSync(out, { recursive: true });
const options = {
  outdir: out,
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  nodePaths: [path.resolve(modules, 'node_modules')],
  plugins: [counters],
  logLevel: 'warning',
};
await esbuild.build({
  ...options,
  entryPoints: { page: path.join(here, 'src/main.js'), worker: path.join(here, 'src/map_worker.js') },
  legalComments: 'none',
});
// Part of a report, which may go anywhere: it has the licences' lines in it.
await esbuild.build({
  ...options,
  entryPoints: { report_view: path.join(here, 'src/report_view.js') },
  legalComments: 'inline',
});
for (const file of ['index.html', 'page.css']) fs.copyFileSync(path.join(here, file), path.join(out, file));
fs.writeFileSync(path.join(out, 'licences.txt'), licences);

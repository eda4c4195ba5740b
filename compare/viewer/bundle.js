// npm run bundle: viewer.js and the parts of vtk.js it uses as one script, in viewer_bundle.cc. The licences of what is
// bundled come first.
import { build } from 'esbuild';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';

const result = await build({
  entryPoints: ['viewer.js'],
  bundle: true,
  loader: { '.css': 'text' },
  minify: true,
  format: 'iife',
  target: 'es2020',
  charset: 'ascii',
  legalComments: 'inline',
  metafile: true,
  write: false,
});
const packages = Object.keys(Object.values(result.metafile.outputs)[0].inputs)
  .map((file) => file.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1])
  .filter(Boolean);
const licences = [...new Set(packages)].sort().map((name) => {
  const folder = `node_modules/${name}`;
  const read = (start) => {
    const file = readdirSync(folder).find((entry) => entry.toLowerCase().startsWith(start));
    return file && readFileSync(`${folder}/${file}`, 'utf8');
  };
  const text = read('licen') ?? read('readme')?.match(/^licen[sc]e.*\n[\s\S]*/im)?.[0];
  if (!text) throw new Error(`${folder} does not say its licence`);
  return `with ${name}:\n${text.trim()}`;
});
const notice = licences.join('\n\n').replaceAll('*/', '* /').replaceAll(/[^\n\x20-\x7e]/g, '');
// The page is XML too, where this would end the script.
const code = result.outputFiles[0].text.replaceAll(']]>', ']] >');
if (/<\/script|<!--/i.test(code)) throw new Error('the bundle holds text that would end the script early');
if (code.includes(')bundle"')) throw new Error('the bundle holds text that would end the string early');
writeFileSync('viewer_bundle.cc', `#include "compare/viewer/viewer_bundle.h"

namespace touchstone::compare {

const std::string_view viewer_bundle = R"bundle(/*
${notice}
*/
${code})bundle";

}  // namespace touchstone::compare
`);

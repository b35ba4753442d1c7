// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// node build.mjs OUTPUT.html [FOLDER_OF_NODE_MODULES]: type check, bundle, one HTML file.

import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const DATA_ELEMENT = '<script type="application/json" id="pliant-data"></script>';

const web = dirname(fileURLToPath(import.meta.url));
const [output, folder = web] = process.argv.slice(2);
if (!output) fail("usage: node build.mjs OUTPUT.html [FOLDER_OF_NODE_MODULES]");
const modules = join(resolve(folder), "node_modules");
const require = createRequire(join(modules, "package.json"));

checkTypes();
const script = await bundle();
const style = [join(modules, "uplot/dist/uPlot.min.css"), join(web, "src/style.css")].map(read).join("\n");
const page = fill(read(join(web, "src/page.html")), { "/* STYLE */": style, "/* SCRIPT */": script });
if (page.split(DATA_ELEMENT).length !== 2) fail(`the page must hold exactly one ${DATA_ELEMENT}`);
if (/<\/script/i.test(script) || /<\/style/i.test(style)) fail("the bundle holds an end tag, which would end it too early");
writeFileSync(output, page);
console.log(`${output}: ${Math.round(page.length / 1024)} KiB`);

function checkTypes() {
  const ts = require("typescript");
  const config = ts.readConfigFile(join(web, "tsconfig.json"), ts.sys.readFile);
  const { options, fileNames } = ts.parseJsonConfigFileContent(config.config, ts.sys, web);
  options.paths = { "*": [`${modules}/@types/*`, `${modules}/*`] };
  const problems = ts.getPreEmitDiagnostics(ts.createProgram(fileNames, options));
  if (problems.length === 0) return;
  fail(ts.formatDiagnostics(problems, {
    getCurrentDirectory: () => web, getCanonicalFileName: (name) => name, getNewLine: () => "\n",
  }));
}

async function bundle() {
  const licenses = ["three", "uplot"].map((name) => `${name}\n\n${read(join(modules, name, "LICENSE"))}`).join("\n");
  const result = await require("esbuild").build({
    entryPoints: [join(web, "src/main.ts")],
    nodePaths: [modules],
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2020",
    write: false,
    legalComments: "none",
    banner: { js: `/*!\nThis page holds these libraries.\n\n${licenses}*/` },
  });
  return result.outputFiles[0].text;
}

function fill(text, parts) {
  for (const [mark, part] of Object.entries(parts)) text = text.replace(mark, () => part);
  return text;
}

function read(path) {
  return readFileSync(path, "utf8");
}

function fail(message) {
  console.error(message);
  process.exit(1);
}

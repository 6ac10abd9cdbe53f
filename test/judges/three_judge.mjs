// three_judge.mjs FILE.glb EXPECTED.json [PICTURE.png]: opens the file with three.js in headless Chromium, plays it to
// the expected times, and compares organs and vertex positions; a picture must not be empty. Exits 1 on any fault.
import {readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import process from 'node:process';
import {fileURLToPath} from 'node:url';
import {build} from 'esbuild';
import puppeteer from 'puppeteer-core';
import {report} from './compare.mjs';

const [glb_path, expected_path, picture_path] = process.argv.slice(2);
if (!glb_path || !expected_path) {
  console.error('usage: node three_judge.mjs FILE.glb EXPECTED.json [PICTURE.png]');
  process.exit(2);
}
const glb = readFileSync(glb_path);
const wanted = readFileSync(expected_path, 'utf8');
const expected = JSON.parse(wanted);

const here = dirname(fileURLToPath(import.meta.url));
const bundle = await build({
  entryPoints: [join(here, 'three_page.mjs')], bundle: true, write: false, format: 'iife', logLevel: 'error'});

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  headless: true,
  protocolTimeout: 300_000,
  args: [
    // Chromium refuses its sandbox to root, and this page is our own.
    ...(process.getuid() === 0 ? ['--no-sandbox'] : []),
    '--disable-dev-shm-usage', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  ],
});
let good = false;
try {
  const page = await browser.newPage();
  const faults = [];
  page.on('pageerror', (error) => faults.push(`the page failed: ${error.message}`));
  page.on('console', (message) => {
    if (message.type() === 'error') {
      faults.push(`the page said: ${message.text()}`);
    }
  });
  await page.setContent('<!doctype html><meta charset="utf-8"><title>judge</title>');
  await page.addScriptTag({content: bundle.outputFiles[0].text});
  const found = await page.evaluate((file, text) => window.judge(file, text), glb.toString('base64'), wanted);

  if (found.organ_count !== expected.organs.length) {
    faults.push(`${found.organ_count} organs, must be ${expected.organs.length}`);
  }
  if (Math.abs(found.duration_s - expected.duration_s) > 1e-4) {
    faults.push(`the animation takes ${found.duration_s} s, must be ${expected.duration_s}`);
  }
  found.pictures.forEach(({lit, colours}, i) => {
    if (lit < 2000 || colours < 8) {
      faults.push(`the picture at ${expected.times_s[i]} s shows ${lit} lit pixels in ${colours} colours`);
    }
  });
  if (picture_path) {
    writeFileSync(picture_path, Buffer.from(found.image.split(',')[1], 'base64'));
  }
  good = report('three.js', expected, found.positions, faults);
} finally {
  await browser.close();
}
process.exit(good ? 0 : 1);

// validate.mjs FILE.glb ...: the Khronos glTF validator. Prints what it finds; exits 1 on any error or warning.
import {readFileSync} from 'node:fs';
import process from 'node:process';
import validator from 'gltf-validator';

const SEVERITIES = ['error', 'warning', 'information', 'hint'];
const MAX_PRINTED = 20;

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate.mjs FILE.glb ...');
  process.exit(2);
}

let bad = false;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {uri: file, maxIssues: 1000});
  const {numErrors, numWarnings, numInfos, numHints, messages} = report.issues;
  bad ||= numErrors + numWarnings > 0;
  const info = report.info;
  // A file that is cut off has issues and no information.
  const content = info ? `${info.drawCallCount} draw calls, ${info.totalTriangleCount} triangles, ` +
    `${info.animationCount} animations` : 'unreadable';
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ${numHints} hints ` +
    `(${content})`);
  for (const issue of messages.slice(0, MAX_PRINTED)) {
    console.log(`  ${SEVERITIES[issue.severity]} ${issue.code} ${issue.pointer ?? ''}: ${issue.message}`);
  }
  if (messages.length > MAX_PRINTED) {
    console.log(`  and ${messages.length - MAX_PRINTED} more`);
  }
}
process.exit(bad ? 1 : 0);
